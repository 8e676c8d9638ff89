// How each kind of panel is drawn from its runs.
#pragma once

#include <utility>
#include <vector>

#include "reports/sections/figures.h"
#include "reports/sections/section.h"

namespace isoline::reports {

struct Window {
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
};

// As high as medians and what was published go, and of their bands no more than thrice that.
Window window_of(const Plot& plot);

// How each kind of panel is drawn from its runs.

using Sweep = std::vector<std::pair<Real, std::size_t>>;  // value of the option, problem

Figure sweep_figure(const Comparison& comparison, const Sweep& sweep, const Panel& panel);

Figure picture_figure(const Comparison& comparison, std::size_t problem);

// Of one problem: curve, scatter, decades, pictures, series or path. Empty where no run has it.
Figure problem_figure(const Comparison& comparison, std::size_t problem, const Panel& panel);

}  // namespace isoline::reports
