// Axes as SVG.
#include "reports/page/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Real share_of(Real value, Real low, Real high) {
  if (!(high > low)) return 0;
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

std::string tick_text(Real value) {
  constexpr Real kInFull = 9999;
  if (value > kInFull) return fmt::format("1e{:.0f}", std::log10(value));
  return figure(value);
}

}  // namespace

Real Frame::x(Real value) const {
  if (is_log_x)
    return left +
           width * share_of(std::log(std::max(value, x_low)), std::log(x_low), std::log(x_high));
  return left + width * share_of(value, x_low, x_high);
}

Real Frame::y(Real value) const {
  if (is_log_y)
    return bottom() -
           height * share_of(std::log(std::max(value, y_low)), std::log(y_low), std::log(y_high));
  return bottom() - height * share_of(value, y_low, y_high);
}

std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic) {
  constexpr Real kMost = 8, kFewDoublings = 100;
  constexpr int kBound =
      64;  // of any axis: where a step is lost to rounding, none goes on for ever
  std::vector<Real> ticks;
  if (is_logarithmic) {
    Real factor = high / low <= kFewDoublings ? 2 : 10;
    const Real powers = std::log(high / low) / std::log(factor);
    factor = std::pow(factor, std::max(1.0, std::ceil(powers / kMost)));
    Real tick = std::pow(factor, std::ceil(std::log(low) / std::log(factor) - 1e-9));
    while (tick <= high * (1 + 1e-9) && std::ssize(ticks) < kBound) {
      ticks.push_back(tick);
      tick *= factor;
    }
    return ticks;
  }
  const Real rough = (high - low) / kMost, power = std::pow(10.0, std::floor(std::log10(rough)));
  Real step = 10 * power;
  for (const Real digit : {5, 2, 1})
    if (digit * power >= rough) step = digit * power;
  const Real first = std::ceil(low / step - 1e-9);
  for (int i = 0; i < kBound && (first + i) * step <= high + 1e-9 * step; ++i)
    ticks.push_back((first + i) * step + 0.0);  // no −0
  return ticks;
}

namespace {

// 1, 2 and 5 times the powers of ten within two decades, else the powers alone.
std::vector<Real> heights_of(const Frame& frame) {
  constexpr Real kNear = 100;
  if (!frame.is_log_y || frame.y_high > kNear * frame.y_low)
    return ticks_of(frame.y_low, frame.y_high, frame.is_log_y);
  std::vector<Real> ticks;
  Real power = std::pow(10.0, std::floor(std::log10(frame.y_low)));
  for (int decade = 0; decade <= 3; ++decade) {
    for (const Real digit : {1, 2, 5})
      if (digit * power >= frame.y_low && digit * power <= frame.y_high)
        ticks.push_back(digit * power);
    power *= 10;
  }
  return ticks;
}

}  // namespace

std::string x_axis(const Frame& frame, const std::string& label) {
  std::string svg;
  for (const Real tick : ticks_of(frame.x_low, frame.x_high, frame.is_log_x))
    svg += fmt::format(
        "<path class=grid d=\"M{0:.1f} {1:.0f}V{2:.0f}\"/><text x={0:.1f} y={3:.0f} "
        "class=tick text-anchor=middle>{4}</text>",
        frame.x(tick), frame.top, frame.bottom(), frame.bottom() + 14, tick_text(tick));
  return svg + fmt::format("<text x={:.0f} y={:.0f} class=tick text-anchor=middle>{}</text>",
                           frame.left + frame.width / 2, frame.bottom() + 30, html_text(label));
}

std::string y_axis(const Frame& frame, const std::string& label, bool is_share) {
  std::string svg;
  for (const Real tick : heights_of(frame)) {
    if (is_share && std::lround(10 * tick) % 2 != 0) continue;
    svg += fmt::format(
        "<path class=grid d=\"M{0:.0f} {1:.1f}H{2:.0f}\"/><text x={3:.0f} y={4:.1f} class=tick "
        "text-anchor=end>{5}</text>",
        frame.left, frame.y(tick), frame.right(), frame.left - 6, frame.y(tick) + 4,
        is_share ? percent(tick) : figure(tick));
  }
  return svg + fmt::format("<text x={:.0f} y={:.0f} class=tick>{}</text>", frame.left,
                           frame.top - 8, html_text(label));
}

// Draws lines with their bands, and a bar where a published value says a line should be.

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

// Draws the plots of the statistics as static SVG; colours and dashes are in page/plots.css.

namespace {

constexpr Real kPlotWidth = 720, kNames = 190, kRow = 18, kPlotTop = 26, kPlotBelow = 40;
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
                    .top = kPlotTop,
                    .width = kPlotWidth - 46 - kNames - 20,
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
          .top = kPlotTop,
          .width = kPlotWidth - kNames - 20,
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
  if (plot.kind == Plot::Kind::steps) return kPlotTop + 250 + kPlotBelow;
  return kPlotTop + kRow * rows + kPlotBelow;
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
  return fmt::format(" class=dots data-row={:.0f} data-edge={:.0f}", kRow, kPlotTop + kPlotBelow);
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  if (plot.kind == Plot::Kind::lines) return lines_svg(plot);
  using Draw = std::string (*)(const Plot&);
  constexpr Draw kDraw[] = {steps_svg, dots_svg, bars_svg};  // by kind
  return fmt::format(
             "<svg{} viewBox=\"0 0 {:.0f} {:.0f}\" role=img aria-label=\"{}\"><title>{}</title>",
             closing_rows(plot), kPlotWidth, height_of(plot),
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
