// The damping of Levenberg-Marquardt methods by the gain of each step.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/archive.h"
#include "core/real.h"
#include "core/status.h"

namespace isoline::optimizers {

// The damping μ of a Levenberg-Marquardt method by the gain of each step, actual over predicted
// decrease; Nielsen (1999): divided by at most 3 after a good step, and multiplied by 2, 4, 8, …
// through steps that are rejected one after the other.
struct NielsenDamping {
  Real mu = 0, growth = 2;  // μ, and its factor at the next rejection

  Status reject() {
    mu *= growth;
    growth *= 2;
    return std::isfinite(mu) ? Status::running : Status::converged;
  }
  void accept(Real gain) {
    mu *= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
    growth = 2;
  }
  void persist(Archive& archive) { archive(mu, growth); }
};

}  // namespace isoline::optimizers
