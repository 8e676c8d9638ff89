// Orders over problems: ranks, ratios, and how far they can be told from chance.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

// Ranks of the methods of the common order by name of problem, in the order of order.methods:
// settings of one problem are no two witnesses, so their ranks are averaged and ranked again.
std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& comparison, Measure by);

// Friedman's p over these ranks, of the methods that apply to most of the settings.
Real friedman_of(const Comparison& comparison);

}  // namespace isoline::reports
