// Whether two runs of a problem found the same x.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/real.h"
#include "core/records/record.h"

namespace isoline::results {

// The scale by which two losses of a record's problem tie: that of the success criterion, or the
// smaller of the two losses where the least loss is unknown. Never the loss at the start, which may
// be larger by any factor.
inline Real scale_of_ties(const Record& record, Real loss_x, Real loss_z) {
  const Real smaller = std::min(std::abs(loss_x), std::abs(loss_z));
  return record.minimum ? record.scale.value_or(smaller) : smaller;
}

// ‖x − z‖ where the losses tie but the points differ, else 0. Losses tie where they differ by less
// than the strictest target of the tables, as a share of the problem's scale; points differ by more
// than a thousandth of their norm.
inline Real distance_at_equal_loss(Real loss_x, Real loss_z, Real scale, std::span<const Real> x,
                                   std::span<const Real> z) {
  constexpr Real kTie = 1e-6, kApart = 1e-3;
  if (!(std::abs(loss_x - loss_z) <= kTie * scale) || x.size() != z.size()) return 0;
  Real xx = 0, zz = 0, apart = 0;  // squares of norms
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += x[i] * x[i];
    zz += z[i] * z[i];
    apart += (x[i] - z[i]) * (x[i] - z[i]);
  }
  return apart > kApart * kApart * std::max(xx, zz) ? std::sqrt(apart) : 0;
}

}  // namespace isoline::results
