// How far the axes of a plot of lines go.
#pragma once

#include "reports/sections/section.h"

namespace isoline::reports {

struct Window {
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
};

// As high as medians and what was published go, and of their bands no more than thrice that.
Window window_of(const Plot& plot);

}  // namespace isoline::reports
