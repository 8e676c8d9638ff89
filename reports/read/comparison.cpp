// Puts runs into cells, aggregates them over seeds, ranks and counts.
#include "reports/read/comparison.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "reports/read/axes.h"
#include "reports/read/leaders.h"
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

// Puts each run and each planned cell where it belongs.
void fill_cells(Comparison& c, const OptimizerLabels& label) {
  const Places problem = places(c.problems, &ProblemAxis::spec);
  const Places optimizer = places(c.optimizers, &OptimizerAxis::label);
  c.cells.assign(c.problems.size(), std::vector<Cell>(c.optimizers.size()));
  const BestKnown best(*c.study);
  std::unordered_set<std::string> answered;
  for (const Record& record : c.study->runs) {
    Run run{.record = &record,
            .problem = problem.at(record.request.problem.spec),
            .optimizer =
                optimizer.at(label(record.request.problem.spec, record.request.optimizer.spec)),
            .is_timed_alone = record.provenance.run.is_timed_alone()};
    run.aim = c.problems[run.problem].aim;
    fill_reached(run, best, c.problems[run.problem].prices, c.yardstick);
    c.cells[run.problem][run.optimizer].runs.push_back(c.runs.size());
    c.runs.push_back(run);
    answered.insert(record.cell);
  }
  for (const PlannedCell& cell : c.study->plan.cells)
    if (answered.contains(cell.cell))
      ++c.answered;
    else {
      c.missing.push_back(cell);
      ++c.cells[problem.at(cell.problem)][optimizer.at(label(cell.problem, cell.optimizer))]
            .planned;
    }
  c.planned = c.study->plan.cells.size();
  if (c.planned == 0) c.planned = c.answered = c.runs.size();
}

template <class Value>
Spread spread_over(const Comparison& c, const Cell& cell, Value value) {
  std::vector<Real> values;
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
  cell.planned += cell.runs.size();  // so far it held those missing
  if (!cell.runs.empty() && inapplicable == cell.runs.size()) {
    const std::string& reason = c.runs[cell.runs[0]].record->message;
    cell.inapplicable = reason.empty() ? "no reason given" : reason;
    return;
  }
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    for (const Measure by : kMeasures)
      cell.taken[by][t] =
          spread_over(c, cell, [t, by](const Run& run) { return run.taken[by][t]; });
    for (const std::size_t run : cell.runs)
      cell.is_bound[t] = cell.is_bound[t] || c.runs[run].is_bound[t];
  }
  cell.headline = cell.taken[c.yardstick.by];
  cell.loss = spread_over(c, cell, [](const Run& run) { return run.record->summary.loss; });
  if (is_truth_known)
    cell.x_error = spread_over(c, cell, [](const Run& run) { return run.record->summary.x_error; });
}

void mark_best(std::vector<Cell>& row) {
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    Real least = kNever;
    for (const Cell& cell : row) least = std::min(least, cell.headline[t].median);
    for (Cell& cell : row) cell.is_best[t] = least < kNever && cell.headline[t].median == least;
  }
}

void summarize_runs(Comparison& c) {
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
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
          cell.planned == 0 ? std::nullopt : std::optional<Real>(cell.taken[by][tolerance].median));
  }
  return costs;
}

std::map<std::string, std::vector<std::size_t>> problems_by_name(const Comparison& c) {
  std::map<std::string, std::vector<std::size_t>> names;
  for (std::size_t p = 0; p < c.problems.size(); ++p) names[c.problems[p].name].push_back(p);
  return names;
}

std::vector<std::size_t> ranking(const Comparison& comparison, std::size_t problem) {
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

Comparison compare_optimizers(const Study& study, const Yardstick& yardstick) {
  Comparison c{.study = &study, .yardstick = yardstick};
  const OptimizerLabels label(study);
  c.problems = problem_axis(study);
  c.optimizers = optimizer_axis(study, label);
  fill_cells(c, label);
  for (auto& row : c.cells) {
    for (Cell& cell : row) aggregate(c, cell);
    mark_best(row);
  }
  fill_standings(c);
  summarize_runs(c);
  return c;
}

}  // namespace isoline::reports
