// isoline tune: a table of rates from a recorded grid.
#include "benchmarks/run/tune.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "benchmarks/cli/verbs.h"
#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"

namespace isoline::benchmarks {

using optimizers::Family;
namespace {

struct TuneArguments {
  std::string problem, optimizer, grid = "rate=1e-4..1e2x7", unit = "one", seeds = "100..102";
  std::string table, folder = "results/tuning";
  Budget budget{.iterations = 100'000, .work = 2000};
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

TuningPlan plan_of(const Catalog& catalog, const TuneArguments& given) {
  TuningPlan plan{.grid = parse_grid(given.grid, given.unit),
                  .seeds = parse_seeds(given.seeds),
                  .budget = given.budget};
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

void tune_and_write(const TuneArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  const TuningPlan plan = plan_of(catalog, given);
  Store store(given.folder);
  const RunOptions options{.jobs = given.jobs,
                           .progress = Progress::style_of(STDERR_FILENO),
                           .command = session.command()};
  const TuningResult result = tune(catalog, plan, store, options);
  if (result.outcome.is_interrupted) {
    fmt::print(stderr, "interrupted; the same command goes on where it stopped\n");
    session.exit_code = kInterrupted;
    return;
  }
  Json rows = *result.rows;
  for (const Json& row : rows)
    fmt::print("{:28} {:24} {}; best of 1, 2, …: {}\n", row["problem"].get<std::string>(),
               row["optimizer"].get<std::string>(), row["options"].dump(),
               row["source"]["best_of"].dump());
  if (given.table.empty()) return;
  if (std::filesystem::exists(given.table)) rows = joined(read_json(given.table).at("rows"), rows);
  const Json grid{
      {"points", plan.grid.values.size()},
      {"seeds", given.seeds},
      {"budget", {{"iterations", given.budget.iterations}, {"work", given.budget.work}}},
      {"score", "median work to 1e-6, then median final loss"}};
  write_text(given.table, text_of(grid, rows));
}

}  // namespace

void add_tune(CLI::App& app, Session& session) {
  const auto given = std::make_shared<TuneArguments>();
  CLI::App* verb = app.add_subcommand(
      "tune", "Choose a rate for each pair over a grid, on tuning seeds, with an equal budget");
  verb->add_option("SPEC,--problem", given->problem, "Problems, as in `isoline run`")->required();
  verb->add_option("--optimizer", given->optimizer,
                   "Names of optimizers (default: sip and all of first order)");
  verb->add_option("--grid", given->grid, "Option and its values: low..high x count")
      ->capture_default_str();
  verb->add_option("--unit", given->unit,
                   "Unit of the grid: one, the problem's Cauchy step, or the published rate")
      ->check(CLI::IsMember({"one", "cauchy", "published"}))
      ->capture_default_str();
  verb->add_option("--tuning-seeds", given->seeds, "Seeds, apart from those that judge")
      ->capture_default_str();
  verb->add_option("--work", given->budget.work, "Most work of a run")->capture_default_str();
  verb->add_option("--iterations", given->budget.iterations, "Most iterations of a run")
      ->capture_default_str();
  verb->add_option("--jobs", given->jobs, "Runs at a time")->capture_default_str();
  verb->add_option("--out", given->folder, "Folder of the records")->capture_default_str();
  verb->add_option("--table", given->table, "Table of rates to write or to add to");
  verb->callback([given, &session] { tune_and_write(*given, session); });
}

}  // namespace isoline::benchmarks
