// Who stands where: the common order, its leader, and who is compared apart from it.
#pragma once

#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

// Finds the orders, counts for each optimizer, sorts all that is stored by optimizer, and finds who
// leads. Needs the cells aggregated.
void fill_standings(Comparison& comparison);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

// The lead of the common order at the tightest tolerance by any measure: among all, or among those
// without privileges alone; nothing where none of them solves anything.
std::optional<Lead> lead_of(const Comparison& comparison, bool is_open, Measure by);

}  // namespace isoline::reports
