// The table of all cells. Scripts sort and filter it; without scripts it is complete.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/origins.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string shown_html(const std::string& spec) { return html_text(shown_spec(spec)); }

std::string spread_cell(const Spread& spread, const char* kind = "") {
  if (spread.n == 0) return "<td>";
  const std::string range = range_figure(spread, reached_figure);
  return fmt::format("<td{}>{}{}", kind, reached_figure(spread.median),
                     range.empty() ? "" : "<small>" + range + "</small>");
}

std::string time_cell(const Spread& seconds, bool is_timed_alone) {
  const std::string range = range_figure(seconds, milliseconds);
  return fmt::format("<td>{}{}{}", milliseconds(seconds.median),
                     is_timed_alone || !seconds.is_solved() ? "" : "≈",
                     range.empty() ? "" : "<small>" + range + "</small>");
}

// "0..2", where the seeds of a cell follow each other and were asked for alike; else the first.
std::string seeds_of(const Comparison& c, const Cell& cell) {
  const Request& first = c.runs[cell.runs.front()].record->request;
  std::uint64_t next = first.seed;
  for (const std::size_t run : cell.runs) {
    const Request& request = c.runs[run].record->request;
    const bool is_alike = request.optimizer.spec == first.optimizer.spec &&
                          budget_options(request) == budget_options(first);
    if (request.seed != next++ || !is_alike) return fmt::format("={}", first.seed);
  }
  const std::uint64_t last = next - 1;
  return first.seed == last ? fmt::format("={}", last) : fmt::format("{}..{}", first.seed, last);
}

// What the command that repeats a cell has of its own, for scripts to put together: which budget,
// the seeds, and the optimizer where its name in the row is not its spec.
std::string again_cell(const Comparison& c, const Cell& cell, std::size_t s,
                       std::vector<std::string>& budgets) {
  const Request& request = c.runs[cell.runs[0]].record->request;
  const std::string budget = budget_options(request), &spec = request.optimizer.spec;
  const auto at = std::ranges::find(budgets, budget);
  const auto place = at - budgets.begin();
  if (at == budgets.end()) budgets.push_back(budget);
  const bool is_shown = shown_spec(c.optimizers[s].brief) == spec;
  return fmt::format("<td data-again=\"{} {}{}\">", place, seeds_of(c, cell),
                     is_shown ? "" : " " + html_text(spec));
}

std::string detail_row(const Comparison& c, std::size_t p, std::size_t s,
                       std::vector<std::string>& budgets) {
  const Cell& cell = c.cell(p, s);
  std::string row = fmt::format(
      "<tr data-p={} data-s={}><th>{}<th>{}{}", p, s, html_text(problem_name(c.problems[p])),
      html_text(setting_text(c, p, s)), cell.privileges.empty() ? "" : "<sup>†</sup>");
  if (!cell.is_measured()) {
    row += cell.runs.empty() ? "<td>" : "<td>n/a";
    for (int empty = 0; empty < 8; ++empty) row += "<td>";
    return row + fmt::format("<td>{}<td>\n", cell.runs.empty()
                                                 ? "missing"
                                                 : "n/a: " + html_text(cell.inapplicable));
  }
  row += fmt::format("<td>{}", count_text(cell, kTightest));
  const Measure by = c.yardstick.by == Measure::time ? Measure::work : c.yardstick.by;
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    row += spread_cell(cell.taken[by][t], cell.is_best[t] ? " class=best" : "");
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    row += time_cell(cell.taken[Measure::time][t], cell.is_timed_alone);
  row += spread_cell(cell.loss) + spread_cell(cell.x_error);
  return row +
         fmt::format("<td>{}{}\n", status_text(cell.statuses), again_cell(c, cell, s, budgets));
}

}  // namespace

std::string details_html(const Comparison& c) {
  constexpr std::size_t kMost = 20'000;  // rows of some 200 bytes
  if (c.problems.size() * c.optimizers.size() > kMost)
    return fmt::format(
        "<p class=lead>Of more than {} cells there is no table here: all of them stand "
        "in report.csv.</p>",
        kMost);
  std::string rows;
  std::vector<std::string> budgets;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0) rows += detail_row(c, p, s, budgets);
  std::vector<std::string> quoted;
  for (const std::string& budget : budgets) quoted.push_back(json_quoted(budget));
  std::string html = fmt::format(
      "<table class=sortable id=detail-table data-budgets=\"{}\"><thead><tr><th "
      "scope=col>problem<th scope=col>"
      "optimizer<th scope=col>runs<br>to {}",
      html_text("[" + joined(quoted) + "]"), tau_name(c));
  const std::string_view counted =
      c.yardstick.by == Measure::time ? "work" : name_of(c.yardstick.by);
  for (const std::string_view what : {counted, std::string_view("time, ms,")})
    for (const Tolerance& tolerance : c.yardstick.tolerances)
      html += fmt::format("<th scope=col>{}<br>to {}", what, tolerance.name);
  html +=
      "<th scope=col>final loss<th scope=col>error in x<th scope=col>how the runs ended<th "
      "scope=col>again<tbody>\n";
  return html + rows + "</table>";
}

}  // namespace isoline::reports
