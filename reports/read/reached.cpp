// Reads what each tolerance and each target took off the hits of a record, or else off its curve.
#include "reports/read/reached.h"

#include <algorithm>
#include <cmath>

namespace isoline::reports {
namespace {

void fill_from_hits(Run& run, const Hits& hits) {
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const std::size_t j = kTolerances[t].hit;
    if (j >= hits.iteration.size() || hits.iteration[j] < 0) continue;
    run.work[t] = static_cast<Real>(hits.work[j]);
    run.seconds[t] = hits.wall_seconds[j];
  }
}

void fill_from_curve(Run& run) {
  const Curve& curve = run.record->curve;
  const Real start = run.record->summary.start_loss;
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const Real goal = run.minimum + kTolerances[t].tau * (start - run.minimum);
    for (std::size_t i = 0; i < curve.loss.size(); ++i) {
      if (!(curve.loss[i] <= goal)) continue;
      run.work[t] = static_cast<Real>(curve.work[i]);
      run.seconds[t] = curve.wall_seconds[i];
      break;
    }
  }
}

// Of one run, until it reaches no more.
struct Reached {
  std::vector<Real> work, seconds;
};

Reached from_hits(const Hits& hits) {
  Reached reached;
  for (std::size_t j = 0; j < hits.iteration.size() && hits.iteration[j] >= 0; ++j) {
    reached.work.push_back(static_cast<Real>(hits.work[j]));
    reached.seconds.push_back(hits.wall_seconds[j]);
  }
  return reached;
}

Reached from_curve(const Run& run) {
  const Curve& curve = run.record->curve;
  const Real start = run.record->summary.start_loss;
  Reached reached;
  std::size_t i = 0;
  for (std::size_t j = 0; j < kTargets; ++j) {
    const Real goal = run.minimum + rung(j) * (start - run.minimum);
    while (i < curve.loss.size() && !(curve.loss[i] <= goal)) ++i;
    if (i == curve.loss.size()) break;
    reached.work.push_back(static_cast<Real>(curve.work[i]));
    reached.seconds.push_back(curve.wall_seconds[i]);
  }
  return reached;
}

Reached reached_by(const Run& run) {
  if (run.record->status == Status::inapplicable) return {};
  return run.record->hits ? from_hits(*run.record->hits) : from_curve(run);
}

Real median_at(const std::vector<Reached>& runs, std::size_t j, std::vector<Real> Reached::*what) {
  std::vector<Real> values;
  for (const Reached& run : runs) values.push_back(j < run.work.size() ? (run.*what)[j] : kNever);
  return median_of(std::move(values));
}

}  // namespace

BestKnown::BestKnown(const Study& study) {
  for (const Record& record : study.runs) {
    const auto key = std::pair(record.request.problem.spec, record.request.seed);
    Real& least = least_.emplace(key, kNever).first->second;
    const Real best = record.summary.best_loss;
    if (record.status != Status::inapplicable && best < least) least = best;
  }
}

Real BestKnown::minimum(const Record& record) const {
  if (record.minimum) return *record.minimum;
  const auto found = least_.find({record.request.problem.spec, record.request.seed});
  return found == least_.end() ? std::nan("") : found->second;
}

std::vector<Real> target_costs(const Run& run, const Prices& prices, std::size_t count) {
  std::vector<Real> all(count, kNever);
  const Record& record = *run.record;
  if (record.status == Status::inapplicable) return all;
  if (record.hits) {
    const std::vector<Real> hits = prices.hit_costs(record);
    std::copy_n(hits.begin(), std::min(count, hits.size()), all.begin());
    return all;
  }
  const std::vector<Real> costs = prices.curve_costs(record);
  const Real descent = record.summary.start_loss - run.minimum;
  std::size_t j = 0;
  for (std::size_t i = 0; i < costs.size(); ++i)
    for (; j < count && record.curve.loss[i] <= run.minimum + rung(j) * descent; ++j)
      all[j] = costs[i];
  return all;
}

void fill_costs(Run& run, const Prices& prices) {
  const std::vector<Real> costs = target_costs(run, prices, kTolerances.back().hit + 1);
  for (std::size_t t = 0; t < kTolerances.size(); ++t) run.cost[t] = costs[kTolerances[t].hit];
  if (run.record->status != Status::inapplicable) run.spent = prices.cost(*run.record);
}

void fill_reached(Run& run, const BestKnown& best) {
  run.work.fill(kNever);
  run.seconds.fill(kNever);
  if (run.record->status == Status::inapplicable) return;
  run.minimum = best.minimum(*run.record);
  if (run.record->hits)
    fill_from_hits(run, *run.record->hits);
  else
    fill_from_curve(run);
}

TargetMedians target_medians(const Comparison& comparison, const Cell& cell) {
  std::vector<Reached> runs;
  TargetMedians medians;
  for (const std::size_t run : cell.runs) {
    runs.push_back(reached_by(comparison.runs[run]));
    medians.reached.push_back(runs.back().work.size());
  }
  for (std::size_t j = 0; j < kTargets && !runs.empty(); ++j) {
    const Real work = median_at(runs, j, &Reached::work);
    if (!(work < kNever)) break;
    medians.work.push_back(work);
    medians.seconds.push_back(median_at(runs, j, &Reached::seconds));
  }
  return medians;
}

}  // namespace isoline::reports
