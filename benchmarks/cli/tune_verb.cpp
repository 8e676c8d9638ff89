// isoline tune: a table of rates from a recorded grid.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/tuning_table.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/filter.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/tune.h"
#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"
#include "core/text.h"

namespace isoline::benchmarks {

namespace {

constexpr const char* kScore =
    "median work to 1e-6 of the loss, or of x where the problem's aim is x; then the median of what "
    "is left of it at the end";

// The cells of a suite, but for the blocks that name their own table of rates.
std::vector<Request> cells_of(const Catalog& catalog, const TuneArguments& given) {
  Suite suite = read_suite(given.suite);
  std::erase_if(suite.blocks, [](const MatrixBlock& block) { return !block.rates.empty(); });
  return filtered(catalog, expand(catalog, suite, Rates()), given.problem, given.optimizer);
}

std::vector<Request> cells_named(const Catalog& catalog, const TuneArguments& given) {
  require(!given.problem.empty(),
          "tune: name the problems, as SPEC or by --problem, or a --suite of them");
  const MatrixBlock block{.problems = {given.problem},
                          .optimizers = {given.optimizer.empty() ? "*" : given.optimizer},
                          .budget = {.iterations = given.iterations, .work = given.work}};
  return expand(catalog, {.name = "tuning", .title = "", .blocks = {block}}, Rates());
}

TuningPlan plan_of(const Catalog& catalog, const TuneArguments& given) {
  TuningPlan plan{.seeds = parse_seeds(given.seeds)};
  if (!given.grid.empty()) plan.grid = parse_grid(given.grid, given.unit);
  const Rates rates = Rates::builtin();
  std::set<std::pair<std::string, std::string>> known;
  for (const Request& cell :
       given.suite.empty() ? cells_named(catalog, given) : cells_of(catalog, given)) {
    const std::string& name = cell.optimizer.name;
    const optimizers::Tunable& tunable = catalog.optimizers.at(name).tunable;
    if (tunable.option.empty() || !known.emplace(cell.problem.spec, name).second) continue;
    const Rates::Row* row = rates.find(cell.problem, name);
    plan.pairs.push_back({.problem = cell.problem,
                          .optimizer = name,
                          .budget = cell.budget,
                          .options = row && !row->is_from_grid ? row->options : OptionValues()});
  }
  require(!plan.pairs.empty(), "tune: none of these methods has an option to tune");
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
  std::string text = fmt::format("{{\"schema\": \"isoline.rates/1\",\n\"grid\": {},\n\"rows\": [",
                                 json_text(grid));
  const char* separator = "\n";
  for (const Json& row : rows) {
    text += separator + json_text(row);
    separator = ",\n";
  }
  return text + "\n]}\n";
}

void write_table(const TuneArguments& given, const TuningPlan& plan, Json rows) {
  if (std::filesystem::exists(given.table)) rows = joined(read_json(given.table).at("rows"), rows);
  const Budget& budget = plan.pairs[0].budget;
  Json grid{{"points", plan.grid ? plan.grid->values.size() : kGridValues},
            {"seeds", given.seeds},
            {"budget", {{"iterations", budget.iterations}, {"work", budget.work}}},
            {"score", kScore}};
  if (!plan.grid) grid["extensions"] = kMostExtensions;
  write_text(given.table, text_of(grid, rows));
}

}  // namespace

int tune_verb(const TuneArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  const TuningPlan plan = plan_of(catalog, given);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .command = session.command()};
  if (!given.as_json) options.progress = Progress::style_of(STDERR_FILENO);
  const TuningResult result = tune(catalog, plan, given.folder, options);
  if (result.outcome.is_interrupted) return exit_code_of(result.outcome);
  print_failures(result.outcome, given.folder);
  say(stdout,
      given.as_json ? json_text(*result.rows, 2) + "\n" : tuning_text(result, given.lists_all));
  if (!given.table.empty()) write_table(given, plan, *result.rows);
  return kGood;
}

}  // namespace isoline::benchmarks
