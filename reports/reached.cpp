// Reads what each tolerance took off the hits of a record, or else off its curve.
#include "reports/reached.h"

#include <algorithm>
#include <cmath>

#include "core/ladder.h"

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

}  // namespace isoline::reports
