// Plots as static SVG: the frame with its axes, lines with what was published, and all kinds of the
// statistics.
#pragma once

#include <string>
#include <vector>

#include "core/real.h"
#include "reports/sections/section.h"

namespace isoline::reports {

struct Frame {
  Real left = 0, top = 0, width = 0, height = 0;  // on the paper
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
  bool is_log_x = false, is_log_y = false;

  Real x(Real value) const;  // on the paper; what is outside is put at the edge
  Real y(Real value) const;
  Real right() const { return left + width; }
  Real bottom() const { return top + height; }
};

// Round values within, at most some ten of them: powers of two or ten where logarithmic.
std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic);

std::string x_axis(const Frame& frame, const std::string& label);  // with a grid line a tick
std::string y_axis(const Frame& frame, const std::string& label, bool is_share);

// Plots of lines as static SVG, with what was published drawn in.

std::string lines_svg(const Plot& plot);
std::string lines_legend(const Plot& plot);  // below it, as HTML

}  // namespace isoline::reports
