// Learning problems: the error in x beside the loss in y, and where the two rank methods
// differently, the limitation that Holl, Koltun, Thuerey (2022) name themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Rows steppers(const Comparison& c, const Cell& cell) {
  return c.where(cell.runs, [](const Run& run) { return run.record->summary.iterations > 0; });
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
  const Spread& best = nearest.x_error;
  const Spread* const next = order.size() < 2 ? nullptr : &c.cell(p, order[1]).x_error;
  if (next != nullptr && best.n < kFewestForInterval && best.high >= next->low) {
    std::vector<std::string> ranges;
    for (const std::size_t s : {order[0], order[1]}) {
      const Spread& error = c.cell(p, s).x_error;
      ranges.push_back(words("learned.range", setting_text(c, p, s), reached_figure(error.low),
                             reached_figure(error.high)));
    }
    table.reading = words("learned-table.overlap", best.n, joined(ranges, "; "));
  } else {
    table.reading =
        words(least == order[0] ? "learned-table.both" : "learned-table.differ",
              setting_text(c, p, least), lowest.loss.median, lowest.x_error.median,
              setting_text(c, p, order[0]), nearest.x_error.median, nearest.loss.median);
  }
  for (const std::size_t s : order) {
    const Cell& cell = c.cell(p, s);
    const auto count = [](const Run& run) { return Real(run.record->summary.iterations); };
    const Real iterations = c.aggregate(steppers(c, cell), count).median;
    const Marks marks{.has_extra_information = !cell.privileges.empty(),
                      .is_imported = c.optimizers[s].is_imported};
    table.rows.push_back({setting_text(c, p, s) + marks_text(marks), figure(cell.x_error),
                          figure(cell.loss), figure(iterations == kNever ? 0 : iterations),
                          (cell.is_timed_alone ? "" : "≈ ") + figure(step_costs(c, cell)[1]),
                          std::to_string(cell.runs.size()), std::to_string(cell.failed)});
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

// The text of a report has the first row of each ratio, this table the others.
Table ratio_readings(const Comparison& c, const std::vector<Judgement>& claims) {
  Table table = worded_table("ratio-readings");
  for (const auto& [methods, readings] : ratio_claims(c, claims)) {
    const auto& [p, under, over] = methods;
    const auto add = [&](const std::string& read, Real ratio, Real low, Real high,
                         std::size_t seeds) {
      const std::string names = setting_text(c, p, over) + " / " + setting_text(c, p, under);
      const bool is_known = low > 0 && high < kNever;
      table.rows.push_back({problem_name(c.problems[p]), names, read, multiple(ratio),
                            is_known ? multiple(low) + " to " + multiple(high) : "",
                            std::to_string(seeds)});
      table.row_topics.push_back({.optimizer = over, .problem = p});
    };
    const EqualWork equal = equal_work(c, p);
    const AtEqualWork &least = *equal.methods[under], &other = *equal.methods[over];
    const TimesLarger times = times_larger(least, other);
    const bool has_interval = times.interval && !times.is_range();
    add(words("ratio-readings.text"), times.times, has_interval ? times.interval->low : 0,
        has_interval ? times.interval->high : kNever, times.seeds);
    add(words("ratio-readings.end"),
        c.cell(p, over).x_error.median / c.cell(p, under).x_error.median, 0, kNever,
        other.errors.size());
    for (const Judgement* claim : readings) {
      const auto add_measured = [&](const std::string& how, const Measurement& one) {
        add(claim->id + ": " + claim->quantity + how, one.value, one.low, one.high, one.n);
      };
      add_measured("", *claim->measured);
      for (const OtherReading& one : claim->others) add_measured("; " + one.how, one.measured);
    }
  }
  return table;
}

}  // namespace

std::array<Real, 2> step_costs(const Comparison& c, const Cell& cell) {
  const auto each = [&](auto spent) {
    const auto of = [=](const Run& run) {
      return Real(spent(run.record->summary)) / Real(run.record->summary.iterations);
    };
    return c.aggregate(steppers(c, cell), of).median;
  };
  return {each([](const auto& summary) { return summary.work; }),
          each([](const auto& summary) { return 1e3 * summary.wall_seconds; })};
}

bool is_error_ratio(const Judgement& claim) {
  const auto is_named = [&](const EvidenceTerm& term) {  // else it is the best of several
    return claim.quantity.find(term.method) != std::string::npos;
  };
  return claim.evidence.kind == "ratio" && claim.measured && claim.evidence.terms.size() == 2 &&
         std::ranges::all_of(claim.evidence.terms, is_named) &&
         claim.evidence.column.find("x_error") != std::string::npos;
}

RatioClaims ratio_claims(const Comparison& c, const std::vector<Judgement>& claims) {
  RatioClaims all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const std::vector<std::size_t> order = equal_work(c, p).nearest_first();
    for (const Judgement& claim : claims) {
      if (!is_error_ratio(claim)) continue;
      const auto row = [&](const EvidenceTerm& term) {
        return std::ranges::find_if(order, [&](std::size_t s) {
          return term.problem == c.problems[p].spec && term.method == c.optimizers[s].method;
        });
      };
      const auto over = row(claim.evidence.terms[0]), under = row(claim.evidence.terms[1]);
      if (over != order.end() && under != order.end() && over != under)
        all[{p, *under, *over}].push_back(&claim);
    }
  }
  return all;
}

Section learned_section(const Comparison& c, const std::vector<Judgement>& claims) {
  Section section = worded_section("learned");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) order.push_back(s);
    std::ranges::stable_sort(order, {}, [&](std::size_t s) { return c.cell(p, s).x_error.median; });
    if (!order.empty()) section.tables.push_back(learned_table(c, p, order));
  }
  if (Table readings = ratio_readings(c, claims); !readings.rows.empty())
    section.tables.push_back(std::move(readings));
  return section;
}

// Amortized cost: what a network takes to be trained and then for one example,
// beside what solvers take on single instances of the same physics to the error in x that it has,
// and from how many instances on training has paid. Holl, Koltun, Thuerey (2022), Table 1.

namespace {

// One method that trained, or one that solved single instances, over its runs.
struct Side {
  std::size_t problem = 0, optimizer = 0;
  const Cell* cell = nullptr;
  std::string name;
  Spread seconds, iterations;  // of the processor: to the end, or to the error that is asked
};

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

// Seconds of an example; not-a-number where it was not measured.
Real inference_seconds(const ProblemAxis& problem) {
  const MeasuredPrices* prices = prices_of(problem);
  const MeasuredPrice* price = prices == nullptr ? nullptr : price_of(*prices, kInference);
  return price == nullptr ? kUnknown : price->price * prices->forward_seconds;
}

// `spent_by` each run, seconds and iterations; what failed or is missing never got there.
template <class Spent>
Side side_of(const Comparison& c, std::size_t problem, std::size_t optimizer, Spent spent_by) {
  const Cell& cell = c.cell(problem, optimizer);
  const auto spent = [&](auto part) {
    const auto of = [=](const Run& run) {
      return is_failure(run.record->status) ? kNever : Real(spent_by(*run.record).*part);
    };
    return c.aggregate(cell.runs, of, cell.missing());
  };
  return {problem,
          optimizer,
          &cell,
          setting_text(c, problem, optimizer) +
              marks_text({.has_extra_information = !cell.privileges.empty()}),
          spent(&std::pair<Real, Real>::first),
          spent(&std::pair<Real, Real>::second)};
}

// The nearest to x first.
std::vector<Side> trained_on(const Comparison& c, std::size_t p) {
  std::vector<Side> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.cell(p, s).is_measured() && c.cell(p, s).x_error.is_solved())
      all.push_back(side_of(c, p, s, [](const Record& record) {
        return std::pair(record.summary.processor_seconds, Real(record.summary.iterations));
      }));
  std::ranges::stable_sort(all, {}, [](const Side& side) { return side.cell->x_error.median; });
  return all;
}

// The fastest to that error first.
std::vector<Side> singles_to(const Comparison& c, const std::vector<std::size_t>& instances,
                             Real x_error) {
  // At the kept points of a run; 0 where its start has that error.
  const auto spent_to = [=](const Record& record) -> std::pair<Real, Real> {
    const Curve& curve = record.curve;
    const auto at = std::ranges::find_if(curve.x_error, [=](Real x) { return x <= x_error; });
    if (at == curve.x_error.end()) return {kNever, kNever};
    const auto i = static_cast<std::size_t>(at - curve.x_error.begin());
    return {i == 0 ? 0 : curve.processor_seconds[i], Real(curve.iteration[i])};
  };
  std::vector<Side> all;
  for (const std::size_t p : instances)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) all.push_back(side_of(c, p, s, spent_to));
  std::ranges::stable_sort(all, {}, [](const Side& side) {
    return std::pair(side.seconds.median, side.seconds.unsolved);
  });
  return all;
}

// From how many instances on training has cost less; infinite where it never does, nothing known
// where a time is.
Real pays_from(const Side& network, const Side& single, Real inference) {
  const Real training = network.seconds.median, each = single.seconds.median;
  if (std::isnan(inference) || !network.seconds.is_solved()) return kUnknown;
  if (each == kNever) return 1;
  const Real saved = each - inference;
  return saved > 0 ? std::max(1.0, std::ceil(training / saved)) : kNever;
}

// Three digits, as milliseconds have them.
std::string in_seconds(Real seconds) { return milliseconds(1e-3 * seconds); }

TableCell time_cell(const Side& side, std::string (*written)(Real)) {
  const Real seconds = side.seconds.median;
  return {(side.cell->is_timed_alone || seconds == kNever ? "" : "≈ ") + written(seconds),
          {{"seconds", seconds}}};
}

std::vector<TableCell> amortized_row(const Side& network, const Side& single, Real inference) {
  const Spread& times = single.seconds;
  const Real from = pays_from(network, single, inference);
  TableCell pays = "", example = "";
  if (!std::isnan(inference)) example = {milliseconds(inference), {{"seconds", inference}}};
  if (!std::isnan(from) && !times.is_solved()) pays = words("amortized-table.open");
  if (!std::isnan(from) && times.is_solved())
    pays = {from == kNever ? "never" : figure(from), {{"pays_from", from}}};
  std::vector<TableCell> row = {network.name,
                                single.name,
                                number_cell("x_error", network.cell->x_error.median),
                                time_cell(network, in_seconds),
                                number_cell("training_iterations", network.iterations.median),
                                example,
                                time_cell(single, milliseconds),
                                number_cell("iterations", single.iterations.median),
                                fmt::format("{}/{}", times.n - times.unsolved, times.n),
                                fmt::format("{}, {}", network.cell->failed, single.cell->failed),
                                pays};
  constexpr std::size_t kOfSolver = 6;  // the first column of it
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Side& side = i < kOfSolver ? network : single;
    row[i].of = {side.problem, side.optimizer};
  }
  return row;
}

std::string reading_of(const Side& network, const Side& single, Real inference) {
  const Real from = pays_from(network, single, inference);
  const char* key = !single.seconds.is_solved()  ? "amortized-table.unreached"
                    : single.seconds.median == 0 ? "amortized-table.start"
                    : std::isnan(from)           ? "amortized-table.untimed"
                    : from == kNever             ? "amortized-table.never"
                                                 : "amortized-table.pays";
  return words(key, single.name, milliseconds(single.seconds.median), network.cell->x_error.median,
               network.name, in_seconds(network.seconds.median), milliseconds(inference), from);
}

}  // namespace

Section amortized_section(const Comparison& c) {
  Section section = worded_section("amortized");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const Real inference = inference_seconds(c.problems[p]);
    const std::vector<std::size_t> instances = instances_of(c, p);
    Table table = worded_table("amortized-table", shown_spec(c.problems[p].spec));
    table.id = fmt::format("amortized-{}", p);
    table.topic = {.problem = p};
    table.names = 2;
    for (const Side& network : trained_on(c, p)) {
      const std::vector<Side> singles = singles_to(c, instances, network.cell->x_error.median);
      for (const Side& single : std::span(singles).first(std::min(singles.size(), kMostLines))) {
        if (table.reading.empty()) table.reading = reading_of(network, single, inference);
        table.rows.push_back(amortized_row(network, single, inference));
        table.row_topics.push_back({.optimizer = single.optimizer});
      }
    }
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  }
  return section;
}

}  // namespace isoline::reports
