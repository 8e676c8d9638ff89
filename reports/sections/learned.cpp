// Learning problems: the error in x beside the loss in y, and where the two rank methods
// differently, the limitation that Holl, Koltun, Thuerey (2022) name themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/evidence.h"
#include "reports/sections/origins.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct LearnedRow {
  std::size_t problem = 0, optimizer = 0;
  Spread x_error, loss;             // on the validation, after the last iteration, over seeds
  Real iterations = 0;              // median
  Real milliseconds_each = kNever;  // median time of an iteration
  std::size_t runs = 0, failed = 0;
  bool is_timed_alone = true;
};

LearnedRow learned_row(const Comparison& c, std::size_t problem, std::size_t optimizer) {
  const Cell& cell = c.cell(problem, optimizer);
  LearnedRow row{.problem = problem,
                 .optimizer = optimizer,
                 .x_error = cell.x_error,
                 .loss = cell.loss,
                 .runs = cell.runs.size(),
                 .failed = cell.failed,
                 .is_timed_alone = cell.is_timed_alone};
  std::vector<Real> iterations, milliseconds;
  for (const std::size_t run : cell.runs) {
    const Summary& summary = c.runs[run].record->summary;
    if (summary.iterations == 0) continue;
    iterations.push_back(static_cast<Real>(summary.iterations));
    milliseconds.push_back(1e3 * summary.wall_seconds / iterations.back());
  }
  if (iterations.empty()) return row;
  row.iterations = median_of(std::move(iterations));
  row.milliseconds_each = median_of(std::move(milliseconds));
  return row;
}

std::string label(const Comparison& c, const LearnedRow& row) {
  return setting_text(c, row.problem, row.optimizer);
}

// Rows are in order of their error in x.
std::string reading_of(const Comparison& c, const std::vector<LearnedRow>& rows) {
  const LearnedRow& nearest = rows.front();
  const auto lowest =
      std::ranges::min_element(rows, {}, [](const LearnedRow& row) { return row.loss.median; });
  if (lowest->optimizer == nearest.optimizer)
    return fmt::format("{} has both the least error in x, {}, and the least loss, {}.",
                       label(c, nearest), figure(nearest.x_error.median),
                       figure(nearest.loss.median));
  return fmt::format(
      "Loss and error rank methods differently here: {} has the least loss, {}, at an error in x "
      "of {}; {} has the least error in x, {}, at a loss of {}.",
      label(c, *lowest), figure(lowest->loss.median), figure(lowest->x_error.median),
      label(c, nearest), figure(nearest.x_error.median), figure(nearest.loss.median));
}

Table table_of(const Comparison& c, std::size_t problem, const std::vector<LearnedRow>& rows) {
  const Sheet* sheet = c.problems[problem].sheet;
  Table table{.id = fmt::format("learned-{}", problem),
              .title = problem_name(c.problems[problem]),
              .reading = reading_of(c, rows),
              .caption = sheet == nullptr ? "" : sheet->note,
              .columns = {"optimizer", "error in x", "loss in y", "iterations", "ms each", "runs",
                          "failed"},
              .topic = {.problem = problem}};
  for (const LearnedRow& row : rows) {
    const bool is_privileged = !c.cell(problem, row.optimizer).privileges.empty();
    table.rows.push_back({label(c, row) + (is_privileged ? " †" : "") +
                              (c.optimizers[row.optimizer].is_imported ? " §" : ""),
                          figure(row.x_error), figure(row.loss), figure(row.iterations),
                          (row.is_timed_alone ? "" : "≈ ") + figure(row.milliseconds_each),
                          std::to_string(row.runs), std::to_string(row.failed)});
    table.row_topics.push_back({.optimizer = row.optimizer});
  }
  return table;
}

}  // namespace

Section learned_section(const Comparison& c) {
  Section section{.id = "learned",
                  .title = "What was learned",
                  .otherwise = "No problem of this report is learned."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    std::vector<LearnedRow> rows;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) rows.push_back(learned_row(c, p, s));
    std::ranges::stable_sort(rows, {}, [](const LearnedRow& row) { return row.x_error.median; });
    if (!rows.empty()) section.tables.push_back(table_of(c, p, rows));
  }
  if (!section.tables.empty())
    section.lead = "On the validation, medians over seeds and their range.";
  return section;
}

// Training once, or solving each: what a network takes to be trained and then for one example,
// beside what solvers take on single instances of the same physics to the error in x that it has,
// and from how many instances on training has paid. Holl, Koltun, Thuerey (2022), Table 1.

namespace {

constexpr Real kUnknown = std::numeric_limits<Real>::quiet_NaN();

// One method that trained, or one that solved single instances, over its runs.
struct Side {
  std::size_t problem = 0, optimizer = 0;
  Spread seconds;  // of the processor: to the end, or to the error that is asked
  std::size_t failed = 0;
  bool is_timed_alone = true;
  bool is_privileged = false;
};

struct Trained : Side {
  Real x_error = kNever;      // the median over seeds, on the validation
  Real inference = kUnknown;  // seconds an example
};

// Nothing where no run tells the options.
const OptionValues* options_of(const Comparison& c, std::size_t problem) {
  for (const Cell& cell : c.cells[problem])
    if (!cell.runs.empty()) return &c.runs[cell.runs[0]].record->request.problem.options;
  return nullptr;
}

// Direct problems of the same physics.
std::vector<std::size_t> instances_of(const Comparison& c, std::size_t learned) {
  std::vector<std::size_t> found;
  const OptionValues* options = options_of(c, learned);
  for (std::size_t p = 0; p < c.problems.size() && options != nullptr; ++p) {
    if (c.problems[p].is_learned || c.problems[p].name != c.problems[learned].name) continue;
    const OptionValues* own = options_of(c, p);
    if (own != nullptr && is_instance_of(*own, *options)) found.push_back(p);
  }
  return found;
}

Real inference_seconds(const Sheet* sheet, const std::string& spec) {
  if (sheet == nullptr || sheet->spec != spec || !sheet->prices) return kUnknown;
  const auto& rows = sheet->prices->oracles;
  const auto row = std::ranges::find(rows, kInference, &MeasuredPrice::oracle);
  return row == rows.end() ? kUnknown : row->price * sheet->prices->forward_seconds;
}

// `seconds_of` each run; what failed or is missing never got there.
template <class Seconds>
Side side_of(const Comparison& c, std::size_t problem, std::size_t optimizer, Seconds seconds_of) {
  const Cell& cell = c.cell(problem, optimizer);
  std::vector<Real> seconds(cell.planned - cell.runs.size(), kNever);
  for (const std::size_t run : cell.runs) {
    const Record& record = *c.runs[run].record;
    seconds.push_back(is_failure(record.status) ? kNever : seconds_of(record));
  }
  return {.problem = problem,
          .optimizer = optimizer,
          .seconds = spread_of(std::move(seconds)),
          .failed = cell.failed,
          .is_timed_alone = cell.is_timed_alone,
          .is_privileged = !cell.privileges.empty()};
}

// The nearest to x first.
std::vector<Trained> trained_on(const Comparison& c, std::size_t p) {
  std::vector<Trained> all;
  const Real inference = inference_seconds(c.problems[p].sheet, c.problems[p].spec);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const Cell& cell = c.cell(p, s);
    if (!cell.is_measured() || !cell.x_error.is_solved()) continue;
    const auto whole = [](const Record& record) { return record.summary.processor_seconds; };
    all.push_back({side_of(c, p, s, whole), cell.x_error.median, inference});
  }
  std::ranges::stable_sort(all, {}, &Trained::x_error);
  return all;
}

// When the run had that error, at its kept points; 0 where its start has it.
Real seconds_to(const Record& record, Real x_error) {
  const Curve& curve = record.curve;
  for (std::size_t i = 0; i < curve.x_error.size(); ++i)
    if (curve.x_error[i] <= x_error) return i == 0 ? 0 : curve.processor_seconds[i];
  return kNever;
}

// The fastest first.
std::vector<Side> singles_to(const Comparison& c, const std::vector<std::size_t>& instances,
                             Real x_error) {
  std::vector<Side> all;
  for (const std::size_t p : instances)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured())
        all.push_back(
            side_of(c, p, s, [&](const Record& record) { return seconds_to(record, x_error); }));
  std::ranges::stable_sort(all, {}, [](const Side& side) {
    return std::pair(side.seconds.median, side.seconds.unsolved);
  });
  return all;
}

// From how many instances on training has cost less; infinite where it never does, nothing known
// where a time is.
Real pays_from(const Trained& network, const Side& single) {
  const Real training = network.seconds.median, each = single.seconds.median;
  if (std::isnan(network.inference) || !network.seconds.is_solved()) return kUnknown;
  if (each == kNever) return 1;
  const Real saved = each - network.inference;
  return saved > 0 ? std::max(1.0, std::ceil(training / saved)) : kNever;
}

std::string named(const Comparison& c, const Side& side) {
  return setting_text(c, side.problem, side.optimizer) + (side.is_privileged ? " †" : "");
}

TableCell pays_cell(const Trained& network, const Side& single) {
  const Real from = pays_from(network, single);
  if (std::isnan(from)) return "";
  if (!single.seconds.is_solved()) return "the solver is not there";
  return {from == kNever ? "never" : figure(from), {{"pays_from", from}}};
}

// Three digits, as milliseconds have them.
std::string in_seconds(Real seconds) { return milliseconds(1e-3 * seconds); }

TableCell time_cell(const Side& side, std::string (*written)(Real)) {
  const Real seconds = side.seconds.median;
  return {(side.is_timed_alone || seconds == kNever ? "" : "≈ ") + written(seconds),
          {{"seconds", seconds}}};
}

std::vector<TableCell> amortized_row(const Comparison& c, const Trained& network,
                                     const Side& single) {
  const Spread& times = single.seconds;
  const TableCell inference =
      std::isnan(network.inference)
          ? TableCell("")
          : TableCell(milliseconds(network.inference), {{"seconds", network.inference}});
  return {named(c, network),
          named(c, single),
          {figure(network.x_error), {{"x_error", network.x_error}}},
          time_cell(network, in_seconds),
          inference,
          time_cell(single, milliseconds),
          fmt::format("{}/{}", times.n - times.unsolved, times.n),
          fmt::format("{}, {}", network.failed, single.failed),
          pays_cell(network, single)};
}

std::string reading_of(const Comparison& c, const Trained& network, const Side& single) {
  if (!single.seconds.is_solved())
    return fmt::format(
        "No solver that was run here reaches the error of the network of {}, {}, on half of its "
        "instances.",
        named(c, network), figure(network.x_error));
  if (single.seconds.median == 0)
    return fmt::format(
        "The network of {} has the error {}, and {} starts as near: its training has not paid yet.",
        named(c, network), figure(network.x_error), named(c, single));
  const std::string each = fmt::format(
      "{} takes {} ms an instance to the error {} of the network of {}, whose training took {} s",
      named(c, single), milliseconds(single.seconds.median), figure(network.x_error),
      named(c, network), in_seconds(network.seconds.median));
  const Real from = pays_from(network, single);
  if (std::isnan(from)) return each + "; what the network takes was not measured.";
  if (from == kNever) return each + ": it never pays.";
  return fmt::format("{} and which takes {} ms: training pays from {} instances on.", each,
                     milliseconds(network.inference), figure(from));
}

Table table_of(const Comparison& c, std::size_t p, const std::vector<Trained>& networks,
               const std::vector<std::size_t>& instances) {
  Table table{
      .id = fmt::format("amortized-{}", p),
      .title = shown_spec(c.problems[p].spec),
      .reading = "",
      .caption =
          "Medians over seeds in processor time; every seed of a solver is an instance of "
          "its own. Errors of solvers are read at kept iterations: they took at most that, and 0 "
          "where their start has it. "
          "The network is timed on a batch, a share of it an example.",
      .columns = {"network of", "solver", "error in x", "training, s", "an example, ms",
                  "solver to that error, ms", "there", "failed", "pays from"},
      .topic = {.problem = p},
      .align = "llrrrrrrr",
      .names = 2};
  for (const Trained& network : networks) {
    const std::vector<Side> singles = singles_to(c, instances, network.x_error);
    if (table.reading.empty()) table.reading = reading_of(c, network, singles.front());
    for (std::size_t i = 0; i < std::min(singles.size(), kMostLines); ++i) {
      table.rows.push_back(amortized_row(c, network, singles[i]));
      table.row_topics.push_back({.optimizer = singles[i].optimizer});
    }
  }
  return table;
}

}  // namespace

Section amortized_section(const Comparison& c) {
  Section section{.id = "amortized",
                  .title = "Training once, or solving each",
                  .otherwise = "No problem of this report was both learned and solved one by one."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const std::vector<Trained> networks = trained_on(c, p);
    const std::vector<std::size_t> instances = instances_of(c, p);
    if (networks.empty() || instances.empty()) continue;
    if (singles_to(c, instances, kNever).empty()) continue;
    section.tables.push_back(table_of(c, p, networks, instances));
  }
  if (!section.tables.empty())
    section.lead =
        "A network is trained once and then solves any instance in one pass; a solver begins anew "
        "with each. From how many instances on training has paid, at the network's own error.";
  return section;
}

}  // namespace isoline::reports
