// Words, tables and plots of the decision which methods are best.
#include "reports/sections/ranking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Real doublings_of(Real a, Real b) {
  const Real most = std::log2(kProfileEnd);
  if (a == kNever && b == kNever) return 0;
  if (a == kNever || b == kNever) return a == kNever ? most : -most;
  return std::clamp(std::log2(std::max(a, 1.0)) - std::log2(std::max(b, 1.0)), -most, most);
}

// "gauss-newton, adam and 3 more"
std::string names_text(const Comparison& c, const std::vector<std::size_t>& methods,
                       std::size_t most) {
  std::vector<std::string> names;
  for (const std::size_t s : methods)
    if (names.size() < most) names.push_back(optimizer_text(c, s));
  if (methods.size() > most)
    return fmt::format("{} and {} more", joined(names), methods.size() - most);
  return joined(names);
}

// "19 test problems (5 from physics, at most 64 unknowns; 3 starting points each)"
std::string settings_text(const Comparison& c) {
  std::size_t physics = 0;
  Index unknowns = 0;
  for (const std::size_t p : c.order.settings) {
    physics += c.problems[p].group() == "physics";
    if (const Sheet* sheet = c.problems[p].sheet) unknowns = std::max(unknowns, sheet->unknowns);
  }
  const std::size_t settings = c.order.settings.size(), names = names_of(c, c.order);
  std::string text = counted(settings, "test problem");
  if (names < settings)
    text = fmt::format("{} of {}", counted(settings, "setting"), counted(names, "test problem"));
  std::vector<std::string> parts;
  if (physics > 0) parts.push_back(fmt::format("{} from physics", physics));
  if (unknowns > 0)
    parts.push_back(fmt::format("at most {}", counted(std::size_t(unknowns), "unknown")));
  std::string about = joined(parts);
  if (c.seeds.size() > 1)
    about += fmt::format("{}{} starting points each", about.empty() ? "" : "; ", c.seeds.size());
  return text + (about.empty() ? "" : " (" + about + ")");
}

// "gauss-newton (score 0.70; solves 15)"
std::string score_text(const Comparison& c, const results::Place& place,
                       const std::string& more = "") {
  return fmt::format("{} (score {:.2f}; solves {}{})", optimizer_text(c, place.method), place.score,
                     place.solved, more);
}

// The best of those whose difference from the first is not significant by itself; else the second.
const results::Place& nearest_rival(const Decision& decision) {
  const auto open =
      std::ranges::find_if(decision.places.begin() + 1, decision.places.end(),
                           [](const results::Place& place) { return place.p > kSignificant; });
  return open == decision.places.end() ? decision.places[1] : *open;
}

// By wall time another method is first.
bool differs_by_time(const Decision& decision) {
  return std::ranges::any_of(decision.choices, [](const Choice& choice) {
    return choice.varied == Varied::measure && choice.value == name_of(Measure::time) &&
           !choice.is_kept;
  });
}

std::string decision_sentence(const Comparison& c, const Decision& decision) {
  const results::Place& first = decision.places[0];
  const std::string on = fmt::format("On {}", settings_text(c)),
                    in = fmt::format("in {} to {}", counted_name(c), tau_name(c));
  std::string text;
  if (decision.places.size() == 1) {
    text = fmt::format("{} {} alone was run on all: no method to compare it with.", on,
                       score_text(c, first));
  } else if (decision.tied > 1) {
    std::vector<std::size_t> tied;
    for (std::size_t i = 0; i < decision.tied; ++i) tied.push_back(decision.places[i].method);
    text = fmt::format("{} {} are tied for the highest performance-profile score {} ({:.2f}).", on,
                       names_text(c, tied, 3), in, first.score);
  } else {
    const results::Place& rival = nearest_rival(decision);
    const std::string test = fmt::format("; paired permutation test, p = {:.2g}", rival.p);
    text = decision.is_lead ? fmt::format("{} {} is significantly best {}; next is {}.", on,
                                          score_text(c, first), in, score_text(c, rival, test))
                            : fmt::format(
                                  "{} no method is significantly best {}. {} has the highest "
                                  "performance-profile score, not significantly different from {}.",
                                  on, in, score_text(c, first), score_text(c, rival, test));
  }
  return text + (differs_by_time(decision) ? " By wall time others lead." : "");
}

std::string group_text(const Comparison& c, const Decision& decision) {
  constexpr std::size_t kNamed = 6;
  const std::vector<std::size_t> group = decision.group();
  return fmt::format("{} ({} of {} ranked methods; 95 % confidence set of the best).",
                     names_text(c, group, kNamed), group.size(), decision.places.size());
}

std::string robustness_text(const Comparison& c, const Decision& decision) {
  constexpr std::size_t kNamed = 3;
  std::vector<results::Place> often = decision.places;
  std::ranges::stable_sort(often, std::ranges::greater{}, &results::Place::share_first);
  const auto is_first = [&](const results::Place& place) {
    return place.method == decision.places[0].method;
  };
  std::string text = fmt::format("{} ranks first in {} of bootstrap samples",
                                 optimizer_text(c, decision.places[0].method),
                                 percent(decision.places[0].share_first));
  if (const auto other = std::ranges::find_if_not(often, is_first);
      other != often.end() && other->share_first > 0)
    text +=
        fmt::format(" ({} in {})", optimizer_text(c, other->method), percent(other->share_first));
  std::vector<std::string> lost;
  std::size_t kept = 0;
  for (const Choice& choice : decision.choices) {
    kept += choice.is_kept;
    if (!choice.is_kept && !choice.first.empty())
      lost.push_back(fmt::format("{} {}", names_text(c, choice.first, 1), choice_text(choice)));
  }
  text += fmt::format(" and under {} of {} other choices of accuracy, measure, problems and seeds",
                      kept, decision.choices.size());
  const std::size_t more = lost.size() > kNamed ? lost.size() - kNamed : 0;
  lost.resize(lost.size() - more);
  if (!lost.empty())
    text += fmt::format("; first otherwise: {}{}", joined(lost),
                        more > 0 ? fmt::format(" and {} more", more) : "");
  return text + ".";
}

std::string not_run(const Comparison& c) {
  std::size_t pairs = 0, never = 0, inapplicable = 0;
  for (const auto& row : c.cells)
    for (std::size_t s = 0; s < row.size(); ++s) {
      if (c.optimizers[s].applicable == 0) continue;
      ++pairs;
      never += row[s].planned == 0;
      inapplicable += !row[s].inapplicable.empty();
    }
  if (never == 0 && inapplicable == 0 && c.missing.empty())
    return fmt::format("Nothing: all {} pairs of method and problem ran.", pairs);
  std::string text =
      fmt::format("Pairs of method and problem: {} in total, {} not planned, {} not applicable",
                  pairs, never, inapplicable);
  if (!c.missing.empty())
    text += fmt::format("; {} planned {} missing", counted(c.missing.size(), "run"),
                        c.missing.size() == 1 ? "is" : "are");
  return text + ".";
}

// With few problems no ranking over them is reported, but one on each.
std::vector<std::string> problem_sentences(const Comparison& c) {
  constexpr std::size_t kFew = 4;
  std::vector<std::string> all;
  for (std::size_t p = 0; p < c.problems.size() && p < kFew; ++p)
    all.push_back(fmt::format("{}: {}", problem_name(c.problems[p]), curve_reading(c, p)));
  return all;
}

// The settings common to all ranked methods that this one was run on.
std::vector<std::size_t> shared_with(const Comparison& c, std::size_t optimizer) {
  std::vector<std::size_t> settings;
  for (const std::size_t p : c.order.settings)
    if (c.cell(p, optimizer).planned > 0) settings.push_back(p);
  return settings;
}

std::vector<std::size_t> unranked(const Comparison& c) {
  std::vector<std::size_t> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (const std::size_t shared = shared_with(c, s).size();
        c.optimizers[s].applicable > 0 && shared > 0 && shared < c.order.settings.size())
      all.push_back(s);
  return all;
}

}  // namespace

Real Pairing::typical() const { return doublings.empty() ? 1 : std::exp2(-median_of(doublings)); }

std::array<Real, 2> Pairing::interval() const {
  const MedianInterval interval = median_interval(doublings);
  return {std::exp2(-interval.high), std::exp2(-interval.low)};
}

Pairing pairing_of(const Costs& costs, const Families& families, std::size_t a, std::size_t b) {
  Pairing pairing;
  for (const auto& rows : families) {
    std::vector<Real> values;
    bool is_solved = false;
    for (const std::size_t row : rows) {
      const auto &mine = costs[row][a], &other = costs[row][b];
      if (!mine || !other) continue;
      is_solved = is_solved || *mine < kNever || *other < kNever;
      values.push_back(doublings_of(*mine, *other));
    }
    if (values.empty()) continue;
    pairing.neither += !is_solved;
    if (!is_solved) continue;
    const Real middle = median_of(std::move(values));
    pairing.doublings.push_back(middle);
    ++(middle < 0 ? pairing.wins : middle > 0 ? pairing.losses : pairing.ties);
  }
  return pairing;
}

std::vector<MethodPair> all_pairs(const Comparison& c) {
  Costs costs = median_costs(c, kTightest);
  for (std::size_t p = 0; p < costs.size(); ++p)
    if (!is_ordered(c, p)) costs[p].assign(costs[p].size(), std::nullopt);
  Families families;
  for (const auto& [name, problems] : problems_by_name(c)) families.push_back(problems);
  std::vector<MethodPair> all;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = a + 1; b < c.optimizers.size(); ++b)
      all.push_back({a, b, pairing_of(costs, families, a, b)});
  return all;
}

std::string choice_text(const Choice& choice) {
  switch (choice.varied) {
    case Varied::profile_end:
      return "with profile end " + choice.value;
    case Varied::tolerance:
      return "to accuracy " + choice.value;
    case Varied::measure:
      return fmt::format("by {}", counted_name(measure_of(choice.value).value_or(Measure::work)));
    case Varied::family:
      return "without " + choice.value;
    case Varied::seed:
      return "with seed " + choice.value;
  }
  return choice.value;
}

std::vector<std::string> verdict(const Comparison& c) {
  if (is_all_learned(c) && !c.problems.empty()) return learned_sentences(c);
  const bool is_any_solved = std::ranges::any_of(c.cells, [](const auto& row) {
    return std::ranges::any_of(
        row, [](const Cell& cell) { return cell.headline[kTightest].is_solved(); });
  });
  if (!is_any_solved)
    return {fmt::format("No optimizer solves any of the problems to {}.", tau_name(c))};
  if (!has_order(c) || !c.decision) return problem_sentences(c);
  std::vector<std::string> all = {
      decision_sentence(c, *c.decision),
      "Not significantly worse than the best: " + group_text(c, *c.decision),
      robustness_text(c, *c.decision)};
  if (c.open_decision && c.open_decision->places[0].method != c.decision->places[0].method)
    all.push_back("Among the methods without extra information: " +
                  decision_sentence(c, *c.open_decision));
  if (c.yardstick.by == Measure::time && c.is_any_timed_together)
    all.push_back(
        "Some of these times were taken while other runs shared the machine, and are marked ≈: a "
        "ranking by them is not evidence. Runs with --exclusive are timed alone.");
  all.push_back(unranked_sentence(c));
  for (std::string& sentence : learned_sentences(c)) all.push_back(std::move(sentence));
  std::erase(all, "");
  return all;
}

std::string short_verdict(const Comparison& c) {
  const std::vector<std::string> sentences = verdict(c);
  return sentences.empty() ? "" : sentences[0];
}

std::vector<Reading> ranking_facts(const Comparison& c) {
  std::vector<Reading> facts;
  if (has_order(c) && c.decision)
    facts = {{"Not significantly worse than the best", group_text(c, *c.decision)},
             {"Robustness", robustness_text(c, *c.decision)}};
  else
    facts = {{"Ranking", "None: too few problems were solved or shared by all methods."}};
  facts.push_back({"Not run", not_run(c)});
  return facts;
}

std::string unranked_sentence(const Comparison& c) {
  std::vector<std::string> names;
  for (const std::size_t s : unranked(c))
    names.push_back(
        fmt::format("{} ({})", shown_spec(c.optimizers[s].label), shared_with(c, s).size()));
  if (names.empty()) return "";
  return fmt::format("Not ranked, since they were not run on all {}: {}.",
                     counted(c.order.settings.size(), common_noun(c)), joined(names));
}

std::vector<Interval> score_intervals(const Comparison& c) {
  std::vector<Interval> all(c.optimizers.size());
  if (!c.decision) return all;
  for (const results::Place& place : c.decision->places) all[place.method] = place.interval;
  return all;
}

namespace {

std::string typical_text(const Standing& standing) {
  return standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical);
}

Table ranking_table(const Comparison& c) {
  const std::string legend = marks_legend(c);
  Table table{
      .id = "standings-table",
      .caption = fmt::format(
          "Methods that were run on the same {}, ranked by their performance profiles; equal "
          "scores "
          "share a place. Bold: not significantly worse than the best. Solved: {}s whose median "
          "run "
          "reaches the tolerance. Wins: problems with the least {} of these methods. Median "
          "slowdown: the median of its {} over the least, in logarithms; ✗ if it solves fewer "
          "than half. Runs: those that "
          "reach it. Failed: errors, crashes, time or memory limits, on all its problems.{}",
          counted(c.order.settings.size(), common_noun(c)), common_noun(c), counted_name(c),
          counted_name(c), legend.empty() ? "" : " " + legend),
      .columns = {"", "optimizer", "solved", "wins", "median slowdown", "runs", "failed"},
      .align = "rlrrrrrrr",
      .names = 2};
  for (std::size_t t = kTightest; t-- > 0;)
    table.columns.push_back(fmt::format("to {}", c.yardstick.tolerances[t].name));
  std::size_t rank = 0;
  for (std::size_t i = 0; i < c.order.methods.size(); ++i) {
    const std::size_t s = c.order.methods[i];
    const OptimizerAxis& axis = c.optimizers[s];
    const Standing& standing = axis.tightest();
    const bool is_tied = i > 0 && are_tied(standing.score, c.optimizers[s - 1].tightest().score);
    if (!is_tied) rank = i + 1;
    TableCell name(optimizer_text(c, s));
    const results::Place* place = c.decision ? c.decision->place_of(s) : nullptr;
    name.is_best = place != nullptr && place->is_in_group;
    table.rows.push_back(
        {std::to_string(rank), name, fmt::format("{}/{}", standing.solved, standing.settings),
         std::to_string(standing.wins), typical_text(standing),
         fmt::format("{}/{}", standing.reached, standing.runs), std::to_string(axis.failed)});
    for (std::size_t t = kTightest; t-- > 0;)
      table.rows.back().emplace_back(std::to_string(axis.standings[t].solved));
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

Table unranked_table(const Comparison& c) {
  Table table{.id = "apart-table",
              .title = "Not ranked with the others",
              .caption = fmt::format("Methods that were run on some of the {} only.",
                                     counted(c.order.settings.size(), common_noun(c))),
              .columns = {"optimizer", n_column(c), "solved"},
              .align = "lrr"};
  for (const std::size_t s : unranked(c)) {
    const std::vector<std::size_t> settings = shared_with(c, s);
    const auto solved = std::ranges::count_if(
        settings, [&](std::size_t p) { return c.cell(p, s).headline[kTightest].is_solved(); });
    table.rows.push_back({optimizer_text(c, s), count_cell(settings.size()),
                          count_cell(static_cast<std::size_t>(solved))});
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

}  // namespace

Section standings_section(const Comparison& c) {
  Section section{.id = "standings", .title = fmt::format("Ranking to {}", tau_name(c))};
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  if (!c.order.settings.empty()) section.tables.push_back(ranking_table(c));
  if (!unranked(c).empty()) section.tables.push_back(unranked_table(c));
  return section;
}

// The first against each other method, and how far the decision depends on choices.

namespace {

TableCell number_cell(const char* name, Real value, const char* format = "{:.3g}") {
  return {fmt::format(fmt::runtime(format), value), {{name, value}}};
}

}  // namespace

Table leader_table(const Comparison& c) {
  Table table{
      .id = "leader",
      .title = "The first against each of the others",
      .reading = "There is no ranking.",
      .caption = fmt::format(
          "Score: area of the performance profile, with {}. p: of its difference from the first, "
          "two-sided, by flips of the signs of the differences, {}s of one name together. Group: "
          "the "
          "level at which the method leaves the confidence set of the best. First in: share of "
          "bootstrap samples of problems, instances and starts. Work ratio: median {} over that of "
          "the first, on problems that both solve, not limited by the end of the profile.",
          c.decision && c.decision->is_range ? "its range over problems"
                                             : "a 95 % interval over problems",
          setting_noun(c), counted_name(c)),
      .columns = {"optimizer", "score", "interval", "p", "group", "first in", "work ratio",
                  "both solve", "failed"}};
  if (!c.decision) return table;
  for (const results::Place& place : c.decision->places) {
    if (table.rows.size() >= kMostTableRows) break;
    const WorkRatio& ratio = place.ratio;
    table.row_topics.push_back({.optimizer = place.method});
    table.rows.push_back({optimizer_text(c, place.method),
                          number_cell("score", place.score, "{:.3f}"),
                          {fmt::format("{:.3f}–{:.3f}", place.interval.low, place.interval.high),
                           {{"low", place.interval.low}, {"high", place.interval.high}}},
                          number_cell("p", place.p, "{:.2g}"),
                          number_cell("adjusted_p", place.adjusted, "{:.2g}"),
                          {percent(place.share_first), {{"share", place.share_first}}},
                          ratio.both == 0 ? TableCell("") : number_cell("ratio", ratio.median),
                          count_cell(ratio.both),
                          failed_cell(c, place.method)});
  }
  table.reading = decision_sentence(c, *c.decision);
  return table;
}

Table choices_table(const Comparison& c) {
  Table table{.id = "choices",
              .title = "The first under other choices",
              .reading = "There is no ranking.",
              .caption =
                  "The first method under one other choice: the end of the profile, the accuracy, "
                  "the measure, one family of problems left out, or one seed alone.",
              .columns = {"choice", "first"},
              .align = "ll"};
  if (!c.decision) return table;
  for (const Choice& choice : c.decision->choices)
    table.rows.push_back({choice_text(choice), names_text(c, choice.first, 3)});
  table.reading = robustness_text(c, *c.decision);
  return table;
}

std::vector<std::string> limits_of_evidence(const Comparison& c) {
  std::vector<std::string> all;
  if (c.decision && c.decision->places.size() > 1) {
    const Decision& decision = *c.decision;
    all.push_back(fmt::format("Over {} the least p that sign flips can give is {:.2g}.",
                              counted(decision.families, "problem"), decision.least_p));
    if (decision.detectable < kNever)
      all.push_back(fmt::format(
          "A difference of {:.2g} between two scores, as variable as that of the first two, would "
          "be "
          "significant in 80 % of such comparisons.",
          decision.detectable));
  }
  if (c.seeds.size() < kFewestForInterval)
    all.push_back(
        fmt::format("With {} no interval over seeds reaches 95 %: ranges are shown instead.",
                    counted(c.seeds.size(), "seed")));
  all.push_back(
      "These results do not extend to other kinds of problems: the problems were chosen, not "
      "sampled.");
  return all;
}

// The first against the second method, problem by problem: one bar each.
Plots log_ratio_plot(const Comparison& c) {
  if (c.order.methods.size() < 2) return {};
  const Costs costs = common_costs(c, kTightest);
  std::vector<std::pair<Real, std::string>> bars;
  std::size_t run = 0;
  const auto by_name = problems_by_name(c);
  for (const auto& [name, problems] : by_name) {
    const Pairing pairing = pairing_of(costs, {problems}, 0, 1);
    run += !pairing.doublings.empty() || pairing.neither > 0;
    if (!pairing.doublings.empty()) bars.emplace_back(pairing.doublings[0], name);
  }
  if (bars.empty()) return {};
  std::ranges::sort(bars);
  const auto is_less = [](const auto& bar) { return bar.first < 0; };
  const std::string first = optimizer_text(c, 0), second = optimizer_text(c, 1);
  Plot plot{
      .kind = Plot::Kind::bars,
      .id = "plot-log-ratio",
      .title = fmt::format("{} against {}, problem by problem", first, second),
      .reading = fmt::format("{} needs less {} on {} of {}.", first, counted_name(c),
                             std::ranges::count_if(bars, is_less), counted(bars.size(), "problem")),
      .caption = fmt::format(
          "log2 of the ratio of median {} to {}, sorted, of several settings the median: below 0 "
          "{} "
          "needs less, above 0 {}; at ±{:.0f} at least {:.0f} times, or the other never reaches it "
          "(Morales 2002). n = {} problems that both were run on, of which neither solves {}; "
          "failed: {} and {}.",
          counted_name(c), tau_name(c), first, second, std::log2(kProfileEnd), kProfileEnd, run,
          run - bars.size(), failed_cell(c, 0).text, failed_cell(c, 1).text),
      .x_label = "problems",
      .y_label = fmt::format("log2 of the ratio of {}", counted_name(c))};
  PlotSeries series{0, first + " / " + second, {}, {}, {}, {}};
  for (const auto& [ratio, name] : bars) {
    series.x.push_back(Real(plot.rows.size()));
    series.y.push_back(ratio);
    plot.rows.push_back({name, {.problem = by_name.at(name)[0]}});
  }
  plot.series.push_back(std::move(series));
  return {std::move(plot)};
}

}  // namespace isoline::reports
