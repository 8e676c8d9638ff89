// The points that a meter knows: the last one that the harness evaluated, the last one that is paid
// for, and the Jacobian at one of them.
#pragma once

#include <limits>

#include "core/archive.h"
#include "core/array.h"
#include "optimizers/linearization.h"

namespace isoline::optimizers {

struct Judged {
  Point at;
  Matrix g;         // ∂L/∂y, (m, B)
  Vector gradient;  // ∇L, (n)
  Vector theta;     // (n)
  Vector accepted;  // (n), the last θ that was judged and is paid for
  Real paid_loss = std::numeric_limits<Real>::quiet_NaN();  // of the last that the method paid for
  bool is_prepaid = false;                                  // a forward at `theta`
  bool has_gradient = true;                                 // is measured
};

struct KnownJacobian {
  struct Differences {
    Real noise = std::numeric_limits<Real>::epsilon();  // of y in a call, relative to ‖y‖
    Real step = 0;  // relative to the sizes of the unknowns; NaN where the user gave others
    bool is_central = false;
  };

  Vector theta;           // (n)
  Matrix J;               // (m·B, n) there
  bool is_exact = false;  // the problem's own, at the returned point
  Differences by;         // of a J of the method
  Real enough_of_deviation = 0;

  void persist(Archive& archive) {
    archive(theta, J, by.noise, by.step, by.is_central, enough_of_deviation);
  }
};

}  // namespace isoline::optimizers
