// A problem without its derivatives: with none, or with those by differences, whose steps follow
// from the noise in its values.
#pragma once

#include <string>

#include "problems/problem.h"

namespace isoline::problems {

// The noise of y in a call at x, relative to the largest |yᵢ| there; at least that of rounding.
// Calls P up to kNoiseSpacings · kNoiseCalls times.
Real relative_noise(const Problem& problem, const Vector& x);

// `derivatives`: "none", or "forward" or "central" differences of forward solves, which cost what
// they call: k or 2k for J. They see the jitter of the calls. No inverse and no sparse J remain.
void replace_derivatives(ProblemParts& parts, const std::string& derivatives);

}  // namespace isoline::problems
