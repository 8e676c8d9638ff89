// The page: template, style, scripts and Chart.js from reports/page, filled with tables and data.
// One file that asks nothing of the network.
#include "reports/page/page.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "reports/formats/escape.h"
#include "reports/read/grounds.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string_view embedded_page_html();
std::string_view embedded_page_css();
std::string_view embedded_parts_css();
std::string_view embedded_plots_css();
std::string_view embedded_chart_js();
std::string_view embedded_lines_js();
std::string_view embedded_view_js();
std::string_view embedded_cells_js();
std::string_view embedded_bar_js();
std::string_view embedded_legends_js();
std::string_view embedded_charts_js();
std::string_view embedded_planes_js();
std::string_view embedded_figures_js();
std::string_view embedded_tables_js();
std::string_view embedded_standings_js();
std::string_view embedded_glance_js();
std::string_view embedded_reached_js();
std::string_view embedded_page_js();

namespace {

// Replaces each {{name}} once; what is put in is not searched again.
std::string filled(std::string_view page,
                   const std::map<std::string, std::string, std::less<>>& parts) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    if (open == std::string_view::npos || close == std::string_view::npos) break;
    out += page.substr(0, open);
    out += parts.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
  return out.append(page);
}

std::string alerts_html(const Document& document) {
  const Comparison& c = document.comparison;
  std::string html;
  if (!document.incomplete.empty())
    html += fmt::format("<p class=alert role=alert><b>Incomplete.</b> {}</p>\n",
                        html_text(document.incomplete));
  const std::size_t unread = c.study->unreadable.size();
  if (!c.failures.empty() || unread > 0)
    html += fmt::format(
        "<p class=alert><b>{} failed</b>{} — <a href=\"#failures\">see below</a></p>\n",
        c.failures.size(), unread > 0 ? fmt::format(", {} unreadable files", unread) : "");
  return html;
}

std::string tiles_html(const Comparison& c) {
  std::string html = fmt::format("<li><b>{}<small>/{}</small></b>planned runs are here</li>",
                                 c.answered, c.planned);
  for (const auto& [status, count] : c.statuses)
    html += fmt::format("<li class=\"{}\"><b>{}</b>{}<small>{}</small></li>",
                        is_failure(status) ? "bad" : "", count, status_meaning(status),
                        name_of(status));
  return html;
}

std::string remarks_html(const Document& document) {
  std::string html;
  for (const std::string& remark : document.remarks)
    html += fmt::format("<li>{}</li>", html_text(remark));
  return html.empty() ? "" : "<ul class=remarks>" + html + "</ul>";
}

// Empty where problems are too few to say anything: then there is no chart either.
std::string profile_html(const Comparison& c) {
  if (!has_order(c))
    return fmt::format(
        "<p class=reading>With {} a profile says no more than the table above; none is drawn.</p>",
        counted_settings(c, c.problems.size()));
  return fmt::format(
      "<p class=reading id=profile-reading>{}</p><div class=\"chart profile\"></div>",
      html_text(profile_reading(c, kTightest)));
}

}  // namespace

std::string html_report(const Document& document) {
  const Comparison& c = document.comparison;
  std::map<std::string, std::string, std::less<>> parts = {
      {"style",
       std::string(embedded_page_css()).append(embedded_parts_css()).append(embedded_plots_css())},
      {"headline", html_text(document.headline)},
      {"tau", tau_name(c)},
      {"success", html_text(success_text(c))},
      {"counted", std::string(counted_name(c))},
      {"unit", std::string(unit_name(c))},
      {"setting", std::string(setting_noun(c))},
      {"prices", c.yardstick.by == Measure::work
                     ? ": each gradient, Jacobian or inverse at its declared price"
                     : ""},
      {"alerts", alerts_html(document)},
      {"tiles", tiles_html(c)},
      {"remarks", remarks_html(document)},
      {"glance", glance_html(c)},
      {"standings", standings_html(c)},
      {"matrix", matrix_html(c)},
      {"profile", profile_html(c)},
      {"details", details_html(c)},
      {"figures", figures_html(document)},
      {"claims", claims_html(document)},
      {"problems", problems_html(c)},
      {"optimizers", optimizers_html(c)},
      {"data", page_data(document)},
      {"chart-js", std::string(embedded_chart_js())},
      {"lines-js", std::string(embedded_lines_js())},
      {"view-js", std::string(embedded_view_js())},
      {"cells-js", std::string(embedded_cells_js())},
      {"bar-js", std::string(embedded_bar_js())},
      {"legends-js", std::string(embedded_legends_js())},
      {"charts-js", std::string(embedded_charts_js())},
      {"planes-js", std::string(embedded_planes_js())},
      {"figures-js", std::string(embedded_figures_js())},
      {"tables-js", std::string(embedded_tables_js())},
      {"standings-js", std::string(embedded_standings_js())},
      {"glance-js", std::string(embedded_glance_js())},
      {"reached-js", std::string(embedded_reached_js())},
      {"page-js", std::string(embedded_page_js())}};
  for (const Section& section : document.sections)  // but those that the scripts redraw
    if (!parts.contains(section.id)) parts.emplace(section.id, section_html(section));
  return filled(embedded_page_html(), parts);
}

}  // namespace isoline::reports
