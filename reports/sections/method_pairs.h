// All pairs of methods, as the page compares the two that a reader chooses.
#pragma once

#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

struct MethodPair {
  std::size_t a = 0, b = 0;  // optimizers
  Pairing pairing;
};

// At the tightest tolerance by what the yardstick counts, over the problems given to both that are
// not learned; a < b.
std::vector<MethodPair> all_pairs(const Comparison& comparison);

}  // namespace isoline::reports
