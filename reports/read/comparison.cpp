// Puts runs into cells, aggregates them over seeds, ranks and counts.
#include "reports/read/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "reports/read/axes.h"
#include "reports/read/ranking.h"
#include "reports/read/reached.h"

namespace isoline::reports {
namespace {

// Places of names on an axis.
using Places = std::unordered_map<std::string, std::size_t>;

template <class Axis>
Places places(const std::vector<Axis>& axis, std::string Axis::*name) {
  Places at;
  for (std::size_t i = 0; i < axis.size(); ++i) at.emplace(axis[i].*name, i);
  return at;
}

// Seeds of each pair, by problem and optimizer.
using Seeds = std::vector<std::vector<std::set<std::uint64_t>>>;

// Those of a problem that were asked of more than half of the methods that were asked it: whoever
// lacks one of them is not measured by the rest. Where no plan tells what was asked, half are
// enough.
std::set<std::uint64_t> usual_seeds(const std::vector<std::set<std::uint64_t>>& asked,
                                    bool has_plan) {
  std::map<std::uint64_t, std::size_t> counts;
  std::size_t methods = 0;
  for (const auto& seeds : asked) {
    methods += !seeds.empty();
    for (const std::uint64_t seed : seeds) ++counts[seed];
  }
  std::set<std::uint64_t> usual;
  for (const auto& [seed, count] : counts)
    if (2 * count > methods || (!has_plan && 2 * count == methods)) usual.insert(seed);
  return usual;
}

// Counts the seeds each cell lacks. They never got anywhere: leaving a run out betters no median.
void fill_planned(Comparison& c, const Seeds& ran, const Seeds& asked) {
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::set<std::uint64_t> usual = usual_seeds(asked[p], !c.study->plan.cells.empty());
    for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
      if (asked[p][s].empty()) continue;
      std::set<std::uint64_t> all = asked[p][s];
      all.insert(usual.begin(), usual.end());
      for (const std::uint64_t seed : ran[p][s]) all.erase(seed);
      c.cells[p][s].planned = c.cells[p][s].runs.size() + all.size();
    }
  }
}

// Puts each run and each planned cell where it belongs.
void fill_cells(Comparison& c, const OptimizerLabels& label) {
  const Places problem = places(c.problems, &ProblemAxis::spec);
  const Places optimizer = places(c.optimizers, &OptimizerAxis::label);
  c.cells.assign(c.problems.size(), std::vector<Cell>(c.optimizers.size()));
  const BestKnown best(*c.study);
  std::unordered_set<std::string> answered;
  Seeds ran(c.problems.size(), std::vector<std::set<std::uint64_t>>(c.optimizers.size()));
  for (const Record& record : c.study->runs) {
    Run run{.record = &record,
            .problem = problem.at(record.request.problem.spec),
            .is_timed_alone = record.provenance.run.is_timed_alone()};
    run.aim = c.problems[run.problem].aim;
    fill_reached(run, best, c.problems[run.problem].prices, c.yardstick);
    answered.insert(record.cell);
    for (const std::string& name :
         label.of(record.request.problem.spec, record.request.optimizer.spec)) {
      run.optimizer = optimizer.at(name);
      c.cells[run.problem][run.optimizer].runs.push_back(c.runs.size());
      ran[run.problem][run.optimizer].insert(record.request.seed);
      c.runs.push_back(run);
      run.is_repeated = true;
    }
  }
  Seeds asked = ran;
  for (const PlannedCell& cell : c.study->plan.cells)
    if (answered.contains(cell.cell))
      ++c.answered;
    else {
      c.missing.push_back(cell);
      for (const std::string& name : label.of(cell.problem, cell.optimizer))
        asked[problem.at(cell.problem)][optimizer.at(name)].insert(cell.seed);
    }
  fill_planned(c, ran, asked);
  c.planned = c.study->plan.cells.size();
  if (c.planned == 0) c.planned = c.answered = c.study->runs.size();
}

// Over runs, and over so many that are missing.
template <class Value>
Spread spread_over(const Comparison& c, const Cell& cell, Value value, std::size_t missing = 0) {
  std::vector<Real> values(missing, kNever);
  for (const std::size_t run : cell.runs) values.push_back(value(c.runs[run]));
  return spread_of(std::move(values));
}

void aggregate(const Comparison& c, Cell& cell) {
  bool is_truth_known = false;
  std::size_t inapplicable = 0;
  for (const std::size_t run : cell.runs) {
    const Record& record = *c.runs[run].record;
    ++cell.statuses[record.status];
    cell.failed += is_failure(record.status);
    inapplicable += record.status == Status::inapplicable;
    is_truth_known = is_truth_known || !std::isnan(record.summary.start_x_error);
    cell.is_timed_alone = cell.is_timed_alone && c.runs[run].is_timed_alone;
    add_missing(cell.privileges, record.privileges);
  }
  if (!cell.runs.empty() && inapplicable == cell.runs.size()) {
    const std::string& reason = c.runs[cell.runs[0]].record->message;
    cell.inapplicable = reason.empty() ? "no reason given" : reason;
    return;
  }
  if (cell.runs.empty()) return;
  const std::size_t missing = cell.planned - cell.runs.size();
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    for (const Measure by : kMeasures)
      cell.taken[by][t] = spread_over(
          c, cell, [t, by](const Run& run) { return run.taken[by][t]; }, missing);
    for (const std::size_t run : cell.runs)
      cell.is_bound[t] = cell.is_bound[t] || c.runs[run].is_bound[t];
  }
  cell.headline = cell.taken[c.yardstick.by];
  cell.loss = spread_over(c, cell, [](const Run& run) { return run.record->summary.loss; });
  if (is_truth_known)
    cell.x_error = spread_over(c, cell, [](const Run& run) { return run.record->summary.x_error; });
}

void summarize_runs(Comparison& c) {
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    if (c.runs[i].is_repeated) continue;
    const Record& record = *c.runs[i].record;
    ++c.statuses[record.status];
    if (is_failure(record.status)) c.failures.push_back(i);
    c.seeds.push_back(record.request.seed);
    c.is_any_timed_together = c.is_any_timed_together || !c.runs[i].is_timed_alone;
  }
  std::ranges::sort(c.seeds);
  c.seeds.erase(std::unique(c.seeds.begin(), c.seeds.end()), c.seeds.end());
}

}  // namespace

Costs median_costs(const Comparison& c, std::size_t tolerance) {
  return median_costs(c, tolerance, c.yardstick.by);
}

Costs median_costs(const Comparison& c, std::size_t tolerance, Measure by) {
  Costs costs;
  for (const auto& row : c.cells) {
    costs.emplace_back();
    for (const Cell& cell : row)
      costs.back().push_back(
          cell.planned == 0
              ? std::nullopt
              : std::optional<Real>(cell.taken[by][tolerance].median / least_unit(by)));
  }
  return costs;
}

std::map<std::string, std::vector<std::size_t>> problems_by_name(const Comparison& c) {
  std::map<std::string, std::vector<std::size_t>> names;
  for (std::size_t p = 0; p < c.problems.size(); ++p) names[c.problems[p].name].push_back(p);
  return names;
}

std::vector<std::size_t> ranking(const Comparison& comparison, std::size_t problem) {
  if (comparison.problems[problem].is_learned)
    return equal_work(comparison, problem).nearest_first();
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < comparison.optimizers.size(); ++s)
    if (comparison.cell(problem, s).is_measured()) order.push_back(s);
  std::ranges::stable_sort(order, {}, [&](std::size_t s) {
    const Cell& cell = comparison.cell(problem, s);
    return std::array{cell.headline[2].median, cell.headline[1].median, cell.headline[0].median,
                      cell.loss.median};
  });
  return order;
}

namespace {

void fill_brief(std::vector<OptimizerAxis>& optimizers) {
  std::vector<std::string> labels;
  for (const OptimizerAxis& optimizer : optimizers) labels.push_back(optimizer.label);
  const std::vector<std::string> brief = brief_labels(labels);
  for (std::size_t s = 0; s < optimizers.size(); ++s) optimizers[s].brief = brief[s];
}

}  // namespace

Comparison compare_optimizers(const Study& study, const Yardstick& yardstick) {
  Comparison c{.study = &study, .yardstick = yardstick};
  const OptimizerLabels label(study);
  c.problems = problem_axis(study);
  c.optimizers = optimizer_axis(study, label);
  fill_brief(c.optimizers);
  fill_cells(c, label);
  for (auto& row : c.cells)
    for (Cell& cell : row) aggregate(c, cell);
  fill_standings(c);
  summarize_runs(c);
  return c;
}

}  // namespace isoline::reports
