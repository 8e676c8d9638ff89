// The first tab: the verdict, what is settled and what is not, and how the runs ended.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "reports/formats/escape.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string alerts_html(const Document& document) {
  const Comparison& c = document.comparison;
  std::string html;
  if (!document.incomplete.empty())
    html += fmt::format("<p class=alert role=alert><b>Incomplete.</b> {}</p>\n",
                        html_text(document.incomplete));
  const std::size_t unread = c.study->unreadable.size();
  if (!c.failures.empty() || unread > 0)
    html += fmt::format(
        "<p class=alert><b>{} failed</b>{} — <a href=\"#failures\">which, and why</a></p>\n",
        counted(c.failures.size(), "run"),
        unread > 0 ? fmt::format(", {} unreadable", counted(unread, "file")) : "");
  return html;
}

// A sentence decides; all that these runs say opens.
std::string verdict_html(const Comparison& c) {
  const std::vector<std::string> sentences = verdict(c);
  if (sentences.empty()) return "";
  std::string html = fmt::format("<p class=verdict>{}</p>\n", html_text(short_verdict(c)));
  html += "<details><summary>All that these runs say</summary>";
  for (const std::string& sentence : sentences)
    html += fmt::format("<p class=lead>{}</p>\n", html_text(sentence));
  return html + "</details>\n";
}

std::string settled_html(const Comparison& c) {
  std::string html = "<dl class=settled>";
  for (const Reading& reading : settled_readings(c))
    html += fmt::format("<dt>{}<dd>{}", html_text(reading.title), html_text(reading.text));
  return html + "</dl>\n";
}

}  // namespace

std::string overview_html(const Document& document) {
  const Comparison& c = document.comparison;
  return alerts_html(document) + verdict_html(c) + settled_html(c);
}

std::string endings_html(const Comparison& c) {
  std::string html =
      fmt::format("<li><b>{}<small>/{}</small></b>runs complete</li>", c.answered, c.planned);
  for (const auto& [status, count] : c.statuses)
    html += fmt::format("<li class=\"{}\"><b>{}</b>{}<small>{}</small></li>",
                        is_failure(status) ? "bad" : "", count, status_meaning(status),
                        name_of(status));
  return "<ul class=tiles>" + html + "</ul>";
}

std::string marks_html(const OptimizerAxis& axis) {
  std::string marks;
  if (!axis.privileges.empty())
    marks = fmt::format("<sup><a href=\"#privileges\" title=\"given: {}\">†</a></sup>",
                        html_text(joined(axis.privileges)));
  if (axis.is_imported) marks += "<sup title=\"imported: by its own figures\">§</sup>";
  return marks;
}

// Who stands where, a dot a method with its interval; and what each took on each problem, the best
// of each kind first. Scripts redraw both for another tolerance or measure.

namespace {

std::string name_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return fmt::format("<a href=\"#optimizer-{}\">{}{}</a>{}", s, swatch(),
                     html_text(optimizer_name(optimizer)), marks_html(optimizer));
}

// Its score as a dot on a track from 0 to 1, with the interval where problems are enough for one.
std::string track(Real score, const Interval& interval) {
  const bool is_told = std::isfinite(interval.low) && std::isfinite(interval.high);
  return fmt::format(
      "<td class=track><i style=\"--at:{:.4f}{}\"></i>", score,
      is_told ? fmt::format(";--low:{:.4f};--high:{:.4f}", interval.low, interval.high) : "");
}

std::string standing_row(const Comparison& c, std::size_t s, const Interval& interval) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  const Standing& standing = optimizer.tightest();
  return fmt::format(
      "<tr data-s={}{}><td>{}<th scope=row>{}{}<td>{:.3f}<td>{}<small>/{}</small>"
      "<td>{}<td>{}<td>{}<small>/{}</small><td{}>{}\n",
      s, s < kShownAtFirst ? "" : " class=rest", c.order.has(s) ? std::to_string(s + 1) : "–",
      name_html(c, s), track(standing.score, interval), standing.score, standing.solved,
      standing.settings, standing.wins == 0 ? "·" : std::to_string(standing.wins),
      standing.typical == kNever ? "✗" : fmt::format("{:.3g}×", standing.typical), standing.reached,
      standing.runs, optimizer.failed > 0 ? " class=lost" : "",
      optimizer.failed == 0 ? "·" : std::to_string(optimizer.failed));
}

// How far from the best, as a class of the style sheet: h0 the least, then by factors of two.
std::string heat_class(Real value, Real least, Real unit) {
  return fmt::format("h{}", shade_of(std::max(value, unit), std::max(least, unit)));
}

std::string work_cell(const Comparison& c, const Cell& cell, std::size_t p, Real least) {
  if (cell.planned == 0) return fmt::format("<td data-p={} class=none>", p);
  if (cell.runs.empty()) return fmt::format("<td data-p={} class=lost>missing", p);
  if (!cell.is_measured()) return fmt::format("<td data-p={} class=na>n/a", p);
  const Spread& work = cell.headline[kTightest];
  const bool is_partial = work.unsolved > 0 && work.unsolved < work.n;
  const bool is_told = is_partial || cell.failed > 0 || cell.planned > cell.runs.size();
  const std::string count =
      is_told ? fmt::format("<small>{}</small>", count_text(cell, kTightest)) : "";
  if (!work.is_solved()) return fmt::format("<td data-p={} class=no>✗{}", p, count);
  const std::string heat = heat_class(work.median, least, least_unit(c.yardstick.by));
  return fmt::format("<td data-p={} class={}>{}{}", p,
                     cell.is_best[kTightest] ? "\"h0 best\"" : heat,
                     matrix_text(c, cell, kTightest), count);
}

using Learned = std::map<std::size_t, EqualWork>;  // by problem

// The error in x of a learned problem at equal work.
std::string learned_cell(const Comparison& c, const EqualWork& equal, std::size_t p,
                         std::size_t s) {
  if (!equal.methods[s]) return work_cell(c, c.cell(p, s), p, 0);
  const Spread& error = equal.methods[s]->x_error;
  if (!error.is_solved()) return fmt::format("<td data-p={} class=no>✗", p);
  const Real least = equal.least_x_error();
  return fmt::format("<td data-p={} class={}>{}", p,
                     error.median == least ? "\"h0 best\"" : heat_class(error.median, least, 0),
                     figure(error.median));
}

// Problems by group, in the order in which the columns stand.
std::vector<std::pair<std::string, std::vector<std::size_t>>> columns_of(const Comparison& c) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> groups;
  for (const char* group : {"toy", "physics", "classical", "other", "learned"}) {
    std::vector<std::size_t> problems;
    for (std::size_t p = 0; p < c.problems.size(); ++p)
      if (c.problems[p].group() == group) problems.push_back(p);
    if (!problems.empty()) groups.emplace_back(group, problems);
  }
  return groups;
}

std::string heat_head(const Comparison& c) {
  std::string groups = "<tr><th rowspan=2 scope=col>optimizer<th rowspan=2 scope=col>solved", names;
  for (const auto& [group, problems] : columns_of(c)) {
    groups += fmt::format("<th class=group scope=colgroup colspan={}>{}", problems.size(),
                          group == "learned" ? "learned: error in x" : group);
    for (const std::size_t p : problems)
      names += fmt::format("<th scope=col data-p={0}><a href=\"#problem-{0}\"><span>{1}</span></a>",
                           p, html_text(problem_name(c.problems[p])));
  }
  return "<thead>" + groups + "<tr>" + names + "<tbody>\n";
}

Real least_work(const Comparison& c, std::size_t problem) {
  Real least = kNever;
  for (const Cell& cell : c.cells[problem])
    least = std::min(least, cell.headline[kTightest].median);
  return least;
}

// By rank; where all is learned, by how often each is nearest in x at equal work.
std::vector<std::size_t> best_first(const Comparison& c, const Learned& learned) {
  std::vector<std::size_t> order, nearest(c.optimizers.size(), 0);
  for (const auto& [problem, equal] : learned)
    if (const auto ranked = equal.nearest_first(); !ranked.empty()) ++nearest[ranked.front()];
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) order.push_back(s);
  if (is_all_learned(c))
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](std::size_t s) { return nearest[s]; });
  return order;
}

// By kind, those with the best method first; best first within.
std::vector<std::size_t> by_kind(const Comparison& c, const Learned& learned) {
  std::vector<std::size_t> order = best_first(c, learned);
  std::map<std::string, std::size_t> first;
  for (std::size_t place = 0; place < order.size(); ++place)
    first.emplace(c.optimizers[order[place]].mathematics(), place);
  std::ranges::stable_sort(order, {},
                           [&](std::size_t s) { return first.at(c.optimizers[s].mathematics()); });
  return order;
}

// A button that shows the rows of class `rest`; empty where there are none.
std::string more_button(const std::string& table, std::size_t all, std::size_t shown) {
  if (all <= shown) return "";
  return fmt::format(
      "<p><button class=more type=button data-table={} data-less=\"the first {}\" hidden>all "
      "{}</button></p>",
      table, shown, all);
}

}  // namespace

std::string standings_html(const Comparison& c, const std::vector<Interval>& intervals) {
  std::string html = fmt::format(
      "<table class=\"standings sortable folded\" id=standings-table><caption>Standings to {} by "
      "{}</caption>"
      "<thead><tr><th scope=col>#<th scope=col>optimizer<th scope=col>score, 0 to 1"
      "<th scope=col>score<th scope=col>{}s solved<th scope=col>best on<th scope=col>× least"
      "<th scope=col>runs<th scope=col>failed<tbody>\n",
      tau_name(c), counted_name(c), common_noun(c));
  std::size_t rows = 0;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    if (c.optimizers[s].tightest().settings == 0) continue;  // it learns alone
    html += standing_row(c, s, intervals[s]);
    ++rows;
  }
  if (rows == 0 || is_all_learned(c))
    return "<p class=lead>Nothing here is ranked by work: what was learned is told by its error in "
           "x.</p>";
  return html + "</table>" + more_button("standings-table", rows, kShownAtFirst);
}

std::string heat_html(const Comparison& c) {
  std::vector<Real> least;
  Learned learned;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    least.push_back(least_work(c, p));
    if (c.problems[p].is_learned) learned.emplace(p, equal_work(c, p));
  }
  std::string html = fmt::format(
      "<table class=\"matrix folded\" id=heat><caption>Median {}; of learned problems the error in x "
      "at equal work</caption>",
      counted_to_tau(c));
  html += heat_head(c);
  std::string kind;
  std::size_t kinds = 0;
  for (const std::size_t s : by_kind(c, learned)) {
    const OptimizerAxis& optimizer = c.optimizers[s];
    const bool is_first = optimizer.mathematics() != std::exchange(kind, optimizer.mathematics());
    kinds += is_first;
    html += fmt::format("<tr data-s={}{}><th scope=row>{}{}<td class=solved>{}<small>/{}</small>",
                        s, is_first ? "" : " class=rest", name_html(c, s),
                        is_first ? fmt::format("<small>{}</small>", kind_title(kind)) : "",
                        optimizer.tightest().solved, optimizer.tightest().settings);
    for (const auto& [group, problems] : columns_of(c))
      for (const std::size_t p : problems)
        html += c.problems[p].is_learned ? learned_cell(c, learned.at(p), p, s)
                                         : work_cell(c, c.cell(p, s), p, least[p]);
    html += "\n";
  }
  return html + "</table>" + more_button("heat", c.optimizers.size(), kinds);
}

}  // namespace isoline::reports
