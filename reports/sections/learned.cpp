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

// Medians over seeds of the runs that made a step.
Real median_per_run(const Comparison& c, const Cell& cell, Real (*value)(const Summary&)) {
  const Rows rows =
      c.where(cell.runs, [](const Run& run) { return run.record->summary.iterations > 0; });
  return c.aggregate(rows, [&](const Run& run) { return value(run.record->summary); }).median;
}

// Methods in order of their error in x.
std::string reading_of(const Comparison& c, std::size_t p, const std::vector<std::size_t>& order) {
  const auto least =
      std::ranges::min_element(order, {}, [&](std::size_t s) { return c.cell(p, s).loss.median; });
  const Cell &lowest = c.cell(p, *least), &nearest = c.cell(p, order[0]);
  const std::string first = setting_text(c, p, order[0]);
  if (*least == order[0])
    return fmt::format("{} has both the least error in x, {}, and the least loss, {}.", first,
                       figure(nearest.x_error.median), figure(nearest.loss.median));
  return fmt::format(
      "Loss and error rank methods differently here: {} has the least loss, {}, at an error in x "
      "of {}; {} has the least error in x, {}, at a loss of {}.",
      setting_text(c, p, *least), figure(lowest.loss.median), figure(lowest.x_error.median), first,
      figure(nearest.x_error.median), figure(nearest.loss.median));
}

Table learned_table(const Comparison& c, std::size_t p, const std::vector<std::size_t>& order) {
  const Sheet* sheet = c.problems[p].sheet;
  Table table{.id = fmt::format("learned-{}", p),
              .title = problem_name(c.problems[p]),
              .reading = reading_of(c, p, order),
              .caption = sheet == nullptr ? "" : sheet->note,
              .columns = {"optimizer", "error in x", "loss in y", "iterations", "ms each", "runs",
                          "failed"},
              .topic = {.problem = p}};
  for (const std::size_t s : order) {
    const Cell& cell = c.cell(p, s);
    const Real iterations =
        median_per_run(c, cell, [](const Summary& end) { return Real(end.iterations); });
    const Real milliseconds_each = median_per_run(
        c, cell, [](const Summary& end) { return 1e3 * end.wall_seconds / Real(end.iterations); });
    const Marks marks{.has_extra_information = !cell.privileges.empty(),
                      .is_imported = c.optimizers[s].is_imported};
    table.rows.push_back({setting_text(c, p, s) + marks_text(marks), figure(cell.x_error),
                          figure(cell.loss), figure(iterations == kNever ? 0 : iterations),
                          (cell.is_timed_alone ? "" : "≈ ") + figure(milliseconds_each),
                          std::to_string(cell.runs.size()), std::to_string(cell.failed)});
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

}  // namespace

Section learned_section(const Comparison& c) {
  Section section{.id = "learned",
                  .title = "Learned problems",
                  .otherwise = "This report has no learned problems."};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) order.push_back(s);
    std::ranges::stable_sort(order, {}, [&](std::size_t s) { return c.cell(p, s).x_error.median; });
    if (!order.empty()) section.tables.push_back(learned_table(c, p, order));
  }
  if (!section.tables.empty())
    section.lead = "On the validation samples: medians over seeds and their range.";
  return section;
}

// Amortized cost: what a network takes to be trained and then for one example,
// beside what solvers take on single instances of the same physics to the error in x that it has,
// and from how many instances on training has paid. Holl, Koltun, Thuerey (2022), Table 1.

namespace {

constexpr Real kUnknown = std::numeric_limits<Real>::quiet_NaN();

// One method that trained, or one that solved single instances, over its runs.
struct Side {
  std::size_t problem = 0, optimizer = 0;
  Spread seconds;  // of the processor: to the end, or to the error that is asked
};

struct Trained : Side {
  Real x_error = kNever;      // the median over seeds, on the validation
  Real inference = kUnknown;  // seconds an example
};

// Nothing where no run tells the options.
const OptionValues* options_of(const Comparison& c, std::size_t problem) {
  const auto run = std::ranges::find(c.runs, problem, &Run::problem);
  return run == c.runs.end() ? nullptr : &run->record->request.problem.options;
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
  const auto seconds = [&](const Run& run) {
    return is_failure(run.record->status) ? kNever : seconds_of(*run.record);
  };
  return {problem, optimizer, c.aggregate(cell.runs, seconds, cell.missing())};
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

const Cell& cell_of(const Comparison& c, const Side& side) {
  return c.cell(side.problem, side.optimizer);
}

std::string named(const Comparison& c, const Side& side) {
  return setting_text(c, side.problem, side.optimizer) +
         marks_text({.has_extra_information = !cell_of(c, side).privileges.empty()});
}

TableCell pays_cell(const Trained& network, const Side& single) {
  const Real from = pays_from(network, single);
  if (std::isnan(from)) return "";
  if (!single.seconds.is_solved()) return "the solver has not reached it";
  return {from == kNever ? "never" : figure(from), {{"pays_from", from}}};
}

// Three digits, as milliseconds have them.
std::string in_seconds(Real seconds) { return milliseconds(1e-3 * seconds); }

TableCell time_cell(const Comparison& c, const Side& side, std::string (*written)(Real)) {
  const Real seconds = side.seconds.median;
  return {(cell_of(c, side).is_timed_alone || seconds == kNever ? "" : "≈ ") + written(seconds),
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
          time_cell(c, network, in_seconds),
          inference,
          time_cell(c, single, milliseconds),
          fmt::format("{}/{}", times.n - times.unsolved, times.n),
          fmt::format("{}, {}", cell_of(c, network).failed, cell_of(c, single).failed),
          pays_cell(network, single)};
}

std::string reading_of(const Comparison& c, const Trained& network, const Side& single) {
  if (!single.seconds.is_solved())
    return fmt::format(
        "No solver in this report reaches the error of the network of {}, {}, on half of its "
        "instances.",
        named(c, network), figure(network.x_error));
  if (single.seconds.median == 0)
    return fmt::format(
        "The network of {} has the error {}, and {} starts with an error that small: the training "
        "has not paid off yet.",
        named(c, network), figure(network.x_error), named(c, single));
  const std::string each = fmt::format(
      "{} takes {} ms per instance to the error {} of the network of {}, whose training took {} s",
      named(c, single), milliseconds(single.seconds.median), figure(network.x_error),
      named(c, network), in_seconds(network.seconds.median));
  const Real from = pays_from(network, single);
  if (std::isnan(from)) return each + "; the time of the network was not measured.";
  if (from == kNever) return each + ": training never pays off.";
  return fmt::format("{} and which takes {} ms: training pays off from {} instances on.", each,
                     milliseconds(network.inference), figure(from));
}

Table table_of(const Comparison& c, std::size_t p, const std::vector<Trained>& networks,
               const std::vector<std::size_t>& instances) {
  Table table{
      .id = fmt::format("amortized-{}", p),
      .title = shown_spec(c.problems[p].spec),
      .reading = "",
      .caption =
          "Medians over seeds in processor time; each seed of a solver is another instance. "
          "Errors of solvers are read at stored iterations, so their times are upper bounds, and "
          "0 if the start has that error. The network is timed on a batch, divided by its size.",
      .columns = {"network of", "solver", "error in x", "training, s", "per example, ms",
                  "solver to that error, ms", "there", "failed", "pays off from"},
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
                  .otherwise =
                      "No problem in this report was both learned and solved instance by "
                      "instance."};
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
        "A network is trained once and then solves each instance in one pass; a solver begins "
        "again with each. The table gives the number of instances from which training pays off, "
        "at the error of the network.";
  return section;
}

}  // namespace isoline::reports
