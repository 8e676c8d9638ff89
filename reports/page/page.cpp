// The page: its sections in the frame of outer.html, with style, scripts and Chart.js, filled with
// tables and data.
// One file that asks nothing of the network.
#include "reports/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "reports/formats/escape.h"
#include "reports/page/kinds.h"
#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string_view embedded_outer_html();
std::string_view embedded_page_html();
std::string_view embedded_page_css();
std::string_view embedded_parts_css();
std::string_view embedded_plots_css();
std::string_view embedded_fields_css();
std::string_view embedded_chart_js();
std::string_view embedded_lines_js();
std::string_view embedded_view_js();
std::string_view embedded_cells_js();
std::string_view embedded_tabs_js();
std::string_view embedded_bar_js();
std::string_view embedded_charts_js();
std::string_view embedded_planes_js();
std::string_view embedded_figures_js();
std::string_view embedded_tables_js();
std::string_view embedded_overview_js();
std::string_view embedded_pair_js();
std::string_view embedded_problem_js();
std::string_view embedded_fields_js();
std::string_view embedded_page_js();

namespace {

using Parts = std::map<std::string, std::string, std::less<>>;

// Replaces each {{name}} once; what is put in is not searched again.
std::string filled(std::string_view page, const Parts& parts) {
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

std::string remarks_html(const Document& document) {
  std::string html;
  for (const std::string& remark : document.remarks)
    html += fmt::format("<li>{}</li>", html_text(remark));
  return html.empty() ? "" : "<ul class=remarks>" + html + "</ul>";
}

// "quick · 2026-11-22 · 1a2b3c4 · 38 optimizers on …": the suites, the last day a run began, the
// commits of the programs that ran.
std::string head_html(const Document& document) {
  const Comparison& c = document.comparison;
  constexpr std::size_t kDay = 10, kShort = 7;
  std::vector<std::string> parts = c.study->plan.suites;
  std::string day;
  std::set<std::string> commits;
  for (const Run& run : c.runs) {
    const Provenance& from = run.record->provenance;
    day = std::max(day, from.run.started.substr(0, kDay));
    if (!run.record->imported && !from.build->commit.empty())
      commits.insert(from.build->commit.substr(0, kShort));
  }
  if (!day.empty()) parts.push_back(day);
  if (commits.size() == 1) parts.push_back(*commits.begin());
  if (commits.size() > 1) parts.push_back(counted(commits.size(), "commit"));
  parts.push_back(document.headline);
  return html_text(joined(parts, " · "));
}

// What marks mean besides that of privileges, where any method or problem has them.
std::string legend_html(const Comparison& c) {
  std::string legend;
  if (!foreign_legend(c).empty()) legend += " ·\n  <b>‡</b>: computed by another program";
  if (is_any_imported(c))
    legend += " ·\n  <b>§</b>: imported from others, by their own figures, never verified";
  return legend;
}

// The plot itself stands among the statistics.
std::string profile_html(const Comparison& c) {
  if (!has_order(c))
    return fmt::format("With {} a profile says no more than the standings; none is drawn.",
                       counted_settings(c, c.problems.size()));
  return html_text(profile_reading(c, kTightest));
}

constexpr std::string_view (*kScripts[])() = {
    embedded_chart_js,   embedded_lines_js,  embedded_view_js,     embedded_cells_js,
    embedded_tabs_js,    embedded_bar_js,    embedded_charts_js,   embedded_planes_js,
    embedded_figures_js, embedded_tables_js, embedded_overview_js, embedded_pair_js,
    embedded_problem_js, embedded_fields_js, embedded_page_js,
};

std::string scripts_html() {
  std::string html;
  for (const auto script : kScripts) html.append("<script>").append(script()).append("</script>\n");
  return html;
}

// A link to each section of a page, by the name that it bears there.
std::string tabs_html(std::string_view sections) {
  constexpr std::string_view kOpening = "<section id=\"", kNamed = "\" class=\"tab\" aria-label=\"";
  std::string html;
  for (std::size_t at = sections.find(kOpening); at != std::string_view::npos;
       at = sections.find(kOpening, at)) {
    at += kOpening.size();
    const std::size_t named = sections.find(kNamed, at), name = named + kNamed.size();
    html += fmt::format("  <a href=\"#{}\">{}</a>\n", sections.substr(at, named - at),
                        sections.substr(name, sections.find('"', name) - name));
  }
  return html;
}

// A page of these sections in the frame that all pages share.
std::string framed(std::string_view sections, const char* title, const char* about, Parts parts) {
  parts["sections"] = filled(sections, parts);
  parts["tabs"] = tabs_html(sections);
  parts["scripts"] = scripts_html();
  parts["title"] = title;
  parts["about"] = about;
  return filled(embedded_outer_html(), parts);
}

// Style, and what the bar of filters says before scripts run.
Parts common_parts(const Comparison& c, const AllFields& fields) {
  return {{"style", std::string(embedded_page_css())
                        .append(embedded_parts_css())
                        .append(embedded_plots_css())
                        .append(embedded_fields_css())},
          {"kinds", kind_rules(c)},
          {"tau", tau_name(c)},
          {"problems", problems_html(c, fields)}};
}

}  // namespace

std::string html_report(const Document& document) {
  const Comparison& c = document.comparison;
  const std::vector<Interval> intervals = score_intervals(c);
  const AllFields fields = all_found_fields(c);
  Parts parts = common_parts(c, fields);
  parts.merge(Parts{{"headline", head_html(document)},
                    {"counted", std::string(counted_name(c))},
                    {"unit", std::string(unit_name(c))},
                    {"setting", std::string(setting_noun(c))},
                    {"overview", overview_html(document)},
                    {"endings", endings_html(c)},
                    {"remarks", remarks_html(document)},
                    {"standings", standings_html(c, intervals)},
                    {"heat", heat_html(c)},
                    {"profile", profile_html(c)},
                    {"details", details_html(c)},
                    {"figures", figures_html(document)},
                    {"claims", claims_html(document)},
                    {"methods", methods_html(c)},
                    {"optimizers", optimizers_html(c)},
                    {"legend", legend_html(c)},
                    {"data", page_data(document, intervals, fields)}});
  for (const Section& section : document.sections)  // but those that the scripts redraw
    if (!parts.contains(section.id)) parts.emplace(section.id, section_html(section));
  return framed(embedded_page_html(), "Isoline report", "The page of a report.", std::move(parts));
}

}  // namespace isoline::reports
