// All drawings as SVG that needs no browser: axes, and an area of lines in coordinates from 0 to
// 5,000, so that a script zooms by a change of the view and reads every point; dots and bars.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/real.h"
#include "reports/sections/figures.h"
#include "reports/sections/section.h"

namespace isoline::reports {

struct Frame {
  Real left = 0, top = 0, width = 0, height = 0;  // on the paper
  Real x_low = 0, x_high = 1, y_low = 0, y_high = 1;
  bool is_log_x = false, is_log_y = false;

  Real x(Real value) const;  // on the paper; what has no logarithm is put at the low edge
  Real y(Real value) const;
  Real right() const { return left + width; }
  Real bottom() const { return top + height; }
};

// Round values within, at most some ten of them: powers of two or ten where logarithmic.
std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic);

std::string x_axis(const Frame& frame, const std::string& label);  // with a grid line a tick
std::string y_axis(const Frame& frame, const std::string& label, bool is_share);

enum class Join { straight, steps, none };

// A plot of lines, with what only the page draws.
struct Drawing {
  Plot plot;
  Join join = Join::straight;
  bool has_names = false;           // at the ends of the lines
  bool has_points = false;          // marked, be they many
  bool is_to_scale = false;         // a unit across is a unit up
  std::set<std::size_t> on_demand;  // optimizers whose lines are hidden at first
  std::optional<Window> window;     // else what the lines that are shown need
  std::optional<Real> tolerance;    // a line at τ times this, at the τ of the report
  std::vector<PlotSeries> ground;   // thin lines below all others
  std::vector<PlotSeries> ends;     // a point each: the start, and the goal
  std::string attributes;           // of the element
};
std::string drawing_svg(const Drawing& drawing, Real tau = 1);
// Its lines as buttons that show and hide them, and what the marks of published values mean.
std::string names_html(const Drawing& drawing);

std::string plot_svg(const Plot& plot);
std::string plot_html(const Plot& plot);

}  // namespace isoline::reports
