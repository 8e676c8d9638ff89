// One step of inverting the physics alone: from where it was linearized to an x̃ that brings y
// nearer to y*, sample by sample. What scale-invariant physics training chooses between.
#pragma once

#include <memory>

#include "optimizers/meter.h"

namespace isoline::optimizers {

class Inversion {
 public:
  virtual ~Inversion() = default;
  virtual void invert(Meter& f, Linearization& at, Matrix& found) = 0;  // found: x̃, (k, B)
};

// The problem's own: x̃ = P⁻¹(y + η (y* − y); x), or x + η (P⁻¹(y*; x) − x) where it does not undo
// P.
std::unique_ptr<Inversion> inversion_by_problem(Real step);

// x̃ = x + η U, U the saddle-free Newton step on ½‖P(x) − y*‖² (saddle_free.h).
std::unique_ptr<Inversion> inversion_by_newton(Real step, Real max_loss_change);

// x̃ = argmin ½‖P(x) − y − η (y* − y)‖² from the current x, by L-BFGS over all samples at once.
std::unique_ptr<Inversion> inversion_by_lbfgs(Real step, Index most_evaluations);

}  // namespace isoline::optimizers
