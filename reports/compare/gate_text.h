// A comparison as text, Markdown and JSON.
#pragma once

#include <string>

#include "reports/compare/gate.h"

namespace isoline::reports {

const char* name_of(Change change);
const char* name_of_time(int change);
std::string counts_of(const GateResult& result);           // "3 cells in both: 3 equal, …"
std::string step_text(const Difference& difference);       // "loss 1e-3 → 2e-3"
std::string remainder_text(const Difference& difference);  // "+5 %, and 3 more of its kind"
std::string ratio_text(const RatioEstimate& ratio);        // "1.31× (1.25 to 1.36)"

}  // namespace isoline::reports
