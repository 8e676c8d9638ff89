// The tables of the page. Scripts sort and filter them; without scripts they are complete.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/page.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {
namespace {

// How far from the best, as a class of the style sheet: h0 the least, then by factors of two.
std::string heat(Real work, Real least) {
  constexpr Real kDarkest = 7;
  const Real doublings = std::log2(std::max(work, 1.0) / std::max(least, 1.0));
  return fmt::format("h{:.0f}", std::min(std::ceil(doublings), kDarkest));
}

std::string dagger(const std::vector<std::string>& privileges) {
  if (privileges.empty()) return "";
  return fmt::format("<sup title=\"sees {}\">†</sup>",
                     html_text(fmt::format("{}", fmt::join(privileges, ", "))));
}

// "5/5, 1 failed" as one small line each.
std::string small_lines(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t end = text.find(", ");
    html += fmt::format("<small>{}</small>", text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 2);
  }
  return html;
}

std::string matrix_cell(const Cell& cell, std::size_t tolerance, Real least) {
  const std::string text = matrix_text(cell, tolerance);
  if (cell.planned == 0) return "<td class=none></td>";
  if (cell.runs.empty()) return "<td class=lost>missing</td>";
  if (!cell.is_measured())
    return fmt::format("<td class=na title=\"{}\">n/a</td>", html_text(cell.inapplicable));
  const Spread& work = cell.work[tolerance];
  const std::string count =
      is_complete(cell, tolerance) && work.n == 1 ? "" : small_lines(count_text(cell, tolerance));
  const std::string title = html_text(status_text(cell.statuses));
  if (!work.is_solved())
    return fmt::format("<td class=no title=\"{}\">✗{}{}</td>", title, dagger(cell.privileges),
                       count);
  return fmt::format("<td class=\"{}{}\" title=\"{}\">{}{}{}</td>", heat(work.median, least),
                     cell.is_best[tolerance] ? " best" : "", title, text, dagger(cell.privileges),
                     count);
}

Real least_work(const Comparison& c, std::size_t problem, std::size_t tolerance) {
  Real least = kNever;
  for (const Cell& cell : c.cells[problem]) least = std::min(least, cell.work[tolerance].median);
  return least;
}

std::string spread_cell(const Spread& spread, const char* kind = "") {
  if (spread.n == 0) return "<td></td>";
  const std::string range = range_figure(spread, reached_figure);
  return fmt::format("<td{}>{}{}</td>", kind, reached_figure(spread.median),
                     range.empty() ? "" : "<small>" + range + "</small>");
}

std::string time_cell(const Spread& seconds, bool is_timed_alone) {
  const std::string range = range_figure(seconds, milliseconds);
  return fmt::format("<td{}>{}{}{}</td>", is_timed_alone ? "" : " class=together",
                     milliseconds(seconds.median),
                     is_timed_alone || !seconds.is_solved() ? "" : "≈",
                     range.empty() ? "" : "<small>" + range + "</small>");
}

std::string detail_row(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  std::string row = fmt::format("<tr><th>{}</th><th>{}{}</th>", html_text(c.problems[p].spec),
                                html_text(c.optimizers[s].label), dagger(cell.privileges));
  if (!cell.is_measured())
    return row + fmt::format("<td>{}</td><td colspan=8></td><td class=text>{}</td><td></td></tr>\n",
                             cell.runs.size(),
                             cell.runs.empty() ? "missing"
                                               : "inapplicable: " + html_text(cell.inapplicable));
  row += fmt::format("<td>{}</td>", count_text(cell, kTightest));
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    row += spread_cell(cell.work[t], cell.is_best[t] ? " class=best" : "");
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    row += time_cell(cell.seconds[t], cell.is_timed_alone);
  row += spread_cell(cell.loss) + spread_cell(cell.x_error);
  const Request& request = c.runs[cell.runs[0]].record->request;
  return row + fmt::format("<td class=text>{}</td><td data-copy=\"{}\"></td></tr>\n",
                           status_text(cell.statuses), html_text(rerun_command(request)));
}

}  // namespace

std::string matrix_html(const Comparison& c, std::size_t tolerance) {
  std::string html = fmt::format(
      "<table class=matrix><caption>Median work to {}, in forward solves</caption>"
      "<thead><tr><th>optimizer</th><th>solved</th>",
      kTolerances[tolerance].name);
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    html += fmt::format("<th><a href=\"#problem-{}\"><span>{}</span></a></th>", p,
                        html_text(c.problems[p].spec));
  html += "</tr></thead><tbody>\n";
  std::vector<Real> least;
  for (std::size_t p = 0; p < c.problems.size(); ++p) least.push_back(least_work(c, p, tolerance));
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const OptimizerAxis& optimizer = c.optimizers[s];
    html += fmt::format("<tr><th>{}{}</th><td class=solved>{}<small>/{}</small></td>",
                        html_text(optimizer.label), dagger(optimizer.privileges),
                        optimizer.solved[tolerance], c.problems.size());
    for (std::size_t p = 0; p < c.problems.size(); ++p)
      html += matrix_cell(c.cell(p, s), tolerance, least[p]);
    html += "</tr>\n";
  }
  return html + "</tbody></table>";
}

std::string details_html(const Comparison& c) {
  std::string html =
      "<table class=sortable id=detail-table><thead><tr><th>problem</th><th>optimizer</th>"
      "<th title=\"runs that reach 1e-6 of all runs\">reach 1e-6</th>";
  for (const char* what : {"work", "time, ms"})
    for (const Tolerance& tolerance : kTolerances)
      html += fmt::format("<th>{}<br>to {}</th>", what, tolerance.name);
  html += "<th>final loss</th><th>x error</th><th>status</th><th>rerun</th></tr></thead><tbody>\n";
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0) html += detail_row(c, p, s);
  return html + "</tbody></table>";
}

std::string failures_html(const Comparison& c) {
  std::string html;
  for (const std::size_t run : c.failures) {
    const Record& record = *c.runs[run].record;
    html += fmt::format(
        "<tr><th>{}</th><th>{}</th><td>{}</td><td class=text>{}</td><td class=text>{}</td>"
        "<td class=text><code>{}</code></td></tr>\n",
        html_text(record.request.problem.spec), html_text(record.request.optimizer.spec),
        record.request.seed, name_of(record.status), html_text(record.message),
        html_text(rerun_command(record.request)));
  }
  for (const Unreadable& file : c.study->unreadable)
    html += fmt::format(
        "<tr><th colspan=3>{}</th><td class=text>unreadable</td><td class=text "
        "colspan=2>{}</td></tr>\n",
        html_text(file.file.string()), html_text(file.reason));
  if (html.empty()) return "<p>None: every run ended by a verdict of its own.</p>";
  return "<div class=scroll tabindex=0 role=region aria-label=Failures><table "
         "class=sortable><thead><tr><th>problem</th><th>optimizer</th>"
         "<th>seed</th><th>status</th><th>message</th><th>rerun</th></tr></thead><tbody>\n" +
         html + "</tbody></table></div>";
}

}  // namespace isoline
