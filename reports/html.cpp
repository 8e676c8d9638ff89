// The page: template, style, scripts and Chart.js from reports/page, filled with tables and data.
// One file that asks nothing of the network.
#include "reports/html.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "reports/audit.h"
#include "reports/contour.h"
#include "reports/curves.h"
#include "reports/learned.h"
#include "reports/readings.h"
#include "reports/report.h"
#include "reports/tables_formats.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {

std::string_view embedded_page_html();
std::string_view embedded_page_css();
std::string_view embedded_plots_css();
std::string_view embedded_page_js();
std::string_view embedded_tables_js();
std::string_view embedded_charts_js();
std::string_view embedded_lines_js();
std::string_view embedded_figures_js();
std::string_view embedded_chart_js();

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

std::string alerts_html(const Comparison& c) {
  std::string html;
  if (!c.missing.empty())
    html += fmt::format("<p class=alert role=alert><b>Incomplete.</b> {}</p>\n",
                        html_text(missing_text(c)));
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

std::string verdict_html(const Comparison& c) {
  std::string html;
  for (const std::string& sentence : verdict(c))
    html += fmt::format("<p>{}</p>\n", html_text(sentence));
  return html;
}

std::string remarks_html(const Comparison& c) {
  std::string html;
  for (const std::string& remark : remarks(c))
    html += fmt::format("<li>{}</li>", html_text(remark));
  return html.empty() ? "" : "<ul class=remarks>" + html + "</ul>";
}

// One pane a tolerance, of which the page shows one.
std::string panes_html(const Comparison& c, const char* label,
                       std::string (*table)(const Comparison&, std::size_t)) {
  std::string html;
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    html += fmt::format(
        "<div class=\"scroll pane\" data-tau={} tabindex=0 role=region "
        "aria-label=\"{}\">{}</div>\n",
        t, label, table(c, t));
  return html;
}

// Empty where problems are too few to say anything: then there is no chart either.
std::string profile_html(const Comparison& c) {
  if (c.problems.size() < kFewProblems)
    return fmt::format(
        "<p class=reading>With {} problem{} a profile says no more than the table "
        "above; none is drawn.</p>",
        c.problems.size(), c.problems.size() == 1 ? "" : "s");
  std::string html = "<div class=\"switch tau\" role=group aria-label=Tolerance hidden></div>\n";
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    html += fmt::format("<p class=\"reading pane\" data-tau={}>{}</p>\n", t,
                        html_text(profile_reading(c, t)));
  return html + "<div class=\"chart profile\"></div>";
}

std::string plane_html(const char* space, const std::string& title, const std::string& reading) {
  return fmt::format(
      "<figure><figcaption><b>{}</b> {}</figcaption><div class=plane data-space={}></div></figure>",
      title, html_text(reading), space);
}

// Paths as the paper draws them: short runs with a marker a step, long ones as lines.
std::string planes_html(const Comparison& c, std::size_t p) {
  const Sheet* sheet = c.problems[p].sheet;
  const bool has_planes = sheet != nullptr && (sheet->landscape_x || sheet->landscape_y);
  if (!has_planes || paths(c, p).empty()) return "";
  std::string html = "<div class=planes>";
  if (sheet->landscape_x)
    html += plane_html("x", "Paths in x, over the loss.", path_reading(c, p, &Path::x));
  if (sheet->landscape_y)
    html += plane_html("y", "The same paths in y.", path_reading(c, p, &Path::y));
  return html + fmt::format(
                    "</div><p class=legend>Thin lines: equal loss, {}. Paths of the lowest "
                    "seed; markers are steps, drawn for runs of few steps. ○ start, ✳ {}.</p>",
                    contour_wording(sheet->landscape_x ? *sheet->landscape_x : *sheet->landscape_y),
                    "solution in x, target in y");
}

std::string problem_html(const Comparison& c, std::size_t p) {
  const ProblemAxis& problem = c.problems[p];
  const Sheet* sheet = problem.sheet;
  std::string html =
      fmt::format("<article class=problem id=problem-{0} data-problem={0}><h3>{1}</h3>", p,
                  html_text(shown_spec(problem.spec)));
  if (sheet != nullptr)
    html +=
        fmt::format("<p class=about>{} <span class=formula>{}</span> <cite>{}</cite></p>",
                    html_text(sheet->title), html_text(sheet->formula), html_text(sheet->source));
  html += fmt::format("<p class=reading>{}</p><div class=curves></div>",
                      html_text(curve_reading(c, p)));
  return html + planes_html(c, p) + "</article>\n";
}

std::string problems_html(const Comparison& c) {
  std::string index, html;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    index += fmt::format("<a href=\"#problem-{}\">{}</a>\n", p,
                         html_text(shown_spec(c.problems[p].spec)));
    html += problem_html(c, p);
  }
  return "<p class=index>" + index + "</p>" + html;
}

}  // namespace

std::string html_report(const Comparison& c) {
  const std::vector<Figure> drawn = figures(c);
  return filled(embedded_page_html(),
                {{"style", std::string(embedded_page_css()) + std::string(embedded_plots_css())},
                 {"headline", html_text(headline(c))},
                 {"alerts", alerts_html(c)},
                 {"tiles", tiles_html(c)},
                 {"remarks", remarks_html(c)},
                 {"verdict", verdict_html(c)},
                 {"standings", panes_html(c, "Standings", standings_html)},
                 {"matrices", panes_html(c, "Work", matrix_html)},
                 {"profile", profile_html(c)},
                 {"statistics", statistics_html(c)},
                 {"details", details_html(c)},
                 {"learned", learned_html(c)},
                 {"audit", audit_html(c.study->audits)},
                 {"figures", figures_html(drawn)},
                 {"claims", claims_html(c.claims)},
                 {"problems", problems_html(c)},
                 {"families", families_html(c)},
                 {"failures", failures_html(c)},
                 {"provenance", provenance_html(c)},
                 {"data", page_data(c, drawn)},
                 {"chart-js", std::string(embedded_chart_js())},
                 {"lines-js", std::string(embedded_lines_js())},
                 {"charts-js", std::string(embedded_charts_js())},
                 {"figures-js", std::string(embedded_figures_js())},
                 {"tables-js", std::string(embedded_tables_js())},
                 {"page-js", std::string(embedded_page_js())}});
}

}  // namespace isoline
