// Draws the plots of the statistics as static SVG; colours and dashes are in page/plots.css.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/plots/frame.h"
#include "reports/plots/plots.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

constexpr Real kWidth = 720, kNames = 190, kRow = 18, kTop = 26, kBelow = 40;
constexpr const char* kMarks[] = {"●", "■", "▲", "◆", "▼", "○", "□", "△"};

std::string mark_of(std::size_t optimizer) { return kMarks[optimizer % std::size(kMarks)]; }

// What is filtered with an optimizer or a problem.
std::string opened(const std::optional<std::size_t>& optimizer,
                   const std::optional<std::size_t>& problem) {
  std::string tag = "<g";
  if (optimizer) tag += fmt::format(" data-s={} class=c{}", *optimizer, *optimizer % 8);
  if (problem) tag += fmt::format(" data-p={}", *problem);
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

std::string line_svg(const Frame& frame, const PlotSeries& line, std::size_t place) {
  std::string svg = opened(line.optimizer, std::nullopt);
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
    svg += line_svg(frame, plot.series[i], i);
  return svg;
}

// A frame with a row a name, wide enough for all finite numbers.
Frame rows_frame(const Plot& plot) {
  Real low = std::numeric_limits<Real>::infinity(), high = -low;
  const bool are_bars = plot.kind == Plot::Kind::bars;
  for (const PlotSeries& series : plot.series)
    for (const auto* column : {are_bars ? &series.y : &series.x, &series.low, &series.high})
      for (const Real value : *column) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value), high = std::max(high, value);
      }
  if (are_bars) low = std::min(low, 0.0), high = std::max(high, 0.0);
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

std::string row_names(const Plot& plot, const Frame& frame) {
  std::string svg;
  for (std::size_t i = 0; i < plot.rows.size(); ++i)
    svg += opened(std::nullopt, plot.rows[i].problem) +
           fmt::format(
               "<text x={:.0f} y={:.0f} text-anchor=end{}>{}</text></g>", frame.left - 8,
               frame.top + kRow * (static_cast<Real>(i) + 0.7),
               plot.rows[i].optimizer ? fmt::format(" data-s={}", *plot.rows[i].optimizer) : "",
               html_text(plot.rows[i].name));
  return svg;
}

std::string dot_svg(const Frame& frame, const PlotSeries& series, std::size_t i, Real shift) {
  const Real y = frame.top + kRow * (series.y[i] + 0.5) + shift;
  return fmt::format(
      "<path class=whisker d=\"M{:.1f} {:.1f}H{:.1f}\"/><text class=mark x={:.1f} y={:.1f} "
      "text-anchor=middle>{}<title>{}: {} [{}–{}]</title></text>",
      frame.x(series.low[i]), y, frame.x(series.high[i]), frame.x(series.x[i]), y + 3.5,
      mark_of(series.optimizer), html_text(series.name), figure(series.x[i]),
      reached_figure(series.low[i]), reached_figure(series.high[i]));
}

std::string dots_svg(const Plot& plot) {
  const Frame frame = rows_frame(plot);
  std::string svg = x_axis(frame, plot.x_label) + row_names(plot, frame);
  const bool are_rows = !plot.rows.empty() && plot.rows[0].optimizer.has_value();
  const Real n = static_cast<Real>(plot.series.size());
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const PlotSeries& series = plot.series[s];
    const Real shift = are_rows ? 0 : (static_cast<Real>(s) - (n - 1) / 2) * 0.7 * kRow / n;
    svg += opened(series.optimizer, std::nullopt);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const auto row = static_cast<std::size_t>(series.y[i]);
      svg +=
          opened(std::nullopt, plot.rows[row].problem) + dot_svg(frame, series, i, shift) + "</g>";
    }
    svg += "</g>";
  }
  return svg;
}

std::string bars_svg(const Plot& plot) {
  const Frame frame = rows_frame(plot);
  const PlotSeries& series = plot.series[0];
  std::string svg = x_axis(frame, plot.y_label) + row_names(plot, frame);
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    const Real left = std::min(frame.x(0), frame.x(series.y[i]));
    svg += opened(std::nullopt, plot.rows[i].problem) +
           fmt::format(
               "<rect class=\"ratio {}\" x={:.1f} y={:.1f} width={:.1f} height={:.0f}><title>{}: "
               "{:+.2f}</title></rect></g>",
               series.y[i] < 0 ? "less" : "more", left, frame.top + kRow * static_cast<Real>(i) + 3,
               std::max(1.0, std::abs(frame.x(series.y[i]) - frame.x(0))), kRow - 6,
               html_text(plot.rows[i].name), series.y[i]);
  }
  return svg;
}

// p in the cell; rows have names, columns their numbers.
std::string matrix_svg(const Plot& plot) {
  constexpr Real kCell = 46, kHigh = 22, kSure = 0.05, kNearly = 0.2;
  std::string svg;
  for (std::size_t a = 0; a < plot.series.size(); ++a) {
    const PlotSeries& row = plot.series[a];
    const Real y = kTop + kHigh * static_cast<Real>(a);
    svg += fmt::format("<g data-s={}><text x={:.0f} y={:.0f} text-anchor=end>{}. {}</text>",
                       row.optimizer, kNames - 8, y + 15, a + 1, html_text(row.name));
    for (std::size_t b = 0; b < row.y.size(); ++b) {
      if (std::isnan(row.y[b])) continue;
      const char* shade = row.y[b] <= kSure ? "sure" : row.y[b] <= kNearly ? "nearly" : "unsure";
      const Real x = kNames + kCell * static_cast<Real>(b);
      svg += fmt::format(
          "<g data-s={}><rect class=\"cell {}\" x={:.0f} y={:.0f} width={:.0f} height={:.0f} "
          "/><text "
          "class={} x={:.0f} y={:.0f} text-anchor=middle>{:.2g}</text></g>",
          plot.series[b].optimizer, shade, x + 1, y + 1, kCell - 2, kHigh - 2, shade, x + kCell / 2,
          y + 15, row.y[b]);
    }
    svg += "</g>";
  }
  for (std::size_t b = 0; b < plot.series.size(); ++b)
    svg += fmt::format("<text data-s={} class=tick x={:.0f} y={:.0f} text-anchor=middle>{}.</text>",
                       plot.series[b].optimizer, kNames + kCell * (static_cast<Real>(b) + 0.5),
                       kTop - 8, b + 1);
  return svg;
}

Real height_of(const Plot& plot) {
  const Real rows = static_cast<Real>(plot.rows.size());
  if (plot.kind == Plot::Kind::steps) return kTop + 250 + kBelow;
  if (plot.kind == Plot::Kind::matrix) return kTop + 22 * rows + 8;
  return kTop + kRow * rows + kBelow;
}

// Marks of a plot whose rows are problems.
std::string marks_html(const Plot& plot) {
  if (plot.kind != Plot::Kind::dots || plot.rows.empty() || plot.rows[0].optimizer) return "";
  std::string html = "<p class=marks>";
  for (const PlotSeries& series : plot.series)
    html += fmt::format("<span data-s={0} class=c{1}><b>{2}</b> {3}</span> ", series.optimizer,
                        series.optimizer % 8, mark_of(series.optimizer), html_text(series.name));
  return html + "</p>";
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  using Draw = std::string (*)(const Plot&);
  constexpr Draw kDraw[] = {steps_svg, dots_svg, bars_svg, matrix_svg};  // by kind
  return fmt::format(
             "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=img aria-label=\"{}\"><title>{}</title>",
             kWidth, height_of(plot), html_text(plot.title + ". " + plot.reading),
             html_text(plot.title)) +
         kDraw[static_cast<std::size_t>(plot.kind)](plot) + "</svg>";
}

std::string plot_html(const Plot& plot) {
  return fmt::format(
      "<figure class=plot id={}><figcaption><b>{}.</b> {}</figcaption>{}{}<p class=legend>{}</p>"
      "</figure>\n",
      plot.id, html_text(plot.title), html_text(plot.reading), plot_svg(plot), marks_html(plot),
      html_text(plot.caption));
}

}  // namespace isoline::reports
