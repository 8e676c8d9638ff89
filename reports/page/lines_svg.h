// Plots of lines as static SVG, with what was published drawn in.
#pragma once

#include <string>

#include "reports/sections/section.h"

namespace isoline::reports {

std::string lines_svg(const Plot& plot);
std::string lines_legend(const Plot& plot);  // below it, as HTML

}  // namespace isoline::reports
