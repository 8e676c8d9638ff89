// isoline tune: writes a table of rates from a recorded grid.
#include "benchmarks/run/tune.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/suite.h"
#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"
#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct TuneArguments {
  std::string problem, optimizer, suite, grid, unit = "one", seeds = "100..102";
  std::string table, folder = "results/tuning";
  std::int64_t iterations = 100'000, work = 2000;
  int jobs = 0;
  bool as_json = false, lists_all = false, leaves_out = false;
};

void declare(VerbArguments& verb, TuneArguments& given) {
  verb.text("SPEC,--problem", given.problem,
            "Problems, as in `isoline run`; with --suite, a filter");
  verb.text("--suite", given.suite,
            "Tune the pairs of problem and optimizer of this suite, with its budgets");
  verb.text("--optimizer", given.optimizer,
            "Names of optimizers (default: all with a tunable option)")
      .joined();
  verb.text("--grid", given.grid,
            "Option and its values, low..high x count (default: the method's tunable option "
            "at seven values around its default, and more if the best value is at an edge)");
  verb.text("--unit", given.unit,
            "Unit of the values in --grid: one, cauchy (the problem's Cauchy step) or published "
            "(the published rate)")
      .one_of({"one", "cauchy", "published"})
      .shown();
  verb.flag("--leave-one-out", given.leaves_out,
            "For each family of problems, choose the value that is best on the other families; all "
            "problems share one grid per method");
  verb.text("--tuning-seeds", given.seeds, "Seeds, which should not be used for results").shown();
  verb.whole("--work", given.work, "Maximum work of a run, in forward solves");
  verb.whole("--iterations", given.iterations, "Maximum number of iterations of a run");
  verb.whole("--jobs", given.jobs, "Number of runs at a time (default: one per core)", kJobs);
  verb.text("--out", given.folder, "Folder of the records").shown();
  verb.text(
      "--table", given.table,
      "Table of rates to write or to extend; with --leave-one-out, also NAME-tuned.json, with "
      "the best value on each problem");
  verb.flag("--all", given.lists_all, "List every pair of problem and optimizer, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON: the rows of the table");
  verb.plugins();
}

constexpr const char* kScore =
    "median work needed to reach 1e-6, in loss or in x; if it is not reached, the median loss or "
    "error in x at the end";

constexpr const char* kLeftOutScore =
    "mean over the other families, each the mean over its settings, of 1 - log2(work/least work of "
    "the method's values)/6, at least 0, and 0 if not solved; work is the median to 1e-6";

// The cells of a suite: with --leave-one-out of the blocks whose table of rates is the one that is
// written, else of those that name none.
std::vector<Request> cells_of(const Catalog& catalog, const TuneArguments& given) {
  Suite suite = read_suite(given.suite);
  const std::string own =
      given.leaves_out ? std::filesystem::path(given.table).stem().string() : std::string();
  std::erase_if(suite.blocks, [&](const MatrixBlock& block) { return block.rates != own; });
  require(!suite.blocks.empty(), [&] {
    return fmt::format("tune: no block of {} has {}", given.suite,
                       own.empty() ? "rates to tune: all name a table"
                                   : fmt::format("the rates '{}', as the table is named", own));
  });
  std::vector<Request> cells =
      read_as(given.suite, [&] { return expand(catalog, suite, Rates()); });
  return filtered(catalog, std::move(cells), given.problem, given.optimizer);
}

std::vector<Request> cells_named(const Catalog& catalog, const TuneArguments& given) {
  require(!given.problem.empty(), "tune: no problems: pass SPEC, --problem or --suite");
  const MatrixBlock block{.problems = {given.problem},
                          .optimizers = {given.optimizer.empty() ? "*" : given.optimizer},
                          .budget = {.iterations = given.iterations, .work = given.work}};
  return expand(catalog, {.name = "tuning", .title = "", .blocks = {block}}, Rates());
}

TuningPlan plan_of(const Catalog& catalog, const TuneArguments& given) {
  TuningPlan plan{.seeds = parse_seeds(given.seeds), .is_common = given.leaves_out};
  require(!given.leaves_out || given.grid.empty(),
          "tune: --leave-one-out uses one grid per method and cannot be combined with --grid");
  if (!given.grid.empty()) plan.grid = parse_grid(given.grid, given.unit);
  const Rates rates = Rates::builtin();
  std::set<std::pair<std::string, std::string>> known;
  std::set<std::string> families;
  for (const Request& cell :
       given.suite.empty() ? cells_named(catalog, given) : cells_of(catalog, given)) {
    const std::string& name = cell.optimizer.name;
    const bool is_foreign = !catalog.optimizers.at(name).needs_argument.empty();
    const std::string& known_as = is_foreign ? cell.optimizer.spec : name;
    const auto tunable = entry_of(catalog, name, cell.optimizer.options).tunable.option;
    if (tunable.empty() || !known.emplace(cell.problem.spec, known_as).second) continue;
    families.insert(cell.problem.name);
    // A common grid is around the defaults, whatever was published for a problem.
    const Rates::Row* row = given.leaves_out ? nullptr : rates.find(cell.problem, name);
    plan.pairs.push_back({.problem = cell.problem,
                          .optimizer = name,
                          .budget = cell.budget,
                          .options = is_foreign                  ? cell.optimizer.options
                                     : row && !row->is_from_grid ? row->options
                                                                 : OptionValues()});
  }
  require(!plan.pairs.empty(), "tune: none of these methods declares a tunable option");
  require(!given.leaves_out || families.size() > 1,
          "tune: --leave-one-out requires problems with at least two different names");
  return plan;
}

// The rows of the table that are not replaced, and the new ones, in order; one row per line, so
// that a diff shows one row per change.
void write_table(const TuneArguments& given, const TuningPlan& plan,
                 const std::filesystem::path& table, const Json& new_rows, const char* score) {
  std::map<std::pair<std::string, std::string>, std::string> rows;
  const auto add = [&](const Json& some) {
    for (const Json& row : some) rows[{row.at("problem"), row.at("optimizer")}] = json_text(row);
  };
  if (std::filesystem::exists(table)) {
    const Json earlier = read_json(table);
    require_valid(earlier, "rates", table.string());
    add(earlier.at("rows"));
  }
  add(new_rows);
  const Budget& budget = plan.pairs[0].budget;
  Json grid{{"points", plan.grid ? plan.grid->values.size() : kGridValues},
            {"seeds", given.seeds},
            {"budget", {{"iterations", budget.iterations}, {"work", budget.work}}},
            {"score", score}};
  if (!plan.grid && !plan.is_common) grid["extensions"] = kMostExtensions;
  std::string text = fmt::format("{{\"schema\": \"isoline.rates/1\",\n\"grid\": {},\n\"rows\": [",
                                 json_text(grid));
  const char* separator = "\n";
  for (const auto& [pair, row] : rows) {
    text += separator + row;
    separator = ",\n";
  }
  write_text(table, text + "\n]}\n");
}

bool is_failed(const TuningScore& score) {
  return !std::isfinite(score.work) && !std::isfinite(score.left);
}

// A bar a value, by its place among the scores: the best highest, a dot where it failed.
std::string bars(const TunedOption& tuned) {
  constexpr std::array<const char*, 8> kBars = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::vector<TuningScore> ordered;
  for (const TuningScore& score : tuned.scores)
    if (!is_failed(score)) ordered.push_back(score);
  std::ranges::sort(ordered, [](const auto& a, const auto& b) { return a < b; });
  ordered.erase(std::ranges::unique(ordered).begin(), ordered.end());
  std::string text;
  for (const TuningScore& score : tuned.scores) {
    const auto place =
        static_cast<std::size_t>(std::ranges::find(ordered, score) - ordered.begin());
    const std::size_t worst = std::max<std::size_t>(1, ordered.size() - 1);
    text += is_failed(score) ? "·" : kBars[(worst - std::min(place, worst)) * 7 / worst];
  }
  return text;
}

// The other values whose scores equal the best's.
std::vector<std::string> tied_values(const TunedOption& tuned) {
  std::vector<std::string> ties;
  for (std::size_t i = 0; i < tuned.values.size(); ++i)
    if (i != tuned.best && tuned.scores[i] == tuned.scores[tuned.best])
      ties.push_back(reports::figure(tuned.values[i]));
  return ties;
}

std::vector<reports::TableCell> tuning_row(const TunedOption& tuned) {
  const TuningScore& best = tuned.scores[tuned.best];
  std::string remark;
  if (tuned.is_at_edge)
    remark = fmt::format("at the edge: the {} value tried", tuned.best == 0 ? "lowest" : "highest");
  if (const auto ties = tied_values(tuned); !ties.empty())
    remark += (remark.empty() ? "ties with " : "; ties with ") + reports::joined(ties);
  if (is_failed(best)) remark = "every value failed; the value nearest the default is used";
  return {tuned.problem,
          tuned.optimizer,
          tuned.option,
          reports::figure(tuned.values[tuned.best]),
          bars(tuned),
          reports::reached_figure(best.work),
          reports::reached_figure(best.left),
          remark};
}

std::string tuning_summary(const TuningResult& result) {
  std::size_t edges = 0, ties = 0;
  for (const TunedOption& tuned : result.tuned) {
    edges += tuned.is_at_edge;
    ties += !tied_values(tuned).empty();
  }
  std::string text =
      fmt::format("{} tuned: {} with the best value at the edge of the grid, {} with a tie",
                  reports::counted(result.tuned.size(), "pair"), edges, ties);
  if (result.inapplicable > 0) text += fmt::format("; {} not applicable", result.inapplicable);
  return text + fmt::format(". {} in {}.", reports::counted(std::size_t(result.outcome.run), "run"),
                            duration_text(result.outcome.seconds));
}

// One line per method and family: the value that the other families choose.
reports::Table left_out_table(const Json& rows) {
  reports::Table table{
      .columns = {"family", "optimizer", "option", "value", "default", "score", "tuning work", ""},
      .align = "lllrrrrl",
      .names = 2};
  table.caption =
      "Value: the value that is best on the other families. Score: the mean score of this value "
      "over the other families; 1 is the least work of all values of the method. Tuning work: the "
      "nominal work of all trials of the method.";
  for (const Json& row : rows) {
    const Json& source = row.at("source");
    const auto grid = source.at("grid").begin();
    const auto& scores = source.at("mean_score");
    const auto at = std::ranges::find(grid.value(), source.at("value")) - grid.value().begin();
    table.rows.push_back({row.at("problem").get<std::string>(),
                          row.at("optimizer").get<std::string>(), grid.key(),
                          reports::figure(source.at("value").get<Real>()),
                          reports::figure(source.at("default").get<Real>()),
                          reports::figure(scores.at(static_cast<std::size_t>(at)).get<Real>()),
                          reports::figure(source.at("spent").get<Real>()),
                          source.contains("edge") ? "at the edge" : ""});
  }
  return table;
}

// How many pairs were tuned, at which edges the best stand and what ties; one line per pair, twenty
// at most unless all are wanted, with a plot of its scores in a few characters.
std::string tuning_text(const TuningResult& result, bool lists_all) {
  reports::Section section{
      .id = "tuning", .title = "Tuning", .otherwise = "No pair could be tuned."};
  section.readings = {{"", tuning_summary(result)}};
  reports::Table table{
      .columns = {"problem", "optimizer", "option", "best", "grid", "work", "final", ""},
      .align = "lllrlrrl",
      .names = 2};
  table.caption =
      "Grid: one bar per value, from the lowest value to the highest; the tallest bar marks the "
      "best value, and · marks a value whose runs diverged or failed. Work: the median work needed to reach "
      "1e-6 with the best value; ✗: at most half of the runs reached 1e-6. Final: the median final "
      "loss, or the median final error in x if success is judged by x.";
  for (const TunedOption& tuned : result.tuned) table.rows.push_back(tuning_row(tuned));
  if (!result.left_out_rows->empty()) table = left_out_table(*result.left_out_rows);
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
  return reports::terminal_section(section, lists_all ? reports::kAllRows : reports::kFewRows,
                                   output_columns());
}

int run(const TuneArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  const TuningPlan plan = plan_of(catalog, given);
  RunOptions options{.jobs = given.jobs > 0 ? given.jobs : one_a_core(),
                     .command = session.command()};
  if (!given.as_json) options.progress = Progress::style_of(STDERR_FILENO);
  const TuningResult result = tune(catalog, plan, given.folder, options);
  if (result.outcome.is_interrupted) return exit_code_of(result.outcome);
  print_failures(result.outcome, given.folder);
  const Json& rows = given.leaves_out ? *result.left_out_rows : *result.rows;
  say(stdout, given.as_json ? json_text(rows, 2) + "\n" : tuning_text(result, given.lists_all));
  if (given.table.empty()) return kGood;
  std::filesystem::path table = given.table;
  write_table(given, plan, table, rows, given.leaves_out ? kLeftOutScore : kScore);
  table.replace_filename(table.stem().string() + "-tuned.json");
  if (given.leaves_out) write_table(given, plan, table, *result.rows, kScore);
  return kGood;
}

}  // namespace

void register_tune(VerbRegistry& registry) {
  registry.add(verb_of<TuneArguments>(
      {.name = "tune",
       .help_position = 200,
       .summary = "Tune one option of each method for each problem, with equal budgets",
       .examples = "  isoline tune rosenbrock,heat --optimizer gd,adam --table rates.json\n"
                   "  isoline tune square --optimizer gd --grid rate=1e-3..1x7 --unit cauchy\n"
                   "  isoline tune --suite quick --optimizer adam --json\n"
                   "  isoline tune --leave-one-out sine,heat,burgers --table physics.json",
       .notes =
           "The best value needs the least median work to reach 1e-6. If several values do not "
           "reach 1e-6, the least remaining loss or error in x decides. Ties go to the value "
           "nearest the default. The output lists ties and best values at an edge of the grid."},
      declare, run));
}

}  // namespace isoline::benchmarks
