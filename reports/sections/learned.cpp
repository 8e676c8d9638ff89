// Learning problems: the error in x beside the loss in y, and where the two rank methods
// differently, the limitation that Holl, Koltun, Thuerey (2022) name themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

Table learned_table(const Comparison& c, std::size_t p, const std::vector<std::size_t>& order) {
  const Sheet* sheet = c.problems[p].sheet;
  Table table = worded_table("learned-table", problem_name(c.problems[p]));
  table.id = fmt::format("learned-{}", p);
  table.caption = sheet == nullptr ? "" : sheet->note;
  table.topic = {.problem = p};
  const std::size_t least =
      *std::ranges::min_element(order, {}, [&](std::size_t s) { return c.cell(p, s).loss.median; });
  const Cell &lowest = c.cell(p, least), &nearest = c.cell(p, order[0]);
  table.reading = words(least == order[0] ? "learned-table.both" : "learned-table.differ",
                        setting_text(c, p, least), lowest.loss.median, lowest.x_error.median,
                        setting_text(c, p, order[0]), nearest.x_error.median, nearest.loss.median);
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
  Section section = worded_section("learned");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) order.push_back(s);
    std::ranges::stable_sort(order, {}, [&](std::size_t s) { return c.cell(p, s).x_error.median; });
    if (!order.empty()) section.tables.push_back(learned_table(c, p, order));
  }
  if (section.is_empty()) section.lead.clear();
  return section;
}

// Amortized cost: what a network takes to be trained and then for one example,
// beside what solvers take on single instances of the same physics to the error in x that it has,
// and from how many instances on training has paid. Holl, Koltun, Thuerey (2022), Table 1.

namespace {

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
  const Real from = pays_from(network, single);
  TableCell pays = "", inference = "";
  if (!std::isnan(network.inference))
    inference = {milliseconds(network.inference), {{"seconds", network.inference}}};
  if (!std::isnan(from) && !times.is_solved()) pays = words("amortized-table.open");
  if (!std::isnan(from) && times.is_solved())
    pays = {from == kNever ? "never" : figure(from), {{"pays_from", from}}};
  return {named(c, network),
          named(c, single),
          number_cell("x_error", network.x_error),
          time_cell(c, network, in_seconds),
          inference,
          time_cell(c, single, milliseconds),
          fmt::format("{}/{}", times.n - times.unsolved, times.n),
          fmt::format("{}, {}", cell_of(c, network).failed, cell_of(c, single).failed),
          pays};
}

std::string reading_of(const Comparison& c, const Trained& network, const Side& single) {
  const Real from = pays_from(network, single);
  const char* key = !single.seconds.is_solved()  ? "amortized-table.unreached"
                    : single.seconds.median == 0 ? "amortized-table.start"
                    : std::isnan(from)           ? "amortized-table.untimed"
                    : from == kNever             ? "amortized-table.never"
                                                 : "amortized-table.pays";
  return words(key, named(c, single), milliseconds(single.seconds.median), network.x_error,
               named(c, network), in_seconds(network.seconds.median),
               milliseconds(network.inference), from);
}

Table amortized_table(const Comparison& c, std::size_t p, const std::vector<Trained>& networks,
                      const std::vector<std::size_t>& instances) {
  Table table = worded_table("amortized-table", shown_spec(c.problems[p].spec));
  table.id = fmt::format("amortized-{}", p);
  table.topic = {.problem = p};
  table.names = 2;
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
  Section section = worded_section("amortized");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const std::vector<Trained> networks = trained_on(c, p);
    const std::vector<std::size_t> instances = instances_of(c, p);
    if (networks.empty() || instances.empty()) continue;
    if (singles_to(c, instances, kNever).empty()) continue;
    section.tables.push_back(amortized_table(c, p, networks, instances));
  }
  if (section.is_empty()) section.lead.clear();
  return section;
}

}  // namespace isoline::reports
