// What decides a claim, drawn, with what was published drawn in.
#pragma once

#include <string>
#include <vector>

#include "reports/sections/evidence.h"
#include "reports/sections/section.h"

namespace isoline::reports {

// One plot, or none where the figures have no curve and no abscissa.
std::vector<Plot> claim_plots(const Evidence& evidence, const std::string& id);

// What names a term among the others: its optimizer, its problem where they differ, its abscissa.
std::vector<std::string> term_names(const Evidence& evidence);

}  // namespace isoline::reports
