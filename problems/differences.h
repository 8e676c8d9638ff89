// A problem without its derivatives: with none, or with those by differences, whose steps follow
// from the noise in its values.
#pragma once

#include <optional>
#include <string>

#include "problems/problem.h"

namespace isoline::problems {

// The noise of y in a call, relative to ‖y‖, by four calls at and near x, inside the bounds, and
// more where y is not smooth. NaN where y is not finite.
Real relative_noise(const Problem& problem, const Vector& x);

// `derivatives`: "none", or "forward" or "central" differences of forward solves, which cost what
// they call: k or 2k for J. Six further calls at
// the start measure the noise of y. They see the jitter of the calls. No sparse J
// remains, and an inverse only where it is kept. `steps`: of given_steps().
void replace_derivatives(ProblemParts& parts, const std::string& derivatives,
                         bool keeps_inverse = false, const std::string& steps = "");
// Undoes this for the outermost physics: its steps; nothing where it has no such derivatives.
std::optional<std::string> remove_differences(ProblemParts& parts);

}  // namespace isoline::problems
