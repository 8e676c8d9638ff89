// What tuning buys: the best of b values drawn from those that were tried.
#pragma once

#include <cstddef>
#include <vector>

#include "core/real.h"

namespace isoline::reports {

// The expected greatest of b of these values, b = 1 … n, drawn without replacement: each subset of
// b is as likely as any other. E = Σ_i v_(i) [C(i, b) − C(i − 1, b)] / C(n, b), v ascending.
std::vector<Real> expected_best(std::vector<Real> values);

}  // namespace isoline::reports
