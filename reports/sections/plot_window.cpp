// The window of a plot of lines: all medians, and not so much of the bands that these lie flat.
#include "reports/sections/plot_window.h"

#include <algorithm>
#include <cmath>

#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

struct Extent {
  Real low = kNever, high = -kNever;
  void take(Real value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Extent extent_of(const Plot& plot, std::vector<Real> PlotSeries::*values, bool is_logarithmic) {
  Extent extent;
  for (const auto* all : {&plot.series, &plot.published})
    for (const PlotSeries& line : *all)
      for (const Real value : line.*values)
        if (value > 0 || !is_logarithmic) extent.take(value);
  return extent;
}

Extent extent_of_x(const Plot& plot) {
  Extent extent = extent_of(plot, &PlotSeries::x, plot.is_log_x);
  if (!(extent.high > extent.low)) extent = {0, std::max(1.0, 2 * extent.low)};
  return extent;
}

Extent extent_of_y(const Plot& plot) {
  Extent extent = extent_of(plot, &PlotSeries::y, plot.is_log_y);
  const Extent medians = extent;
  constexpr Real kFurther = 3;
  const auto take_edge = [&](Real y) {
    if (std::isnan(y) || medians.low > medians.high || (plot.is_log_y && !(y > 0))) return;
    const Real span = medians.high - medians.low;
    extent.take(plot.is_log_y ? std::clamp(y, medians.low / kFurther, kFurther * medians.high)
                              : std::clamp(y, medians.low - span, medians.high + span));
  };
  for (const auto* all : {&plot.series, &plot.published})
    for (const PlotSeries& line : *all) {
      if (line.y.empty()) continue;
      for (const Real y : line.low) take_edge(y);
      for (const Real y : line.high) take_edge(y);
    }
  if (extent.low > extent.high) return {0.1, 1};
  if (plot.is_log_y) return {extent.low / 1.15, 1.15 * extent.high};  // some air
  // Figures that differ by rounding alone are drawn as one.
  const Real span = extent.high - extent.low;
  const Real size = std::max(std::abs(extent.low), std::abs(extent.high));
  const Real air = span > 1e-9 * size ? 0.05 * span : size > 0 ? 0.5 * size : 0.5;
  return {extent.low - air, extent.high + air};
}

}  // namespace

Window window_of(const Plot& plot) {
  const Extent x = extent_of_x(plot), y = extent_of_y(plot);
  bool has_start = false;  // iteration 0 is drawn left of the first
  for (const PlotSeries& line : plot.series)
    has_start = has_start || (plot.is_log_x && !line.x.empty() && line.x.front() <= 0);
  return {has_start ? x.low / 2 : x.low, x.high, y.low, y.high};
}

}  // namespace isoline::reports
