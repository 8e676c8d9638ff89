// What the page draws of one problem, as compact JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/read/found_fields.h"
#include "reports/read/ranking.h"

namespace isoline::reports {

// Those that the page can be switched to, in the order of its data.
std::vector<Measure> measures_of(const Comparison& comparison);

// Those of the 51 targets that the page holds medians to: all, but of a study too large for that
// the tolerances of its report alone.
std::vector<std::size_t> targets_of(const Comparison& comparison);

std::string problem_data(const Comparison& comparison, const Ladders& ladders, std::size_t problem,
                         const std::optional<FoundFields>& fields);

}  // namespace isoline::reports
