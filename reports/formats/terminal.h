// A plot of lines in letters, for a terminal.
#pragma once

#include <string>

#include "reports/sections/section.h"

namespace isoline::reports {

std::string text_plot(const Plot& plot);

}  // namespace isoline::reports
