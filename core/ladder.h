// The ladder of targets by which runs are compared: τ_j = 10^(−j/5), j = 0 … 50.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/real.h"

namespace isoline {

inline constexpr int kRungs = 51;
inline Real rung(std::size_t j) { return std::pow(10.0, -static_cast<Real>(j) / 5); }

// The first rung at or below a tolerance, so the next stricter one where it lies between two; the
// last one where none is so strict.
inline std::size_t rung_of(Real tau) {
  constexpr Real kRounding = 1e-9;
  std::size_t j = 0;
  while (j + 1 < kRungs && rung(j) > tau * (1 + kRounding)) ++j;
  return j;
}

// The error in x that counts as found at τ. A floor is measured: a tenth of it is its own error.
inline Real x_goal(Real tau, Real x_scale, Real x_floor) {
  constexpr Real kAboveFloor = 1.1;
  return std::max(tau * x_scale, kAboveFloor * x_floor);
}

// Where the data leave that goal above a tenth of ‖x*‖, no method can be said to find x*: such a
// setting is not ranked.
inline bool is_beyond_ranking(Real x_scale, Real x_floor) {
  constexpr Real kMost = 0.1;
  return x_goal(0, x_scale, x_floor) > kMost * x_scale;
}

// Which iterations a curve keeps: 0 to 100, then 32 a decade.

std::int64_t next_kept_after(std::int64_t iteration);

}  // namespace isoline
