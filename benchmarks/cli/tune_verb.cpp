// isoline tune: a table of rates from a recorded grid.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/tune.h"
#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"

namespace isoline::benchmarks {

using optimizers::Family;
namespace {

TuningPlan plan_of(const Catalog& catalog, const TuneArguments& given) {
  TuningPlan plan{.grid = parse_grid(given.grid, given.unit),
                  .seeds = parse_seeds(given.seeds),
                  .budget = {.iterations = given.iterations, .work = given.work}};
  for (const Spec& spec : parse_specs(given.problem))
    plan.problems.push_back(complete_problem(catalog, spec));
  if (given.optimizer.empty()) {
    plan.optimizers = {"sip"};
    for (const auto& [name, entry] : catalog.optimizers)
      if (entry.family == Family::first_order) plan.optimizers.push_back(name);
    return plan;
  }
  for (const Spec& spec : parse_specs(given.optimizer)) {
    require(spec.options.empty(),
            [&] { return fmt::format("name {} without options: the grid sets them", spec.name); });
    plan.optimizers.push_back(catalog.optimizers.at(spec.name).name);
  }
  return plan;
}

// The rows of the table that are not replaced, and the new ones, in order.
Json joined(const Json& old_rows, const Json& new_rows) {
  std::map<std::pair<std::string, std::string>, Json> rows;
  for (const Json* some : {&old_rows, &new_rows})
    for (const Json& row : *some) rows[{row.at("problem"), row.at("optimizer")}] = row;
  Json all = Json::array();
  for (const auto& [pair, row] : rows) all.push_back(row);
  return all;
}

// Rows stand one a line, so that a change of one reads as one.
std::string text_of(const Json& grid, const Json& rows) {
  std::string text =
      fmt::format("{{\"schema\": \"isoline.rates/1\",\n\"grid\": {},\n\"rows\": [", grid.dump());
  const char* separator = "\n";
  for (const Json& row : rows) {
    text += separator + row.dump();
    separator = ",\n";
  }
  return text + "\n]}\n";
}

void write_table(const TuneArguments& given, const TuningPlan& plan, Json rows) {
  if (std::filesystem::exists(given.table)) rows = joined(read_json(given.table).at("rows"), rows);
  const Json grid{{"points", plan.grid.values.size()},
                  {"seeds", given.seeds},
                  {"budget", {{"iterations", given.iterations}, {"work", given.work}}},
                  {"score", "median work to 1e-6, then median final loss"}};
  write_text(given.table, text_of(grid, rows));
}

}  // namespace

int tune_verb(const TuneArguments& given, Session& session) {
  require(!given.problem.empty(), "tune: name the problems, as SPEC or by --problem");
  const Catalog& catalog = session.catalog();
  const TuningPlan plan = plan_of(catalog, given);
  const RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                           .progress = Progress::style_of(STDERR_FILENO),
                           .command = session.command()};
  const TuningResult result = tune(catalog, plan, given.folder, options);
  if (result.outcome.is_interrupted) return exit_code_of(result.outcome);
  for (const Json& row : *result.rows)
    fmt::print("{:28} {:24} {}; best of 1, 2, …: {}\n", row["problem"].get<std::string>(),
               row["optimizer"].get<std::string>(), row["options"].dump(),
               row["source"]["best_of"].dump());
  if (!given.table.empty()) write_table(given, plan, *result.rows);
  return kGood;
}

}  // namespace isoline::benchmarks
