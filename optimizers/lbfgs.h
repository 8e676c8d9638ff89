// Limited-memory BFGS (Nocedal 1980) for the methods that minimize a misfit f ≥ 0 inside a step,
// such as inverting a physics numerically. Luksan's code, by way of NLopt.
#pragma once

#include <functional>

#include "core/array.h"

namespace isoline::optimizers {

// f and its gradient at x, both (n).
using ValueAndGradient = std::function<Real(VectorRef x, VectorOut gradient)>;

struct LbfgsLimits {
  Index evaluations = 200;
  Real enough = 0;                          // stop at f ≤ enough
  std::function<bool()> is_over = nullptr;  // asked before each evaluation
};

struct LbfgsResult {
  Real value;         // f at the x returned
  Index evaluations;  // spent
};

// Moves x to the best point found.
LbfgsResult minimize_lbfgs(const ValueAndGradient& f, const LbfgsLimits& limits, Vector& x);

}  // namespace isoline::optimizers
