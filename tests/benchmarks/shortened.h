// The claims of the tree as if they spoke of shorter runs, which a test can afford.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/plan/claim_cells.h"

namespace isoline::benchmarks {

// Those in whose cells none of these words stands: there a step takes seconds, or its measurements
// do. The others are cut to so many iterations, and to so many seeds where they are over any.
std::vector<Claim> claims_without(const std::vector<std::string>& dear, std::int64_t most,
                                  int seeds);

}  // namespace isoline::benchmarks
