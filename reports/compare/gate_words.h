// The phrases of a comparison, the same in every format.
#pragma once

#include <string>
#include <vector>

#include "reports/compare/gate.h"

namespace isoline::reports {

inline constexpr const char* kOnlyBefore = "Only in BASE";
inline constexpr const char* kOnlyAfter = "Only in NEW";

const char* name_of(Change change);
const char* name_of_time(int change);
std::string headline_of(const GateResult& result);
std::string remainder_text(const Difference& difference);  // "+5 %, and 3 more of its kind"
std::string ratio_text(const RatioEstimate& ratio);        // "1.31× (1.25 to 1.36)"
std::string noise_text(const TimeVerdict& time);
std::vector<std::string> lines_of(const std::vector<Incomparable>& all);

}  // namespace isoline::reports
