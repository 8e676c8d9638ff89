// Do several methods differ at all over the same problems? Friedman's test by ranks (1937).
#pragma once

#include <vector>

#include "core/real.h"

namespace isoline::reports {

// values[block][treatment], the less the better; infinite values rank last, ties share. The p of
// the χ² approximation with k − 1 degrees of freedom, corrected for ties; 1 where nothing differs.
Real friedman_p(const std::vector<std::vector<Real>>& values);

// P(χ² with so many degrees of freedom ≥ x).
Real chi_square_tail(Real x, Real freedom);

}  // namespace isoline::reports
