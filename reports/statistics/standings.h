// Who leads, on what was asked of each, and how sure that is.
#pragma once

#include <string>
#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

// Counts for each optimizer, sorts all that is stored by optimizer, best first, and draws the
// profiles. Needs the cells aggregated.
void fill_standings(Comparison& comparison);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

}  // namespace isoline::reports
