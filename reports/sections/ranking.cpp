// Which methods rank where and what that is worth: sentences and tables, all of them derived from
// one decision.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/results/statistics.h"
#include "core/seeds.h"
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
  for (const std::size_t s : methods) names.push_back(optimizer_text(c, s));
  return first_of(std::move(names), most);
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
  std::string text = counted(names, "test problem");
  if (names < settings) text = fmt::format("{} of {}", counted(settings, "setting"), text);
  std::vector<std::string> parts;
  if (physics > 0) parts.push_back(fmt::format("{} from physics", physics));
  if (unknowns > 0)
    parts.push_back(fmt::format("at most {}", counted(std::size_t(unknowns), "unknown")));
  std::string about = joined(parts);
  const std::size_t instances = distinct(c.seeds, instance_of);
  const std::size_t starts = distinct(c.seeds, start_of);
  const bool is_crossed = c.seeds.size() > std::max(instances, starts);
  if (c.seeds.size() > 1)
    about += fmt::format("{}{}{} each", about.empty() ? "" : "; ",
                         is_crossed ? counted(instances, "instance") + " and " : "",
                         counted(starts, "starting point"));
  return text + (about.empty() ? "" : " (" + about + ")");
}

std::string decision_sentence(const Comparison& c, const Decision& decision) {
  const auto score_text = [&](const results::Place& place, const std::string& more) {
    return words("ranking.score", optimizer_text(c, place.method), place.score, place.solved, more);
  };
  const results::Place& first = decision.places[0];
  const std::string on = settings_text(c), measure(counted_name(c)), tau = tau_name(c);
  std::string text;
  if (decision.places.size() == 1) {
    text = words("ranking.alone", on, score_text(first, ""));
  } else if (decision.tied > 1) {
    std::vector<std::size_t> tied;
    for (std::size_t i = 0; i < decision.tied; ++i) tied.push_back(decision.places[i].method);
    text = words("ranking.tied", on, names_text(c, tied, 3), measure, tau, first.score);
  } else {
    // The best of those whose difference from the first is not significant by itself.
    const auto open =
        std::find_if(decision.places.begin() + 1, decision.places.end(),
                     [](const results::Place& place) { return place.p > kSignificant; });
    const results::Place& rival = open == decision.places.end() ? decision.places[1] : *open;
    text = words(decision.is_lead ? "ranking.lead" : "ranking.open", on, score_text(first, ""),
                 measure, tau, score_text(rival, words("ranking.test", rival.p)));
  }
  for (const Choice& choice : decision.choices)
    if (choice.varied == Varied::measure && choice.value == name_of(Measure::time) &&
        !choice.is_kept && !choice.first.empty())
      text += " " + words("ranking.by-time", names_text(c, choice.first, 2));
  return text;
}

std::string group_text(const Comparison& c, const Decision& decision) {
  const std::vector<std::size_t> group = decision.group();
  return words("ranking.group", names_text(c, group, 6), group.size(), decision.places.size());
}

std::string robustness_text(const Comparison& c, const Decision& decision) {
  const results::Place& first = decision.places[0];
  const auto share_text = [&](const results::Place& place, const char* between) {
    return optimizer_text(c, place.method) + between + percent(place.share_first);
  };
  std::vector<results::Place> often = decision.places;
  std::ranges::stable_sort(often, std::ranges::greater{}, &results::Place::share_first);
  const auto other = std::ranges::find_if_not(
      often, [&](const results::Place& place) { return place.method == first.method; });
  const bool has_other = other != often.end() && other->share_first > 0;
  std::vector<std::string> lost;
  std::size_t kept = 0;
  for (const Choice& choice : decision.choices) {
    kept += choice.is_kept;
    if (!choice.is_kept && !choice.first.empty())
      lost.push_back(fmt::format("{} {}", names_text(c, choice.first, 1), choice_text(choice)));
  }
  return words("ranking.robustness", share_text(first, " ranks first in "),
               has_other ? fmt::format(" ({})", share_text(*other, " in ")) : "", kept,
               decision.choices.size(),
               lost.empty() ? "" : "; first otherwise: " + first_of(lost, 3));
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
  const std::size_t missing = c.missing.size();
  if (never == 0 && inapplicable == 0 && missing == 0) return words("ranking.all-ran", pairs);
  return words("ranking.not-run", pairs, never, inapplicable,
               missing == 0 ? "" : words("ranking.missing", missing));
}

std::string common_settings(const Comparison& c) {
  return counted(c.order.settings.size(), common_noun(c));
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
  constexpr std::array<const char*, 5> kBefore = {"with profile end ", "to accuracy ", "by ",
                                                  "without ", "with seed "};
  static_assert(static_cast<std::size_t>(Varied::seed) + 1 == kBefore.size());
  const std::string before = kBefore[static_cast<std::size_t>(choice.varied)];
  if (choice.varied != Varied::measure) return before + choice.value;
  return before + std::string(counted_name(measure_of(choice.value).value_or(Measure::work)));
}

std::vector<std::string> verdict(const Comparison& c) {
  if (is_all_learned(c) && !c.problems.empty()) return learned_sentences(c);
  const bool is_any_solved = std::ranges::any_of(c.cells, [](const auto& row) {
    return std::ranges::any_of(
        row, [](const Cell& cell) { return cell.headline[kTightest].is_solved(); });
  });
  if (!is_any_solved) return {words("ranking.none-solved", tau_name(c))};
  std::vector<std::string> all;
  if (!has_order(c) || !c.decision) {  // with few problems: a sentence on each
    constexpr std::size_t kFew = 4;
    for (std::size_t p = 0; p < c.problems.size() && p < kFew; ++p)
      all.push_back(fmt::format("{}: {}", problem_name(c.problems[p]), curve_reading(c, p)));
    return all;
  }
  all = {decision_sentence(c, *c.decision),
         "Not significantly worse than the best: " + group_text(c, *c.decision),
         robustness_text(c, *c.decision)};
  if (c.open_decision && c.open_decision->places[0].method != c.decision->places[0].method)
    all.push_back("Among the methods without extra information: " +
                  decision_sentence(c, *c.open_decision));
  if (c.yardstick.by == Measure::time && c.is_any_timed_together)
    all.push_back(words("ranking.shared-time"));
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
    facts = {{"Ranking", words("ranking.none")}};
  facts.push_back({"Not run", not_run(c)});
  return facts;
}

std::string unranked_sentence(const Comparison& c) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const auto shared = static_cast<std::size_t>(std::ranges::count_if(
        c.order.settings, [&](std::size_t p) { return c.cell(p, s).planned > 0; }));
    if (c.optimizers[s].applicable > 0 && shared > 0 && shared < c.order.settings.size())
      names.push_back(fmt::format("{} ({})", shown_spec(c.optimizers[s].label), shared));
  }
  return names.empty() ? "" : words("ranking.unranked", common_settings(c), joined(names));
}

std::vector<Interval> score_intervals(const Comparison& c) {
  std::vector<Interval> all(c.optimizers.size());
  if (!c.decision) return all;
  for (const results::Place& place : c.decision->places) all[place.method] = place.interval;
  return all;
}

namespace {

Table ranking_table(const Comparison& c) {
  const std::string legend = marks_legend(c);
  Table table = worded_table("standings-table", common_settings(c), common_noun(c), counted_name(c),
                             legend.empty() ? "" : " " + legend);
  table.names = 2;
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
         std::to_string(standing.wins),
         standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical),
         fmt::format("{}/{}", standing.reached, standing.runs), std::to_string(axis.failed)});
    for (std::size_t t = kTightest; t-- > 0;)
      table.rows.back().emplace_back(std::to_string(axis.standings[t].solved));
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

}  // namespace

Section standings_section(const Comparison& c) {
  Section section = worded_section("standings", tau_name(c));
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  if (!c.order.settings.empty()) section.tables.push_back(ranking_table(c));
  return section;
}

// The first against each other method, and how far the decision depends on choices.

Table leader_table(const Comparison& c) {
  const auto number = [](const char* name, Real value, const char* format) -> TableCell {
    return {fmt::format(fmt::runtime(format), value), {{name, value}}};
  };
  Table table = worded_table(
      "leader", words(c.decision && c.decision->is_range ? "leader.range" : "leader.interval"),
      setting_noun(c), counted_name(c));
  table.reading = words("leader.none");
  if (!c.decision) return table;
  for (const results::Place& place : c.decision->places) {
    if (table.rows.size() >= kMostTableRows) break;
    const WorkRatio& ratio = place.ratio;
    const auto [low, high] = place.interval;
    add_row(table, c, place.method,
            {number("score", place.score, "{:.3f}"),
             {fmt::format("{:.3f}–{:.3f}", low, high), {{"low", low}, {"high", high}}},
             number("p", place.p, "{:.2g}"),
             number("adjusted_p", place.adjusted, "{:.2g}"),
             {percent(place.share_first), {{"share", place.share_first}}},
             ratio.both == 0 ? TableCell("") : number("ratio", ratio.median, "{:.3g}"),
             count_cell(ratio.both),
             failed_cell(c, place.method)});
  }
  table.reading = decision_sentence(c, *c.decision);
  return table;
}

Table choices_table(const Comparison& c) {
  Table table = worded_table("choices");
  table.reading = words("leader.none");
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
    const std::string problems = counted(decision.families, "problem");
    all.push_back(words(
        decision.friedman <= kSignificant ? "limits.friedman-differs" : "limits.friedman-equal",
        counted(decision.places.size(), "method"), problems, decision.friedman));
    all.push_back(words("limits.least-p", problems, decision.least_p));
    if (decision.detectable < kNever)
      all.push_back(words("limits.detectable", decision.detectable));
  }
  const auto seeds = std::max(distinct(c.seeds, instance_of), distinct(c.seeds, start_of));
  if (seeds < kFewestForInterval)
    all.push_back(words("limits.seeds", counted(seeds, "independent seed")));
  all.push_back(words("limits.problems"));
  return all;
}

}  // namespace isoline::reports
