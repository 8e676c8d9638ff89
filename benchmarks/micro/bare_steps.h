// The linear algebra that a step cannot do without, written against LAPACKE and the problem, with
// no meter and nothing checked.
#pragma once

#include <functional>
#include <string>

#include "problems/problem.h"

namespace isoline::benchmarks::micro {

using problems::Problem;
using BareStep = std::function<void(Vector& theta)>;

// For a method not known here, one step of gradient descent. The problem outlives the step.
BareStep bare_step(const std::string& method, const Problem& problem);

}  // namespace isoline::benchmarks::micro
