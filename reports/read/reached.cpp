// Reads what each tolerance and each target took off the hits of a record, or else off its curve.
#include "reports/read/reached.h"

#include <algorithm>
#include <cmath>

namespace isoline::reports {
namespace {

std::vector<Reached> from_hits(const Record& record, const Prices& prices) {
  const Hits& hits = *record.hits;
  const std::vector<Real> costs = prices.hit_costs(record);
  std::vector<Reached> ladder;
  for (std::size_t j = 0; j < hits.iteration.size() && hits.iteration[j] >= 0; ++j)
    ladder.push_back({{static_cast<Real>(hits.work[j]), costs[j],
                       static_cast<Real>(hits.iteration[j]), hits.wall_seconds[j]}});
  return ladder;
}

// At the first kept points where left[i] ≤ goal(j).
template <class Goal>
std::vector<Reached> from_curve(const Run& run, const Prices& prices, const std::vector<Real>& left,
                                Goal goal) {
  const Curve& curve = run.record->curve;
  const std::vector<Real> costs = prices.curve_costs(*run.record);
  std::vector<Reached> ladder;
  std::size_t i = 0;
  for (std::size_t j = 0; j < kTargets; ++j) {
    while (i < left.size() && !(left[i] <= goal(j))) ++i;
    if (i == left.size()) break;
    ladder.push_back({{static_cast<Real>(curve.work[i]), costs[i],
                       static_cast<Real>(curve.iteration[i]), curve.wall_seconds[i]},
                      i > 0 && curve.iteration[i] > curve.iteration[i - 1] + 1});
  }
  return ladder;
}

void fill_from(const std::vector<Reached>& ladder, const Yardstick& yardstick,
               ByMeasure<Real>& taken) {
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    for (const Measure by : kMeasures)
      if (const std::size_t j = yardstick.tolerances[t].rung; j < ladder.size())
        taken[by][t] = ladder[j].by(by);
}

Real median_at(const std::vector<std::vector<Reached>>& runs, std::size_t j, Measure by) {
  std::vector<Real> values;
  for (const auto& ladder : runs) values.push_back(j < ladder.size() ? ladder[j].by(by) : kNever);
  return median_of(std::move(values));
}

}  // namespace

BestKnown::BestKnown(const Study& study) {
  for (const Record& record : study.runs) {
    if (record.imported) continue;  // what others say of theirs moves nobody's targets
    const auto key = std::pair(record.request.problem.spec, record.request.seed);
    Real& least = least_.emplace(key, kNever).first->second;
    const Real best = record.summary.best_loss;
    if (record.status != Status::inapplicable && best < least) least = best;
  }
}

Real BestKnown::minimum(const Record& record) const {
  if (record.minimum) return *record.minimum;
  const auto found = least_.find({record.request.problem.spec, record.request.seed});
  if (found != least_.end()) return found->second;
  return record.imported ? record.summary.best_loss : std::nan("");
}

std::vector<Real> losses_left(const Run& run) {
  std::vector<Real> left;
  for (const Real loss : run.record->curve.loss)
    left.push_back(run.scale > 0 ? std::max(loss - run.minimum, 0.0) / run.scale : kNever);
  return left;
}

std::vector<Real> left_of_aim(const Run& run) {
  if (run.aim == Aim::loss) return losses_left(run);
  const Real scale = run.record->x_scale.value_or(0);
  std::vector<Real> left;
  for (const Real error : run.record->curve.x_error)
    left.push_back(scale > 0 ? error / scale : kNever);
  return left;
}

std::vector<Reached> ladder_of(const Run& run, const Prices& prices, Aim aim) {
  const Record& record = *run.record;
  if (record.status == Status::inapplicable) return {};
  if (aim == Aim::x) {
    if (!record.x_scale) return {};
    return from_curve(run, prices, record.curve.x_error, [&](std::size_t j) {
      return x_goal(rung(j), *record.x_scale, record.x_floor);
    });
  }
  if (record.hits) return from_hits(record, prices);
  return from_curve(run, prices, record.curve.loss,
                    [&](std::size_t j) { return goal(run, rung(j)); });
}

void fill_reached(Run& run, const BestKnown& best, const Prices& prices,
                  const Yardstick& yardstick) {
  const Record& record = *run.record;
  if (record.status == Status::inapplicable) return;
  run.minimum = best.minimum(record);
  run.scale = record.scale.value_or(record.summary.start_loss - run.minimum);
  run.spent = prices.cost(record);
  const std::vector<Reached> by_loss = ladder_of(run, prices, Aim::loss),
                             by_x = ladder_of(run, prices, Aim::x);
  fill_from(by_loss, yardstick, run.reached_loss);
  fill_from(by_x, yardstick, run.found_x);
  run.taken = run.aim == Aim::x ? run.found_x : run.reached_loss;
  const std::vector<Reached>& aimed = run.aim == Aim::x ? by_x : by_loss;
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    if (const std::size_t j = yardstick.tolerances[t].rung; j < aimed.size())
      run.is_bound[t] = aimed[j].is_bound;
}

Real TargetMedians::at(Measure by, std::size_t target) const {
  const std::vector<Real>& medians = taken[static_cast<std::size_t>(by)];
  return target < medians.size() ? medians[target] : kNever;
}

std::size_t TargetMedians::runs_at(std::size_t target) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(reached, [target](std::size_t count) { return count > target; }));
}

TargetMedians target_medians(const Comparison& comparison, const Cell& cell) {
  std::vector<std::vector<Reached>> runs;
  TargetMedians medians;
  for (const std::size_t index : cell.runs) {
    const Run& run = comparison.runs[index];
    runs.push_back(ladder_of(run, comparison.problems[run.problem].prices, run.aim));
    medians.reached.push_back(runs.back().size());
  }
  for (std::size_t j = 0; j < kTargets && !runs.empty(); ++j) {
    if (!(median_at(runs, j, Measure::work) < kNever)) break;
    for (const Measure by : kMeasures)
      medians.taken[static_cast<std::size_t>(by)].push_back(median_at(runs, j, by));
  }
  return medians;
}

}  // namespace isoline::reports
