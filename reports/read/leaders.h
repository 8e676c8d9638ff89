// Who stands where: the common order, its leader, and who is compared apart from it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

// Finds the orders, counts for each optimizer, sorts all that is stored by optimizer, and finds who
// leads. Needs the cells aggregated.
void fill_standings(Comparison& comparison);

// How those of an order stand by these costs, whatever tolerance they and the runs that get there
// are of: by optimizer.
using RunsThere = std::function<std::size_t(std::size_t problem, std::size_t optimizer)>;
std::map<std::size_t, Standing> standings_in(const Comparison& comparison, const Order& order,
                                             const Costs& costs, const RunsThere& runs_there);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

// The lead of the common order at the tightest tolerance by any measure: among all, or among those
// without privileges alone; nothing where none of them solves anything.
std::optional<Lead> lead_of(const Comparison& comparison, bool is_open, Measure by);

}  // namespace isoline::reports
