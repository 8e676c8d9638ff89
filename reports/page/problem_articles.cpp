// One section a problem: formula, what it takes to solve it, places for curves and paths.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "reports/formats/escape.h"
#include "reports/page/contour.h"
#include "reports/page/fields_html.h"
#include "reports/page/page.h"
#include "reports/read/curves.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Of the paths in x or in y; empty where fewer than two say anything.
std::string path_reading(const Comparison& c, std::size_t problem,
                         std::vector<std::vector<Real>> Path::*rows) {
  std::vector<Path> all = paths(c, problem);
  std::erase_if(all, [rows](const Path& path) { return detour(path.*rows) == kNever; });
  if (all.size() < 2) return "";
  const auto length = [rows](const Path& path) { return detour(path.*rows); };
  const auto [straight, winding] = std::ranges::minmax(all, {}, length);
  constexpr Real kStraight = 1.0005;
  const Real least = length(straight);
  return fmt::format(
      "Straightest: {}, {}. Longest way round: {}, {} the direct distance.",
      shown_spec(straight.optimizer),
      least < kStraight ? "a straight line" : multiple(least) + " the direct distance",
      shown_spec(winding.optimizer), multiple(length(winding)));
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

// Of J at both ends, where they are known.
std::string condition_text(const Sheet& sheet) {
  std::string text;
  if (sheet.start_condition) text += figure(*sheet.start_condition) + " at the start";
  if (sheet.condition)
    text += fmt::format("{}{} at the solution", text.empty() ? "" : ", ", figure(*sheet.condition));
  return text.empty() ? "" : fmt::format("condition of J {}, ", text);
}

std::string about_html(const Sheet& sheet) {
  std::string facts;
  if (sheet.unknowns > 0)
    facts += fmt::format("{} unknown{}, ", sheet.unknowns, sheet.unknowns == 1 ? "" : "s");
  if (sheet.residuals > 0)
    facts += fmt::format("{} residual{}, ", sheet.residuals, sheet.residuals == 1 ? "" : "s");
  facts += condition_text(sheet);
  facts +=
      sheet.inverse.empty() || sheet.inverse == "none" ? "no inverse" : sheet.inverse + " inverse";
  std::string html = fmt::format(
      "<p class=about>{} <cite>{}</cite> · {}</p><p class=formula>{}</p>", html_text(sheet.title),
      html_text(sheet.source), html_text(facts), html_text(sheet.formula));
  if (!sheet.note.empty()) html += fmt::format("<p class=note>{}</p>", html_text(sheet.note));
  return html;
}

std::string problem_html(const Comparison& c, std::size_t p,
                         const std::optional<FoundFields>& fields) {
  const ProblemAxis& problem = c.problems[p];
  const Sheet* sheet = problem.sheet;
  std::string html =
      fmt::format("<article class=\"problem one\" id=problem-{0} data-p={0}><noscript><h3>{1}</h3>",
                  p, html_text(problem_name(problem)));
  if (sheet != nullptr) html += about_html(*sheet);
  html += fmt::format(
      "<p class=reading>{}</p><div class=solve><div class=curves></div><div "
      "class=reached></div></div>",
      html_text(curve_reading(c, p)));
  html += planes_html(c, p);
  if (fields) html += fields_html(c, *fields);
  return html + "</noscript></article>\n";
}

}  // namespace

// By group, each a row of links.
std::string problems_html(const Comparison& c, const AllFields& fields) {
  std::map<std::string, std::string> groups;
  std::string index, html;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    groups[c.problems[p].group()] += fmt::format("<a href=\"#problem-{0}\" data-p={0}>{1}</a>\n", p,
                                                 html_text(problem_name(c.problems[p])));
    html += problem_html(c, p, fields[p]);
  }
  for (const char* group : {"toy", "physics", "classical", "learned", "other"})
    if (groups.contains(group))
      index += fmt::format("<p class=index><b>{}</b> {}</p>", group, groups[group]);
  return index + html;
}

}  // namespace isoline::reports
