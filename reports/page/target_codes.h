// Medians to the 51 targets in as few letters as they need: the page holds them for every cell.
#pragma once

#include <string>
#include <vector>

#include "core/real.h"
#include "reports/read/metrics.h"

namespace isoline::reports {

// Comma-separated, of the finite ones; "8*3" is one that stands three times. Counts are halves in
// base 36; costs, and times in seconds, are the digits of a number and a letter for its power of
// ten.
std::string target_codes(const std::vector<Real>& medians, Measure by);

}  // namespace isoline::reports
