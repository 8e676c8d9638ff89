// The audit on the page: sentences, one plot a property, the table. All of it needs no script.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/audit/audit.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

using All = std::vector<AuditedOptimizer>;

// Shapes, so that colour is not needed to tell series apart.
constexpr const char* kMarks[] = {"○", "■", "▲", "◇", "×", "+"};
constexpr int kLeft = 190, kWidth = 640, kRow = 16, kTop = 34, kRight = 20;

Real place(Real value, const std::vector<Real>& ticks) {
  const Real share = (value - ticks.front()) / (ticks.back() - ticks.front());
  return kLeft + std::clamp(share, 0.0, 1.0) * (kWidth - kLeft - kRight);
}

template <class Value>
DotSeries series_of(const All& all, const std::string& name, Value value) {
  DotSeries series{name, {}};
  for (const AuditedOptimizer& audited : all)
    series.values.push_back(audited.reason.empty() ? value(audited) : kUnknown);
  return series;
}

Real decade(Real value) {  // 1e-16 is as small as rounding lets be told
  return std::isnan(value) ? value : std::log10(std::max(value, 1e-16));
}

std::string exponents_plot(const All& all, const std::vector<std::string>& rows) {
  std::vector<DotSeries> series;
  for (std::size_t i = 0; i < kScalingNames.size(); ++i)
    series.push_back(series_of(all, std::string(kScalingNames[i]), [i](const auto& audited) {
      const PowerLaw& law = audited.scalings[i].step;
      return law.holds() ? law.exponent : kUnknown;
    }));
  return dot_plot("Exponent of the first step, by what is scaled", rows, series,
                  {-1, -0.5, 0, 0.5, 1, 1.5, 2});
}

std::string deviations_plot(const All& all, const std::vector<std::string>& rows) {
  std::vector<DotSeries> series;
  for (std::size_t i = 0; i < kChangeNames.size(); ++i)
    series.push_back(series_of(all, std::string(kChangeNames[i]),
                               [i](const auto& audited) { return decade(audited.deviations[i]); }));
  return dot_plot("Deviation of the path, decades: −16 is rounding, 0 another path", rows, series,
                  {-16, -12, -8, -4, 0});
}

std::string orders_plot(const All& all, const std::vector<std::string>& rows) {
  const auto order = [](const Approach& approach) {
    return approach.residual <= kMostOrderResidual ? approach.order : kUnknown;
  };
  return dot_plot(
      "Order of convergence", rows,
      {series_of(all, "J regular", [&](const auto& audited) { return order(audited.regular); }),
       series_of(all, "J singular", [&](const auto& audited) { return order(audited.singular); })},
      {0, 0.5, 1, 1.5, 2, 2.5});
}

std::string angles_plot(const All& all, const std::vector<std::string>& rows) {
  return dot_plot(
      "Angle between promised and made step, degrees", rows,
      {series_of(all, "linear stage", [](const auto& audited) { return audited.linear_angle; }),
       series_of(all, "curved stage", [](const auto& audited) { return audited.curved_angle; })},
      {0, 15, 30, 45, 60, 75, 90});
}

std::string oracles_plot(const All& all, const std::vector<std::string>& rows) {
  std::vector<DotSeries> series;
  for (const char* oracle : {"forward", "pullback", "jacobian", "hessian", "inverse", "truth"})
    series.push_back(series_of(all, oracle, [oracle](const AuditedOptimizer& audited) {
      const auto at = audited.counted.find(oracle);
      if (at == audited.counted.end() || audited.iterations == 0) return kUnknown;
      return static_cast<Real>(at->second) / static_cast<Real>(audited.iterations);
    }));
  return dot_plot("Oracle calls an iteration, as counted", rows, series, {0, 1, 2, 3, 4});
}

std::string table(const All& all) {
  std::string html =
      "<div class=\"scroll tall\" tabindex=0 role=region aria-label=\"Audit\"><table "
      "class=sortable><thead><tr><th scope=col>optimizer";
  for (const AuditColumn& column : kAuditColumns)
    html += fmt::format("<th scope=col title=\"{}\">{}", html_text(column.meaning),
                        html_text(column.heading));
  html += "<tbody>\n";
  for (const AuditedOptimizer& audited : all) {
    html += fmt::format("<tr data-method=\"{}\"><th scope=row>{}", html_text(audited.name),
                        html_text(shown_spec(audited.spec)));
    if (!audited.reason.empty())
      html += fmt::format("<td colspan={}>{}", kAuditColumns.size(), html_text(audited.reason));
    if (audited.reason.empty())
      for (const AuditColumn& column : kAuditColumns)
        html += "<td>" + html_text(column.cell(audited));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string dot_plot(const std::string& title, const std::vector<std::string>& rows,
                     const std::vector<DotSeries>& series, const std::vector<Real>& ticks) {
  const int height = kTop + kRow * static_cast<int>(rows.size()) + kRow;
  std::string legend;
  for (std::size_t i = 0; i < series.size(); ++i)
    legend += fmt::format("{}{} {}", i > 0 ? ", " : "", kMarks[i % std::size(kMarks)],
                          html_text(series[i].name));
  std::string svg = fmt::format(
      "<figure><figcaption><b>{0}.</b> {1}</figcaption><svg class=dots data-row={4} data-edge={5} "
      "viewBox=\"0 0 {2} {3}\" role=img aria-label=\"{0}\" font-size=11 fill=currentColor "
      "style=\"max-width:{2}px\">",
      html_text(title), legend, kWidth, height, kRow, kTop + kRow);
  for (const Real tick : ticks)
    svg += fmt::format(
        "<path d=\"M{0:.0f} {1}V{2}\" stroke=currentColor opacity=.2 /><text x={0:.0f} y={3} "
        "text-anchor=middle>{4}</text>",
        place(tick, ticks), kTop - kRow / 2, height - kRow, kTop - kRow, figure(tick));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const int y = kTop + kRow * static_cast<int>(row) + kRow / 2;
    svg += fmt::format("<g data-method=\"{2}\"><text x={0} y={1} text-anchor=end>{2}</text>",
                       kLeft - 14, y, html_text(rows[row]));
    for (std::size_t i = 0; i < series.size(); ++i) {
      const Real value = series[i].values[row];
      if (std::isnan(value)) continue;
      svg += fmt::format("<text x={:.1f} y={} text-anchor=middle>{}<title>{}: {}</title></text>",
                         place(value, ticks), y, kMarks[i % std::size(kMarks)],
                         html_text(series[i].name), figure(value));
    }
    svg += "</g>";
  }
  return svg + "</svg></figure>\n";
}

std::string audit_html(const All& all) {
  if (all.empty()) return "<p class=lead>These results hold no audit of properties.</p>";
  std::vector<std::string> rows;
  for (const AuditedOptimizer& audited : all) rows.push_back(audited.name);
  const std::vector<std::string> plots = {exponents_plot(all, rows), deviations_plot(all, rows),
                                          orders_plot(all, rows), angles_plot(all, rows),
                                          oracles_plot(all, rows)};
  std::string html;
  const std::vector<AuditReading> readings = audit_readings(all);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    html += fmt::format("<p class=reading><b>{}.</b> {}</p>\n", readings[i].property,
                        html_text(readings[i].sentence));
    if (i < plots.size()) html += "<details><summary>Plot</summary>" + plots[i] + "</details>\n";
  }
  return html + table(all);
}

}  // namespace isoline::reports
