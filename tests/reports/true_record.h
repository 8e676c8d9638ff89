// Edits that leave a record true to itself: its summary is the last point of its curve, its best
// loss and its hits follow from its losses, and its verdicts from its last point.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/records/record.h"
#include "core/status.h"

namespace isoline {

inline void renew_verdicts(Record& record) {
  const Summary& last = record.summary;
  for (const auto& [name, tau] : kVerified) {
    if (record.minimum && record.scale)
      record.verified[name] = last.loss <= *record.minimum + tau * *record.scale;
    if (record.x_scale)
      record.found[name] = last.x_error <= x_goal(tau, *record.x_scale, record.x_floor);
    else
      record.found.erase(name);
  }
  if (!record.criterion.empty()) record.criterion = digest_of(criterion_of(record));
}

// The norm of its residual and the variance that follow from its last loss, ½‖y − y*‖².
inline void renew_answer(Record& record) {
  if (!record.answer || !record.answer->residual_norm) return;
  const Real squared = 2 * std::max<Real>(record.summary.loss, 0);
  record.answer->residual_norm = std::sqrt(squared);
  if (record.uncertainty)
    record.uncertainty->variance =
        squared / static_cast<Real>(record.uncertainty->degrees_of_freedom);
}

// The last loss, with the best of all and the targets that it reaches.
inline void end_at(Record& record, Real loss) {
  record.summary.loss = record.curve.loss.back() = loss;
  if (record.hits && loss < record.summary.best_loss) {
    Hits& hits = *record.hits;
    for (std::size_t j = 0; j < hits.target.size(); ++j) {
      const Real goal = record.minimum.value_or(0) + hits.target[j] * record.scale.value_or(1);
      if (hits.iteration[j] >= 0 || !(loss <= goal)) continue;
      hits.iteration[j] = record.summary.iterations;
      hits.work[j] = record.summary.work;
      hits.forwards[j] = record.counts[0];
      for (auto& [oracle, column] : hits.counts) column[j] = record.curve.counts[oracle].back();
    }
  }
  if (loss < record.summary.best_loss) record.summary.best_loss = loss;
  renew_answer(record);
  renew_verdicts(record);
}

inline void end_in_x_at(Record& record, Real x_error) {
  record.summary.x_error = record.curve.x_error.back() = x_error;
  renew_verdicts(record);
}

}  // namespace isoline
