// One article per optimizer and problem: formula, requirements, options, wins and failures, with a
// summary.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/json.h"
#include "core/oracle.h"
#include "core/results/contrasts.h"
#include "core/threads.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// A row of the list of facts, if it has a value.
std::string row(const char* term, const std::string& content) {
  return content.empty() ? "" : fmt::format("<dt>{}</dt><dd>{}</dd>", term, content);
}

// The reason why most runs of a cell miss the goal, as a key, and the quantity that decides, its
// median at the end, and its goal.
std::pair<std::string, std::string> shortfall(const Comparison& c, std::size_t p,
                                              const Cell& cell) {
  const Real tau = c.yardstick.tightest().tau, least = c.problems[p].least_goal;
  const bool is_of_x = c.problems[p].aim == Aim::x;
  std::map<std::string, std::size_t> causes;
  std::vector<Real> values;
  for (const std::size_t one : cell.runs) {
    const Record& record = *c.runs[one].record;
    const std::vector<Real> left = losses_left(c.runs[one]);
    const Real gap = left.empty() ? kNever : left.back(),
               value = is_of_x ? record.summary.x_error / record.x_scale.value_or(1) : gap;
    values.push_back(value);
    if (value <= std::max(tau, is_of_x ? least : 0)) continue;
    ++causes[is_of_x && gap <= tau               ? "deed.undetermined"
             : record.status == Status::diverged ? "deed.diverged"
             : record.status == Status::budget || record.status == Status::running ? "deed.budget"
             : record.status == Status::converged                                  ? "deed.minimum"
                                                  : "deed.stalled"];
  }
  const auto most =
      std::ranges::max_element(causes, {}, [](const auto& one) { return one.second; });
  const Real middle = median_of(values);
  return {most == causes.end() ? "deed.stalled" : most->first,
          is_of_x ? words("deed.error", figure(middle), figure(std::max(tau, least)))
                  : words("deed.gap", figure(middle), figure(tau))};
}

// The problems of a method by their results, each list in the order of the problems.
std::string deeds_html(const Comparison& c, std::size_t s) {
  std::string won, failed, inapplicable;
  std::map<std::string, std::string> unsolved;  // by cause
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Cell& cell = c.cell(p, s);
    const auto add = [&](std::string& list, const std::string& remark) {
      list += fmt::format("<li data-p={0}><a href=\"#problem-{0}\">{1}</a>{2}</li>", p,
                          html_text(problem_name(c.problems[p])),
                          remark.empty() ? "" : " <small>" + html_text(remark) + "</small>");
    };
    if (cell.runs.empty()) continue;
    if (!cell.is_measured()) {
      add(inapplicable, cell.inapplicable);
      continue;
    }
    const Spread& work = cell.headline[kTightest];
    if (cell.is_best[kTightest]) add(won, amount_in_units(c, work.median));
    if (cell.failed > 0) {
      std::string message;  // of the last
      for (const std::size_t run : cell.runs)
        if (is_failure(c.runs[run].record->status)) message = c.runs[run].record->message;
      add(failed, fmt::format("{} of {} runs: {}", cell.failed, cell.runs.size(), message));
    } else if (!work.is_solved() && !c.problems[p].lacks_least_loss() &&
               !c.problems[p].is_learned) {
      const auto [cause, text] = shortfall(c, p, cell);
      add(unsolved[cause], text);
    }
  }
  std::string html;
  for (const auto& [term, items] : {std::pair("least work on", &won),
                                    {"failed on", &failed},
                                    {"not applicable to", &inapplicable}})
    if (!items->empty()) html += row(term, "<ul>" + *items + "</ul>");
  for (const auto& [cause, items] : unsolved)
    html += row(words("deed.unsolved", words(cause)).c_str(), "<ul>" + items + "</ul>");
  return html;
}

// "0.01", or "0.001 to 14.7, 9 values" where a table of rates or a sweep chose by problem.
std::string values_of(const Comparison& c, std::size_t s, const std::string& option) {
  std::set<OptionValue> values;
  for (const auto& problem : c.cells)
    for (const std::size_t run : problem[s].runs)
      if (const auto* at = c.runs[run].record->request.optimizer.options.find(option))
        values.insert(*at);
  std::vector<std::string> texts;
  for (const OptionValue& value : values) {
    const Real* const number = std::get_if<Real>(&value);
    const Index* const count = std::get_if<Index>(&value);
    texts.push_back(number != nullptr  ? figure(*number)
                    : count != nullptr ? figure(Real(*count))
                                       : option_text(value));
  }
  const bool are_numbers = !values.empty() && values.begin()->index() < 2;
  if (texts.size() < 2 || !are_numbers) return joined(texts);
  return fmt::format("{} to {}, {} values", texts.front(), texts.back(), texts.size());
}

// "3rd to 5th of 36 on the 17 settings that all ranked methods ran on", or that it is not ranked.
// Scores within the margin of its own do not tell the methods apart.
std::string place_text(const Comparison& c, std::size_t s) {
  if (!c.order.has(s))
    return words("deed.not-ranked", counted(c.order.settings.size(), common_noun(c)));
  const Real own = c.optimizers[s].tightest().score;
  const auto above = [&](Real score) {
    const auto is_above = [&](std::size_t other) {
      return c.optimizers[other].tightest().score > score;
    };
    return static_cast<std::size_t>(std::ranges::count_if(c.order.methods, is_above));
  };
  const Real margin = results::score_margin();
  const std::size_t first = 1 + above(own + margin), last = above(own - margin);
  return fmt::format("{}{} of {} on the {} common to all ranked methods", ordinal(first),
                     last > first ? " to " + ordinal(last) : "", c.order.methods.size(),
                     counted(c.order.settings.size(), common_noun(c)));
}

// A summary of its values.
std::string reading(const Comparison& c, std::size_t s) {
  const OptimizerAxis& axis = c.optimizers[s];
  const std::vector<Ranked> beside = standings_beside(c, s);
  const auto own = std::ranges::find(beside, s, &Ranked::optimizer);
  const Standing& standing = own == beside.end() ? axis.tightest() : own->standing;
  if (axis.runs == 0)
    return axis.applicable == 0 ? "This method is not applicable to any of these problems." : "";
  if (standing.settings == 0) return place_text(c, s) + ".";
  std::string text = fmt::format("{}: solves {} of {} to {}", place_text(c, s), standing.solved,
                                 standing.settings, tau_name(c));
  if (standing.typical < kNever)
    text += fmt::format(", with a median slowdown of {:.3g} over all of these (unsolved: infinite)",
                        standing.typical);
  if (standing.runs == 0) return text + "; it was not applicable to any of these.";
  return text +
         fmt::format(
             "; {} of {} runs reach this tolerance{}.", standing.reached, standing.runs,
             axis.failed > 0 ? "; " + counted(axis.failed, "run") + " on any problem failed" : "");
}

std::string optimizer_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& axis = c.optimizers[s];
  return fmt::format(
      "<article class=\"optimizer one\" id=optimizer-{0} data-s={0}><noscript><h3>{1}{2}</h3>{3}{4}{5}"
      "</noscript></article>\n",
      s, html_text(shown_spec(axis.label)), marks_html(axis), sheet_html(axis.sheet),
      method_facts_html(c, s), axis.sheet == nullptr ? "" : options_html(c, s, *axis.sheet));
}

}  // namespace

std::string sheet_html(const Sheet* sheet, const std::string& facts) {
  if (sheet == nullptr) return "";
  std::string html = fmt::format("<p class=about>{} <cite>{}</cite>{}</p><p class=formula>{}</p>",
                                 html_text(sheet->title), html_text(sheet->source),
                                 html_text(facts), html_text(sheet->formula));
  if (!sheet->note.empty()) html += fmt::format("<p class=note>{}</p>", html_text(sheet->note));
  return html;
}

std::string options_html(const Comparison& c, std::size_t s, const Sheet& sheet) {
  const Json options =
      sheet.options_text.empty() ? Json() : parse_json(sheet.options_text, "sheet");
  if (!options.is_array() || options.empty()) return "";
  const auto text_at = [](const Json& option, const char* key) {
    const auto at = option.find(key);
    if (at == option.end()) return std::string();
    return at->is_string()   ? at->get<std::string>()
           : at->is_number() ? figure(at->get<Real>())
                             : json_text(*at);
  };
  std::string rows;
  for (const Json& option : options)
    rows += fmt::format("<tr><th scope=row>{}<td>{}<td>{}<td class=text>{}<td class=text>{}\n",
                        html_text(text_at(option, "name")), html_text(text_at(option, "default")),
                        html_text(values_of(c, s, text_at(option, "name"))),
                        html_text(text_at(option, "doc")), html_text(text_at(option, "range")));
  return fmt::format(
      "<details><summary>Options</summary><div class=scroll tabindex=0 role=group "
      "aria-label=\"Options of {}\"><table><thead><tr><th scope=col>option<th scope=col>default"
      "<th scope=col>in these runs<th scope=col>meaning<th scope=col>range<tbody>{}</table>"
      "</div></details>",
      html_text(sheet.name), rows);
}

std::string method_facts_html(const Comparison& c, std::size_t s) {
  const OptimizerAxis& axis = c.optimizers[s];
  std::string html = "<p class=reading>" + html_text(reading(c, s)) + "</p><dl>";
  html += row("kind", kind_title(axis.mathematics()));
  html += row("required derivatives", html_text(counted_oracles(c, s)));
  if (!axis.privileges.empty())
    html += row("extra information",
                "<span class=privilege>" + html_text(joined(axis.privileges)) + "</span>");
  return html + deeds_html(c, s) + "</dl>";
}

std::string counted_oracles(const Comparison& c, std::size_t s) {
  std::array<std::size_t, kOracles> asked{};  // problems on which a run called the oracle
  std::size_t all = 0;
  for (const auto& problem : c.cells) {
    if (!problem[s].is_measured()) continue;
    ++all;
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      asked[kind] += std::ranges::any_of(
          problem[s].runs, [&](std::size_t run) { return c.runs[run].record->counts[kind] > 0; });
  }
  std::vector<std::string> words;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (asked[kind] > 0)
      words.push_back(std::string(kOracleNames[kind]) +
                      (asked[kind] < all ? fmt::format(" (on {} of {})", asked[kind], all) : ""));
  return joined(words);
}

std::string optimizers_html(const Comparison& c) {
  std::string html;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) html += optimizer_html(c, s);
  return html;
}

// One section per problem: its formula, the work to solve it, and places for curves and paths.

namespace {

std::string facts_text(const Sheet& sheet) {
  std::string facts = " · ";
  if (sheet.unknowns > 0)
    facts += fmt::format("{} unknown{}, ", sheet.unknowns, sheet.unknowns == 1 ? "" : "s");
  if (sheet.residuals > 0)
    facts += fmt::format("{} residual{}, ", sheet.residuals, sheet.residuals == 1 ? "" : "s");
  std::vector<std::string> conditions;  // of J, where they are known
  const auto add = [&](const std::optional<Real>& condition, const char* where) {
    if (condition)
      conditions.push_back((std::isfinite(*condition) ? figure(*condition) : "∞") + where);
  };
  add(sheet.start_condition, " at the start");
  add(sheet.condition, " at the solution");
  if (!conditions.empty()) facts += fmt::format("condition number of J {}, ", joined(conditions));
  const bool has_inverse = !sheet.inverse.empty() && sheet.inverse != "none";
  return facts + (has_inverse ? sheet.inverse : "no") + " inverse";
}

}  // namespace

std::string problem_sheet_html(const ProblemAxis& problem) {
  return sheet_html(problem.sheet, problem.sheet == nullptr ? "" : facts_text(*problem.sheet));
}

namespace {

std::string problem_html(const Comparison& c, std::size_t p,
                         const std::optional<FoundFields>& fields) {
  const ProblemAxis& problem = c.problems[p];
  return fmt::format(
             "<article class=\"problem one\" id=problem-{0} data-p={0}><noscript><h3>{1}</h3>{2}"
             "<p class=reading>{3}</p><div class=solve><div class=curves>{4}</div><div "
             "class=reached></div></div>",
             p, html_text(problem_name(problem)), problem_sheet_html(problem),
             prose_html(curve_reading(c, p)), curves_html(c, p)) +
         planes_html(c, p) + (fields ? fields_html(c, *fields) : "") + "</noscript></article>\n";
}

}  // namespace

// Rows of links, one per group.
std::string problems_html(const Comparison& c, const AllFields& fields) {
  std::vector<std::string> articles(c.problems.size());
  share(articles.size(), [&](std::size_t p) { articles[p] = problem_html(c, p, fields[p]); });
  std::map<std::string, std::string> groups;
  std::string index, html;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    groups[c.problems[p].group()] += fmt::format("<a href=\"#problem-{0}\" data-p={0}>{1}</a>\n", p,
                                                 html_text(problem_name(c.problems[p])));
    html += articles[p];
  }
  for (const char* group : {"toy", "physics", "classical", "learned", "other"})
    if (groups.contains(group))
      index += fmt::format("<p class=index><b>{}</b> {}</p>", group, groups[group]);
  return index + html;
}

}  // namespace isoline::reports
