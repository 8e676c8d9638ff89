// Medians over seeds to each target, from hits or curves.
#include "reports/html/targets.h"

#include <cmath>

#include "core/ladder.h"

namespace isoline::reports {
namespace {

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
