// Draws lines with their bands, and a bar where a published value says a line should be.
#include "reports/page/lines_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/formats/escape.h"
#include "reports/page/frame.h"
#include "reports/sections/plot_window.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Narrow, so that its letters can be read on a telephone.
constexpr Real kWidth = 480, kHeight = 300, kLeft = 58, kTop = 26, kRight = 18, kBelow = 40;
constexpr std::size_t kFewPoints = 16;  // are marked

Frame frame_of(const Plot& plot) {
  const Window window = window_of(plot);
  return {.left = kLeft,
          .top = kTop,
          .width = kWidth - kLeft - kRight,
          .height = kHeight - kTop - kBelow,
          .x_low = window.x_low,
          .x_high = window.x_high,
          .y_low = window.y_low,
          .y_high = window.y_high,
          .is_log_x = plot.is_log_x,
          .is_log_y = plot.is_log_y};
}

// "M1 2L3 4", with a gap where there is no number.
std::string path_of(const Frame& frame, const std::vector<Real>& x, const std::vector<Real>& y) {
  std::string path;
  bool is_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool is_number = !std::isnan(y[i]);
    if (is_number)
      path += fmt::format("{}{:.0f} {:.1f}", is_down ? 'L' : 'M', frame.x(x[i]), frame.y(y[i]));
    is_down = is_number;
  }
  return path;
}

std::string band_of(const Frame& frame, const PlotSeries& line) {
  std::vector<Real> x, y;
  for (std::size_t i = 0; i < line.x.size(); ++i)
    if (!std::isnan(line.low[i]) && !std::isnan(line.high[i])) {
      x.push_back(line.x[i]);
      y.push_back(line.high[i]);
    }
  for (std::size_t i = line.x.size(); i-- > 0;)
    if (!std::isnan(line.low[i]) && !std::isnan(line.high[i])) {
      x.push_back(line.x[i]);
      y.push_back(line.low[i]);
    }
  return x.empty() ? "" : fmt::format("<path class=band d=\"{}Z\"/>", path_of(frame, x, y));
}

std::string line_svg(const Frame& frame, const PlotSeries& line, std::size_t place) {
  std::string svg = fmt::format("<g class=c{}>", place % 8);
  if (!line.low.empty() && line.low != line.high) svg += band_of(frame, line);
  svg += fmt::format("<path class=line d=\"{}\"><title>{}</title></path>",
                     path_of(frame, line.x, line.y), html_text(line.name));
  for (std::size_t i = 0; i < line.x.size() && line.x.size() <= kFewPoints; ++i)
    if (std::isfinite(line.y[i]))
      svg += fmt::format("<circle cx={:.0f} cy={:.1f} r=3><title>{}: {}</title></circle>",
                         frame.x(line.x[i]), frame.y(line.y[i]), html_text(line.name),
                         figure(line.y[i]));
  return svg + "</g>";
}

// A bar over the values that agree, crossed at the published one; a band along a line otherwise.
std::string published_svg(const Frame& frame, const PlotSeries& goal) {
  if (goal.x.size() > 1)
    return fmt::format(
        "<g class=goal>{}{}</g>", band_of(frame, goal),
        goal.y.empty()
            ? fmt::format("<path class=line d=\"M{0:.0f} {1:.0f}V{2:.0f}\"/>",
                          frame.x(goal.x[goal.x.size() / 2]), frame.top, frame.bottom())
            : fmt::format("<path class=line d=\"{}\"/>", path_of(frame, goal.x, goal.y)));
  constexpr Real kHalf = 7, kCross = 12, kThinnest = 2;
  const Real x = frame.x(goal.x[0]), top = frame.y(goal.high[0]);
  return fmt::format(
      "<g class=goal><rect class=band x={:.0f} y={:.1f} width={:.0f} height={:.1f} /><path "
      "class=line d=\"M{:.0f} {:.1f}h{:.0f}\"/><title>published: {} ({} to {})</title></g>",
      x - kHalf, top, 2 * kHalf, std::max(kThinnest, frame.y(goal.low[0]) - top), x - kCross,
      frame.y(goal.y[0]), 2 * kCross, figure(goal.y[0]), figure(goal.low[0]), figure(goal.high[0]));
}

std::string legend_entry(const std::string& kind, const std::string& name) {
  return fmt::format(
      "<span class={}><svg class=swatch viewBox=\"0 0 26 8\" aria-hidden=true><path class=line "
      "d=\"M0 4h26\"/></svg> {}</span> ",
      kind, html_text(name));
}

}  // namespace

std::string lines_svg(const Plot& plot) {
  const Frame frame = frame_of(plot);
  std::string svg =
      fmt::format("<svg class=lines viewBox=\"0 0 {:.0f} {:.0f}\" role=img aria-label=\"{}\">",
                  kWidth, kHeight, html_text(plot.title + ". " + plot.caption));
  svg += x_axis(frame, plot.x_label) + y_axis(frame, plot.y_label, false);
  for (std::size_t i = plot.series.size(); i-- > 0;)  // the first on top
    svg += line_svg(frame, plot.series[i], i);
  for (const PlotSeries& goal : plot.published) svg += published_svg(frame, goal);
  return svg + "</svg>";
}

std::string lines_legend(const Plot& plot) {
  std::string html = "<p class=marks>";
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    html += legend_entry(fmt::format("c{}", i % 8), plot.series[i].name);
  if (!plot.published.empty()) html += legend_entry("goal", "published");
  return html + "</p>";
}

}  // namespace isoline::reports
