// Draws the plots of the statistics as static SVG; colours and dashes are in page/plots.css.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reports/formats/escape.h"
#include "reports/page/frame.h"
#include "reports/page/lines_svg.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kWidth = 720, kNames = 190, kRow = 18, kTop = 26, kBelow = 40;
constexpr const char* kMarks[] = {"●", "■", "▲", "◆", "▼", "○", "□", "△"};

// Shapes, so that colour is not needed to tell series apart.
std::string mark_of(std::size_t place) { return kMarks[place % std::size(kMarks)]; }

// The place among marks and colours: of the optimizer, where it is one, in every plot the same.
std::size_t place_of(const Plot& plot, std::size_t series) {
  return plot.series[series].optimizer.value_or(series);
}

// What is filtered with an optimizer, a problem or a method.
std::string opened(const Topic& topic, std::optional<std::size_t> colour = std::nullopt) {
  std::string tag = "<g";
  if (topic.optimizer) tag += fmt::format(" data-s={}", *topic.optimizer);
  if (topic.problem) tag += fmt::format(" data-p={}", *topic.problem);
  if (!topic.method.empty()) tag += fmt::format(" data-method=\"{}\"", html_text(topic.method));
  if (colour && !topic.optimizer) tag += fmt::format(" class=c{}", *colour % 8);
  return tag + ">";
}

// y(x) from each x on; backwards from its end where `is_back`.
std::string steps(const Frame& frame, const PlotSeries& line, const std::vector<Real>& y,
                  bool is_back) {
  std::string path;
  const std::size_t n = line.x.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = is_back ? n - 1 - k : k;
    const Real right = frame.x(i + 1 < n ? line.x[i + 1] : frame.x_high);
    if (is_back)
      path += fmt::format("L{:.1f} {:.1f}H{:.1f}", right, frame.y(y[i]), frame.x(line.x[i]));
    else if (i == 0)
      path += fmt::format("M{:.1f} {:.1f}H{:.1f}", frame.x(line.x[0]), frame.y(y[0]), right);
    else
      path += fmt::format("V{:.1f}H{:.1f}", frame.y(y[i]), right);
  }
  return path;
}

std::string line_svg(const Frame& frame, const Plot& plot, std::size_t place) {
  const PlotSeries& line = plot.series[place];
  std::string svg = opened({.optimizer = line.optimizer}, place_of(plot, place));
  if (!line.low.empty())
    svg += fmt::format("<path class=band d=\"{}{}Z\"/>", steps(frame, line, line.high, false),
                       steps(frame, line, line.low, true));
  svg += fmt::format("<path class=line d=\"{}\"><title>{}</title></path>",
                     steps(frame, line, line.y, false), html_text(line.name));
  const Real y = frame.top + 12 + kRow * static_cast<Real>(place);
  return svg +
         fmt::format(
             "<path class=line d=\"M{:.0f} {:.0f}h24\"/><text x={:.0f} y={:.0f}>{}</text></g>",
             frame.right() + 14, y - 4, frame.right() + 44, y, html_text(line.name));
}

std::string steps_svg(const Plot& plot) {
  const auto& x = plot.series[0].x;
  const Frame frame{.left = 46,
                    .top = kTop,
                    .width = kWidth - 46 - kNames - 20,
                    .height = 250,
                    .x_low = x.front(),
                    .x_high = x.back(),
                    .is_log_x = plot.is_log_x};
  std::string svg = x_axis(frame, plot.x_label) + y_axis(frame, plot.y_label, true);
  for (std::size_t i = plot.series.size(); i-- > 0;)  // the first on top
    svg += line_svg(frame, plot, i);
  return svg;
}

// The finite numbers of bars or dots, from the least to the greatest.
std::array<Real, 2> extent_of(const Plot& plot) {
  if (plot.window) return *plot.window;
  Real low = std::numeric_limits<Real>::infinity(), high = -low;
  const bool are_bars = plot.kind == Plot::Kind::bars;
  for (const PlotSeries& series : plot.series)
    for (const auto* column : {are_bars ? &series.y : &series.x, &series.low, &series.high})
      for (const Real value : *column) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
  if (are_bars) return {std::min(low, 0.0), std::max(high, 0.0)};
  return {low, high};
}

// A frame with a row a name.
Frame rows_frame(const Plot& plot) {
  auto [low, high] = extent_of(plot);
  if (plot.is_log_x) low = std::pow(10.0, std::floor(std::log10(std::max(low, 1.0))));
  if (plot.is_log_x) high = std::max(high, 10 * low);
  if (!(high > low)) high = low + 1;
  return {.left = kNames,
          .top = kTop,
          .width = kWidth - kNames - 20,
          .height = kRow * static_cast<Real>(plot.rows.size()),
          .x_low = low,
          .x_high = high,
          .is_log_x = plot.is_log_x};
}

std::string row_name(const Plot& plot, const Frame& frame, std::size_t row) {
  return fmt::format("<text x={:.0f} y={:.0f} text-anchor=end>{}</text>", frame.left - 8,
                     frame.top + kRow * (static_cast<Real>(row) + 0.7),
                     html_text(plot.rows[row].name));
}

// The mark of one series in a row, with its interval where it has one.
std::string dot_svg(const Frame& frame, const Plot& plot, std::size_t s, std::size_t i,
                    Real shift) {
  const PlotSeries& series = plot.series[s];
  const Real y = frame.top + kRow * (series.y[i] + 0.5) + shift;
  std::string svg = opened({.optimizer = series.optimizer}, place_of(plot, s));
  std::string range;
  if (!series.low.empty()) {
    svg += fmt::format("<path class=whisker d=\"M{:.1f} {:.1f}H{:.1f}\"/>", frame.x(series.low[i]),
                       y, frame.x(series.high[i]));
    range = fmt::format(" [{}–{}]", reached_figure(series.low[i]), reached_figure(series.high[i]));
  }
  return svg + fmt::format(
                   "<text class=mark x={:.1f} y={:.1f} text-anchor=middle>{}<title>{}: {}{}"
                   "</title></text></g>",
                   frame.x(series.x[i]), y + 3.5, mark_of(place_of(plot, s)),
                   html_text(series.name), figure(series.x[i]), range);
}

// Series of different things in one row are moved apart; a row that is an optimizer has one.
std::string dots_svg(const Plot& plot) {
  const Frame frame = rows_frame(plot);
  std::vector<std::string> rows;
  for (std::size_t row = 0; row < plot.rows.size(); ++row)
    rows.push_back(opened(plot.rows[row].topic) + row_name(plot, frame, row));
  const bool are_apart = !plot.rows.empty() && plot.rows[0].topic.problem.has_value();
  const Real n = static_cast<Real>(plot.series.size());
  for (std::size_t s = 0; s < plot.series.size(); ++s)
    for (std::size_t i = 0; i < plot.series[s].x.size(); ++i)
      rows[static_cast<std::size_t>(plot.series[s].y[i])] += dot_svg(
          frame, plot, s, i, are_apart ? (static_cast<Real>(s) - (n - 1) / 2) * 0.7 * kRow / n : 0);
  return x_axis(frame, plot.x_label) + joined(rows, "</g>") + (rows.empty() ? "" : "</g>");
}

std::string bars_svg(const Plot& plot) {
  const Frame frame = rows_frame(plot);
  const PlotSeries& series = plot.series[0];
  std::string svg = x_axis(frame, plot.y_label);
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    const Real left = std::min(frame.x(0), frame.x(series.y[i]));
    svg += opened(plot.rows[i].topic) + row_name(plot, frame, i) +
           fmt::format(
               "<rect class=\"ratio {}\" x={:.1f} y={:.1f} width={:.1f} height={:.0f}><title>{}: "
               "{:+.2f}</title></rect></g>",
               series.y[i] < 0 ? "less" : "more", left, frame.top + kRow * static_cast<Real>(i) + 3,
               std::max(1.0, std::abs(frame.x(series.y[i]) - frame.x(0))), kRow - 6,
               html_text(plot.rows[i].name), series.y[i]);
  }
  return svg;
}

Real height_of(const Plot& plot) {
  const Real rows = static_cast<Real>(plot.rows.size());
  if (plot.kind == Plot::Kind::steps) return kTop + 250 + kBelow;
  return kTop + kRow * rows + kBelow;
}

// What the marks of a plot mean, where its rows do not say.
std::string marks_html(const Plot& plot) {
  if (plot.kind == Plot::Kind::lines) return lines_legend(plot);
  if (plot.kind != Plot::Kind::dots || plot.rows.empty() || plot.rows[0].topic.optimizer) return "";
  std::string html = "<p class=marks>";
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const PlotSeries& series = plot.series[s];
    const std::size_t place = place_of(plot, s);
    html += fmt::format("<span{}><b>{}</b> {}</span> ",
                        series.optimizer ? fmt::format(" data-s={}", *series.optimizer)
                                         : fmt::format(" class=c{}", place % 8),
                        mark_of(place), html_text(series.name));
  }
  return html + "</p>";
}

// Rows of methods close up where some are hidden: the scripts are told how high a row is.
std::string closing_rows(const Plot& plot) {
  if (plot.rows.empty() || plot.rows[0].topic.method.empty()) return "";
  return fmt::format(" class=dots data-row={:.0f} data-edge={:.0f}", kRow, kTop + kBelow);
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  if (plot.kind == Plot::Kind::lines) return lines_svg(plot);
  using Draw = std::string (*)(const Plot&);
  constexpr Draw kDraw[] = {steps_svg, dots_svg, bars_svg};  // by kind
  return fmt::format(
             "<svg{} viewBox=\"0 0 {:.0f} {:.0f}\" role=img aria-label=\"{}\"><title>{}</title>",
             closing_rows(plot), kWidth, height_of(plot),
             html_text(plot.title + ". " + plot.reading), html_text(plot.title)) +
         kDraw[static_cast<std::size_t>(plot.kind)](plot) + "</svg>";
}

std::string plot_html(const Plot& plot) {
  std::string figure = fmt::format(
      "<figure class=plot id={}><figcaption><b>{}.</b> {}</figcaption>{}{}<p class=legend>{}</p>"
      "</figure>\n",
      plot.id, html_text(plot.title), html_text(plot.reading), plot_svg(plot), marks_html(plot),
      html_text(plot.caption));
  if (!plot.is_folded) return figure;
  return fmt::format("<details><summary>{}</summary>{}</details>\n", html_text(plot.title), figure);
}

}  // namespace isoline::reports
