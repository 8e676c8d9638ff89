// Whether a point at which a method has stopped is a solution, by J there: what CONTRIBUTING calls
// the status `converged`, as opposed to `unconfirmed`.
#pragma once

#include <string>
#include <vector>

#include "core/array.h"

namespace isoline::optimizers {

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
  bool forgives_noise = true;             // a step that the noise makes counts as none
};

// Empty where J has full rank over the unknowns that no bound holds and the Gauss-Newton step there
// is below 1e-6 of each unknown, or below what the noise makes of it; else the reason.
std::string doubt_of(const LeastSquaresPoint& at);

}  // namespace isoline::optimizers
