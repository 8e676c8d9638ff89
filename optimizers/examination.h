// Whether a point at which a method has stopped is a solution, by J there: what CONTRIBUTING calls
// the status `converged`, as opposed to `unconfirmed`.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/array.h"

namespace isoline::optimizers {

// Gauss-Newton steps that are too small to count: of an unknown, under half of 1e-6, as it is of
// first order; and of its standard deviation, which says how many of its digits the data determine.
inline constexpr Real kEnoughOfUnknown = 4e-7, kEnoughOfDeviation = 5e-7;
// The size that it is compared with: an unknown may be far smaller than at its start, or 0.
inline Real least_size(Real theta, Real size_at_start) {
  constexpr Real kOfStart = 1e-6;
  return std::max(std::abs(theta), kOfStart * size_at_start);
}

struct LeastSquaresPoint {
  const Matrix& J;                        // (m, n)
  Vector residual;                        // (m) r, of which ½‖r‖² is minimized
  Vector theta;                           // (n)
  Vector sizes;                           // (n), of the unknowns, where θ is smaller
  std::vector<bool> is_held;              // (n), by a bound that ∇L presses against, or fixed
  const std::vector<std::string>& names;  // (n), or empty
  Real size_of_y = 0;                     // ‖y‖
  Real noise = 0;                         // of y in a call, relative to it
  bool has_exact_jacobian = true;         // else by differences, whose error is of √noise
  bool is_central = false;                // of differences, whose error is less
  Real enough_of_deviation = kEnoughOfDeviation;
  bool forgives_noise = true;  // a step that the noise makes counts as none
  Real sure = 4;               // standard deviations of that
};

// The error of ½‖r‖², r = y − y*, by that of y in a call, `noise` of each component: the loss
// cannot judge what changes it by less. `misfit`: ½‖r‖²; `norm`: ‖r‖; `largest`: of |y|.
inline Real rounding_of_misfit(Real misfit, Real norm, Real largest, Real noise) {
  constexpr Real kSure = 3;  // standard deviations
  const Real error = noise > std::numeric_limits<Real>::epsilon() ? kSure * noise : noise;
  return error * (misfit + norm * largest);
}

// Empty where J has full rank over the unknowns that no bound holds and the Gauss-Newton step there
// is that small, or below what the noise makes of it; else the reason.
std::string doubt_of(const LeastSquaresPoint& at);

}  // namespace isoline::optimizers
