// The ranking of methods and its reliability: sentences and tables, all derived from one decision.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/results/contrasts.h"
#include "core/results/statistics.h"
#include "core/seeds.h"
#include "reports/sections/contrasts.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// "gauss-newton, adam and 3 more"
std::string names_text(const Comparison& c, const std::vector<std::size_t>& methods,
                       std::size_t most) {
  std::vector<std::string> names;
  for (const std::size_t s : methods) names.push_back(name_in_sentence(c.optimizers[s]));
  return first_of(std::move(names), most);
}

// The least and the greatest number of different parts of its seeds that a setting of the ranking
// has, or any setting where there is no ranking.
std::pair<std::size_t, std::size_t> numbers_of(const Comparison& c,
                                               std::uint64_t (*part)(std::uint64_t)) {
  std::map<std::size_t, std::vector<std::uint64_t>> seeds;
  for (const Run& run : c.runs)
    if (c.order.settings.empty() || c.order.has_setting(run.problem))
      seeds[run.problem].push_back(run.seed);
  std::pair<std::size_t, std::size_t> ends{seeds.empty() ? 0 : c.runs.size(), 0};
  for (const auto& [setting, own] : seeds) {
    const std::size_t number = distinct(own, part);
    ends = {std::min(ends.first, number), std::max(ends.second, number)};
  }
  return ends;
}

// "22 to 36", or one number.
std::string range_text(std::size_t low, std::size_t high) {
  return low == high ? std::to_string(low) : fmt::format("{} to {}", low, high);
}

// "19 test problems (5 from physics, at most 64 unknowns; 3 starting points per problem)"
std::string settings_text(const Comparison& c) {
  std::size_t physics = 0;
  Index unknowns = 0;
  for (const std::size_t p : c.order.settings) {
    physics += c.problems[p].group() == "physics";
    if (const Sheet* sheet = c.problems[p].sheet) unknowns = std::max(unknowns, sheet->unknowns);
  }
  const std::size_t settings = c.order.settings.size(), names = names_of(c, c.order);
  std::vector<std::string> parts;
  if (physics == settings)
    parts.push_back(words("ranking.all-physics"));
  else if (physics > 0)
    parts.push_back(words("ranking.physics", counted(physics, common_noun(c))));
  if (const std::size_t families = families_of(c, c.order); families < names)
    parts.push_back(words("ranking.families", families));
  if (unknowns > 0) parts.push_back(words("ranking.unknowns", unknowns));
  std::string about = joined(parts);
  const auto instances = numbers_of(c, instance_of), starts = numbers_of(c, start_of),
             all = numbers_of(c, [](std::uint64_t seed) { return seed; });
  const bool is_crossed = all.second > std::max(instances.second, starts.second);
  const auto& own = instances.second > 1 ? instances : starts;
  if (all.second > 1)
    about += (about.empty() ? "" : "; ") +
             (is_crossed ? words("ranking.crossed", range_text(instances.first, instances.second),
                                 range_text(starts.first, starts.second), common_noun(c))
                         : words(instances.second > 1 ? "ranking.instances" : "ranking.starts",
                                 range_text(own.first, own.second), common_noun(c)));
  return words(names < settings ? "ranking.settings" : "ranking.problems", settings, names,
               about.empty() ? "" : " (" + about + ")");
}

std::string common_settings(const Comparison& c) {
  return counted(c.order.settings.size(), common_noun(c));
}

// The results that so many families can decide; then the highest score, with those equal to it for
// a user.
std::string open_text(const Comparison& c, const Decision& decision) {
  const std::optional<std::size_t> fewest = decision.fewest_wins();
  if (!fewest) return words("ranking.no-wins", decision.families);
  std::vector<std::string> scored;
  for (const results::Place& place : decision.places)
    if (decision.places[0].score - place.score <= results::score_margin())
      scored.push_back(
          words("ranking.scored", names_text(c, {place.method}, 1), place.score, place.solved));
  return words("ranking.wins-needed", decision.families, *fewest, first_of(scored, 4),
               scored.size());
}

std::string tied_names(const Comparison& c, const Decision& decision) {
  std::vector<std::size_t> tied;
  for (std::size_t i = 0; i < decision.tied; ++i) tied.push_back(decision.places[i].method);
  return names_text(c, tied, 3);
}

// Why results that share enough settings have no decision.
std::string undecided_text(const Comparison& c) {
  if (!c.missing.empty()) return words("ranking.incomplete", c.missing.size());
  if (c.yardstick.by != Measure::time) return words("ranking.none");
  return words(c.is_any_timed_together ? "ranking.shared-time" : "ranking.short-time");
}

std::string decision_sentence(const Comparison& c, const Decision& decision) {
  const auto name = [&](const results::Place& place) { return names_text(c, {place.method}, 1); };
  const results::Place& first = decision.places[0];
  const std::string on = settings_text(c), measure(counted_name(c)), tau = tau_name(c);
  if (decision.places.size() == 1)
    return words("ranking.alone", on, name(first), first.score, first.solved);
  if (decision.tied > 1)
    return words("ranking.tied", on, tied_names(c, decision), measure, tau, first.score);
  if (!decision.is_lead) return words("ranking.open", on, measure, tau, open_text(c, decision));
  const results::Place& next = decision.places[1];
  return words("ranking.lead", on, measure, tau, name(first), first.score, first.solved,
               words("ranking.scored", name(next), next.score, next.solved), next.p);
}

// The decision in one short sentence.
std::string first_sentence(const Comparison& c, const Decision& decision) {
  const results::Place& first = decision.places[0];
  const std::string name = name_in_sentence(c.optimizers[first.method]);
  if (decision.places.size() == 1)
    return words("ranking.alone", common_settings(c), name, first.score, first.solved);
  if (decision.tied > 1) return words("ranking.first-tied", tied_names(c, decision), first.score);
  if (decision.is_lead) return words("ranking.first-lead", name, first.score, decision.places[1].p);
  return words("ranking.first-open", open_text(c, decision));
}

std::string variation_text(const Decision& decision) {
  const auto [least, most] = decision.group_sizes();
  return words("ranking.variation", range_text(least, most), most, decision.places.size(),
               decision.choices.size());
}

// The methods that the data do not exclude as the best: those that solve about as many settings by
// name, the others as a number.
std::string group_text(const Comparison& c, const Decision& decision) {
  constexpr std::size_t kAbout = 3;  // settings
  if (!decision.fewest_wins()) return words("ranking.group-any", decision.families);
  std::vector<std::size_t> close;
  std::size_t others = 0;
  for (const results::Place& place : decision.places)
    if (place.is_in_group && place.solved + kAbout >= decision.places[0].solved)
      close.push_back(place.method);
    else
      others += place.is_in_group;
  return words("ranking.group", words(c.yardstick.has_contrasts ? "ranking.second" : "ranking.not"),
               names_text(c, close, 6), close.size() + others, decision.places.size(),
               others == 0 ? "" : words("ranking.too-few", others)) +
         " " + variation_text(decision);
}

// Counts of settings, of which one family may have many, and of families solved whole.
std::string most_solved_text(const Comparison& c, const Decision& decision) {
  std::vector<std::size_t> solved, whole;  // by place
  for (const results::Place& place : decision.places) {
    std::map<std::string, bool> families;  // whether every setting is solved
    for (const std::size_t p : c.order.settings) {
      bool& is_whole = families.try_emplace(c.problems[p].family(), true).first->second;
      is_whole = is_whole && c.cell(p, place.method).headline[kTightest].is_solved();
    }
    solved.push_back(place.solved);
    whole.push_back(static_cast<std::size_t>(
        std::ranges::count(families, true, &std::pair<const std::string, bool>::second)));
  }
  const auto text = [&](const std::vector<std::size_t>& counts, const char* key, std::size_t all,
                        const auto&... more) {
    const std::size_t most = std::ranges::max(counts);
    const auto count = static_cast<std::size_t>(std::ranges::count(counts, most));
    const auto at = std::ranges::find(counts, most) - counts.begin();
    const std::size_t method = decision.places[static_cast<std::size_t>(at)].method;
    return words(key, count > 1 ? counted(count, "method") : names_text(c, {method}, 1), count,
                 most, all, more...);
  };
  const bool are_tied = std::ranges::count(solved, std::ranges::max(solved)) > 1;
  return text(solved, "ranking.most-solved", decision.settings,
              are_tied ? words("ranking.within-noise") : "",
              decision.families < decision.settings
                  ? text(whole, "ranking.most-families", decision.families)
                  : "");
}

// The settings that methods of each kind solve: their order within a kind is mostly chance.
std::string kinds_text(const Comparison& c, const Decision& decision) {
  std::map<std::string, std::vector<const results::Place*>> kinds;
  for (const results::Place& place : decision.places)
    if (const std::string kind = c.optimizers[place.method].mathematics(); kind != "other")
      kinds[kind].push_back(&place);
  std::vector<std::string> parts;
  for (auto& [kind, places] : kinds) {
    std::ranges::sort(places, {}, &results::Place::solved);
    const std::size_t low = places.front()->solved, high = places.back()->solved;
    parts.push_back(
        words("ranking.kind",
              places.size() > 1 ? words("kind." + kind) : names_text(c, {places[0]->method}, 1),
              range_text(low, high)));
  }
  std::string text = most_solved_text(c, decision);
  if (parts.size() > 1)
    text += " " + words("ranking.kinds", decision.settings, joined(parts, "; "));
  return text;
}

// Linear settings, which a Gauss-Newton step solves, apart from the others.
std::string linear_text(const Comparison& c, const Decision& decision) {
  const std::size_t linear = part_of_order(c, true).settings.size();
  const auto apart = std::ranges::find(decision.choices, Varied::linear, &Choice::varied);
  if (linear == 0 || apart == decision.choices.end()) return "";
  const std::string others = apart->group == decision.places.size()
                                 ? words("ranking.linear-open")
                                 : words("ranking.linear-first",
                                         apart->first.empty() ? words("ranking.no-method")
                                                              : names_text(c, apart->first, 3),
                                         apart->group, decision.places.size());
  return words("ranking.linear", linear, decision.settings, decision.settings - linear, others);
}

// Why a method ranks first more often than another, where a reason shows.
std::string reason_text(const Comparison& c, std::size_t method, std::size_t other) {
  const Standing &own = c.optimizers[method].tightest(), &its = c.optimizers[other].tightest();
  const std::string name = names_text(c, {method}, 1);
  if (own.reached > its.reached)
    return words("ranking.because-solved", name, own.reached, own.runs, names_text(c, {other}, 1),
                 its.reached);
  const auto less = std::ranges::count_if(c.order.settings, [&](std::size_t p) {
    return c.cell(p, method).headline[kTightest].median <
           c.cell(p, other).headline[kTightest].median;
  });
  return less == 0 ? "" : words("ranking.because-work", name, counted_name(c), less);
}

std::string robustness_text(const Comparison& c, const Decision& decision) {
  const results::Place& first = decision.places[0];
  const auto name = [&](const results::Place& place) { return names_text(c, {place.method}, 1); };
  std::vector<results::Place> often = decision.places;
  std::ranges::stable_sort(often, std::ranges::greater{}, &results::Place::share_first);
  const auto other = std::ranges::find_if_not(
      often, [&](const results::Place& place) { return place.method == first.method; });
  const bool has_other = other != often.end() && other->share_first > 0;
  std::map<std::string, std::vector<std::string>> lost;  // by the method that then ranks first
  std::size_t kept = 0;
  for (const Choice& choice : decision.choices) {
    kept += choice.is_kept;
    if (choice.is_kept || choice.first.empty()) continue;
    lost[names_text(c, choice.first, 1)].push_back(choice_text(choice));
  }
  std::vector<std::string> firsts;
  for (const auto& [method, choices] : lost)
    firsts.push_back(
        words("ranking.otherwise-of", method, choices.size(), first_of(choices, 3, "; ")));
  const std::string share = percent(first.share_first);
  const bool is_other_more = has_other && other->share_first > first.share_first;
  constexpr Real kApart = 0.1;  // less is chance
  const bool are_apart = has_other && std::abs(other->share_first - first.share_first) > kApart;
  const std::string samples =
      !has_other ? words("ranking.share", name(first), share)
                 : words(is_other_more ? "ranking.share-more" : "ranking.share-less", name(first),
                         share, name(*other), percent(other->share_first),
                         !are_apart      ? ""
                         : is_other_more ? reason_text(c, other->method, first.method)
                                         : reason_text(c, first.method, other->method));
  return words("ranking.robustness", samples, name(first), kept, decision.choices.size(),
               lost.empty() ? "" : words("ranking.otherwise", listed(firsts)));
}

// The shares in which the leader leads, and the method that leads most often beside it.
std::string varies_text(const Comparison& c, const Decision& decision) {
  const results::Place& first = decision.places[0];
  const auto other = std::ranges::max_element(decision.places.begin() + 1, decision.places.end(),
                                              {}, &results::Place::share_first);
  return words(
      "ranking.varies", name_in_sentence(c.optimizers[first.method]), percent(first.share_first),
      other == decision.places.end() || other->share_first <= 0
          ? ""
          : " " + words("ranking.varies-other", name_in_sentence(c.optimizers[other->method]),
                        percent(other->share_first)),
      std::ranges::count_if(decision.choices, &Choice::is_kept), decision.choices.size());
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

std::string counted_families(std::size_t families) { return words("ranking.families", families); }

Table sanity_table(const Comparison& c);
Table noise_level_table(const Comparison& c);

}  // namespace

std::vector<MethodPair> all_pairs(const Comparison& c) {
  Costs costs = median_costs(c, kTightest);
  std::vector<std::string> families;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    families.push_back(c.problems[p].family());
    for (std::size_t s = 0; s < costs[p].size(); ++s)
      if (!is_ordered(c, p) || !c.cell(p, s).inapplicable.empty()) costs[p][s].reset();
  }
  std::vector<MethodPair> all;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = a + 1; b < c.optimizers.size(); ++b)
      all.push_back({a, b, work_ratio(costs, families, a, b)});
  return all;
}

std::string choice_text(const Choice& choice) {
  constexpr std::array<const char*, 7> kKeys = {
      "choice.end",    "choice.tolerance", "choice.measure", "choice.prices",
      "choice.family", "choice.linear",    "choice.seed"};
  static_assert(static_cast<std::size_t>(Varied::seed) + 1 == kKeys.size());
  const bool is_measure = choice.varied == Varied::measure;
  if (choice.varied == Varied::linear) return words("choice.linear");
  return words(kKeys[static_cast<std::size_t>(choice.varied)],
               is_measure ? counted_name(measure_of(choice.value).value_or(Measure::work))
                          : std::string_view(choice.value));
}

std::vector<std::string> verdict(const Comparison& c) {
  if (is_all_learned(c) && !c.problems.empty()) return learned_sentences(c);
  const bool is_any_solved = std::ranges::any_of(c.cells, [](const auto& row) {
    return std::ranges::any_of(
        row, [](const Cell& cell) { return cell.headline[kTightest].is_solved(); });
  });
  const bool are_all_unknown = std::ranges::all_of(c.problems, &ProblemAxis::lacks_least_loss);
  if (!is_any_solved && !are_all_unknown) {  // calls of one's own may differ by more than τ
    const bool are_own = std::ranges::all_of(c.problems, &ProblemAxis::is_least_of_runs);
    const auto applies = [](const auto& method) { return method.applicable > 0; };
    if (!c.missing.empty()) return {words("ranking.incomplete", c.missing.size())};
    if (std::ranges::none_of(c.optimizers, applies)) return {words("ranking.none-applies")};
    return {words(are_own ? "ranking.none-near" : "ranking.none-solved", tau_name(c))};
  }
  std::vector<std::string> all;
  std::string left_out = left_out_text(c);
  if (!left_out.empty()) left_out = words("fact.not-ranked") + ": " + left_out;
  if (!has_order(c) || !c.decision) {  // with few problems: a sentence on each
    const std::size_t few = has_order(c) ? 0 : 4;
    if (has_order(c)) all.push_back(undecided_text(c));
    for (std::size_t p = 0; p < std::min(c.problems.size(), few); ++p)
      all.push_back(fmt::format("{}: {}", problem_name(c.problems[p]), curve_reading(c, p)));
    if (!left_out.empty()) all.push_back(std::move(left_out));
    return all;
  }
  all = {decision_sentence(c, *c.decision), group_text(c, *c.decision), kinds_text(c, *c.decision),
         linear_text(c, *c.decision), robustness_text(c, *c.decision)};
  if (c.open_decision && c.open_decision->places[0].method != c.decision->places[0].method)
    all.push_back(words("ranking.without-extra", decision_sentence(c, *c.open_decision)));
  all.push_back(words("limits.problems"));
  if (c.yardstick.has_contrasts) {
    for (const Table& table : {sanity_table(c), noise_level_table(c)})
      if (!table.rows.empty()) all.push_back(table.reading);
  }
  all.push_back(unranked_sentence(c));
  all.push_back(std::move(left_out));
  for (std::string& sentence : learned_sentences(c)) all.push_back(std::move(sentence));
  std::erase(all, "");
  return all;
}

std::vector<std::string> first_sentences(const Comparison& c) {
  if (c.yardstick.has_contrasts) {
    std::vector<std::string> all = contrast_sentences(c);
    if (has_order(c) && c.decision) all.push_back(group_text(c, *c.decision));
    if (!all.empty()) all.back() += " " + words("ranking.chosen");
    if (!all.empty()) return all;
  }
  if (is_all_learned(c) || !has_order(c) || !c.decision) {
    std::vector<std::string> all = verdict(c);
    all.resize(std::min<std::size_t>(1, all.size()));
    return all;
  }
  const bool can_decide = c.decision->places.size() < 2 || c.decision->fewest_wins().has_value();
  return {first_sentence(c, *c.decision),
          can_decide ? varies_text(c, *c.decision) : most_solved_text(c, *c.decision),
          words("ranking.chosen")};
}

std::vector<Reading> ranking_facts(const Comparison& c) {
  std::vector<Reading> facts;
  if (has_order(c) && c.decision)
    facts = {{words("fact.group"), group_text(c, *c.decision)},
             {words("fact.robustness"), robustness_text(c, *c.decision)}};
  else
    facts = {{words("fact.ranking"), has_order(c) ? undecided_text(c) : words("ranking.none")}};
  if (const std::string left_out = left_out_text(c); !left_out.empty())
    facts.push_back({words("fact.not-ranked"), left_out});
  facts.push_back({words("fact.not-run"), not_run(c)});
  return facts;
}

std::string left_out_text(const Comparison& c) {
  std::vector<std::string> parts, ill_posed, unknown;
  std::size_t sanity = 0, learned = 0;
  bool has_regressions = false;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    sanity += is_sanity(c, p);
    learned += c.problems[p].is_learned;
    has_regressions = has_regressions || c.problems[p].name == "nist";
    if (is_ill_posed(c, p)) ill_posed.push_back(problem_name(c.problems[p]));
    if (c.problems[p].lacks_least_loss()) unknown.push_back(problem_name(c.problems[p]));
  }
  if (c.yardstick.has_contrasts) {  // which state their groups apart
    const auto noisy = std::ranges::count_if(
        c.problems, [](const ProblemAxis& problem) { return is_contrasted(problem, true); });
    return noisy == 0 ? "" : words("ranking.noisy", noisy);
  }
  std::string tables;
  if (!c.sanity.settings.empty())
    tables += " " + words("ranking.sanity-table", c.sanity.settings.size());
  if (has_regressions) tables += " " + words("ranking.certified-table");
  if (sanity > 0) parts.push_back(words("ranking.sanity", sanity, tables));
  if (!ill_posed.empty())
    parts.push_back(words("ranking.ill-posed", ill_posed.size(), first_of(ill_posed, 4)));
  if (!unknown.empty())
    parts.push_back(words("ranking.unknown", unknown.size(), first_of(unknown, 4)));
  if (learned > 0) parts.push_back(words("ranking.learned", learned));
  return joined(parts, " ");
}

std::vector<Ranked> standings_beside(const Comparison& c, std::size_t s) {
  if (c.order.has(s)) return {};
  Order own{.settings = c.order.settings, .methods = c.order.methods};
  std::erase_if(own.settings, [&](std::size_t p) { return c.cell(p, s).planned == 0; });
  if (own.settings.empty()) return {};
  own.methods.push_back(s);
  return standings_over(c, own, c.yardstick.by, c.yardstick.tightest().rung);
}

std::string unranked_sentence(const Comparison& c) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const std::vector<Ranked> beside = standings_beside(c, s);
    if (c.optimizers[s].applicable == 0 || beside.empty()) continue;
    const Standing& own = std::ranges::find(beside, s, &Ranked::optimizer)->standing;
    if (own.settings == c.order.settings.size()) continue;
    const Real score = own.score;
    const auto ahead = std::ranges::count_if(beside, [&](const Ranked& other) {
      return other.standing.score > score && !are_tied(other.standing.score, score);
    });
    names.push_back(words("ranking.run-on", name_in_sentence(c.optimizers[s]), own.settings,
                          ordinal(static_cast<std::size_t>(ahead) + 1), beside.size()));
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
    const bool is_tied = i > 0 && are_tied(standing, c.optimizers[s - 1].tightest());
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

// Classical and toy problems beside a ranking of physics, or the controls beside contrasts: most
// solved first.
Table sanity_table(const Comparison& c) {
  const char* const key = c.yardstick.has_contrasts ? "controls" : "sanity";
  Table table = worded_table(key, c.order.settings.size(), counted_name(c), tau_name(c));
  table.id = "sanity";
  if (c.sanity.settings.empty()) return table;
  Leading first;
  const Measure by = c.yardstick.by;
  const std::size_t rung = c.yardstick.tightest().rung;
  std::vector<Ranked> all = standings_over(c, c.sanity, by, rung);
  std::ranges::stable_sort(all, std::ranges::greater{},
                           [](const Ranked& each) { return each.standing.solved; });
  for (const auto& [s, standing] : all) {
    std::vector<Real> medians;
    for (const std::size_t p : c.sanity.settings) medians.push_back(c.cell(p, s).median(by, rung));
    const Real median = median_of(std::move(medians));
    add_row(table, c, s,
            {{fmt::format("{}/{}", standing.solved, standing.settings),
              {{"solved", Real(standing.solved)}, {"settings", Real(standing.settings)}}},
             {amount(c, median), {{"median", median}}},
             {fmt::format("{}/{}", standing.reached, standing.runs),
              {{"reached", Real(standing.reached)}, {"runs", Real(standing.runs)}}}});
    first.offer(Real(standing.solved), optimizer_text(c, s));
  }
  table.is_folded = true;
  const char* const none = c.yardstick.has_contrasts ? "controls.none" : "sanity.none";
  table.reading = words(first.value > 0 ? std::string(key) + ".reading" : none, first.value,
                        c.sanity.settings.size(), first.text(), first.names.size());
  return table;
}

// Linear and nonlinear settings apart; none where all are of one kind.
Table linear_table(const Comparison& c) {
  Table table = worded_table("linear", setting_noun(c), tau_name(c));
  const Order linear = part_of_order(c, true), others = part_of_order(c, false);
  if (linear.settings.empty() || others.settings.empty()) return table;
  std::map<std::size_t, Standing> on_linear;
  for (const auto& [s, standing] :
       standings_over(c, linear, c.yardstick.by, c.yardstick.tightest().rung))
    on_linear[s] = standing;
  const auto solved = [](const char* name, const Standing& standing) -> TableCell {
    return {fmt::format("{}/{}", standing.solved, standing.settings),
            {{name, Real(standing.solved)}}};
  };
  const auto score = [](const char* name, const Standing& standing) -> TableCell {
    return {fmt::format("{:.3f}", standing.score), {{name, standing.score}}};
  };
  for (const auto& [s, standing] :
       standings_over(c, others, c.yardstick.by, c.yardstick.tightest().rung))
    add_row(table, c, s,
            {solved("nonlinear_solved", standing), score("nonlinear_score", standing),
             solved("linear_solved", on_linear[s]), score("linear_score", on_linear[s])});
  table.is_folded = true;
  table.reading = linear_text(c, *c.decision);
  return table;
}

// A row per method and a column per setting. show(cell, p, s) adds text and numbers to a cell of
// the table; of the last number the least is bold, and the reading lists it.
Table settings_table(const Comparison& c, const char* key, const std::vector<std::size_t>& settings,
                     const auto& title, const auto& show) {
  Table table = worded_table(key);
  table.column_topics.emplace_back();
  for (const std::size_t p : settings) {
    table.columns.push_back(title(p));
    table.column_topics.push_back({.problem = p});
  }
  std::vector<Real> least(settings.size(), kNever);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::vector<TableCell> row;
    for (std::size_t i = 0; i < settings.size(); ++i) {
      const Cell& cell = c.cell(settings[i], s);
      TableCell& shown = row.emplace_back(cell.inapplicable.empty() ? "" : "n/a");
      if (!cell.is_measured()) continue;
      show(shown, settings[i], s);
      least[i] = std::min(least[i], shown.numbers.back().second);
    }
    if (std::ranges::any_of(row, [](const TableCell& cell) { return !cell.numbers.empty(); }))
      add_row(table, c, s, std::move(row));
  }
  for (auto& row : table.rows)
    for (std::size_t i = 0; i < settings.size(); ++i)
      row[i + 1].is_best =
          !row[i + 1].numbers.empty() && row[i + 1].numbers.back().second <= least[i];
  std::vector<std::string> readings;
  for (std::size_t i = 0; i < settings.size(); ++i)
    readings.push_back(fmt::format("{} {:.3g}", problem_name(c.problems[settings[i]]), least[i]));
  table.is_folded = true;
  if (const std::string reading = std::string(key) + ".reading"; all_sentences().contains(reading))
    table.reading = words(reading, joined(readings));
  return table;
}

// The error in x at a quarter, a half and all of the budget.
Table ill_posed_table(const Comparison& c) {
  constexpr std::array<Real, 3> kShares = {0.25, 0.5, 1};
  std::vector<std::size_t> settings;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (is_ill_posed(c, p)) settings.push_back(p);
  const auto title = [&](std::size_t p) {
    return words("ill-posed.setting", problem_name(c.problems[p]),
                 figure(c.problems[p].least_goal / x_goal(0, 1, 1)));
  };
  return settings_table(c, "ill-posed", settings, title,
                        [&](TableCell& shown, std::size_t p, std::size_t s) {
                          std::vector<std::string> texts;
                          for (const Real share : kShares) {
                            const Real error = x_error_at(c, p, s, share).median;
                            texts.push_back(error == kNever ? "✗" : fmt::format("{:.3g}", error));
                            shown.numbers.push_back({fmt::format("at_{:g}", share), error});
                          }
                          shown.text = joined(texts, "; ");
                        });
}

// The error in x where the noise level ended a run, over that of the best truncated SVD, on the
// ill-posed settings of a suite with contrasts. Few runs have ranges over settings, and no first.
Table noise_level_table(const Comparison& c) {
  std::vector<std::size_t> settings;
  for (std::size_t p = 0; p < c.problems.size() && c.yardstick.has_contrasts; ++p)
    if (is_ill_posed(c, p)) settings.push_back(p);
  std::map<std::size_t, std::vector<Real>> ratios;                       // by method
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> all_ended;  // of so many runs
  const auto title = [&](std::size_t p) { return problem_name(c.problems[p]); };
  Table table = settings_table(
      c, "noise-level", settings, title, [&](TableCell& shown, std::size_t p, std::size_t s) {
        const Cell& cell = c.cell(p, s);
        const auto over_floor = [](const Run& run) {
          const Record& record = *run.record;
          return is_failure(record.status) ? kNever : record.summary.x_error / record.x_floor;
        };
        const Real ratio = c.aggregate(cell.runs, over_floor, cell.missing()).median;
        const auto ended = c.where(cell.runs, [](const Run& run) {
                              return run.record->status == Status::discrepancy;
                            }).size();
        shown.text = fmt::format("{} ({}/{})", ratio == kNever ? "✗" : fmt::format("{:.3g}", ratio),
                                 ended, cell.runs.size());
        shown.numbers = {{"ratio", ratio}};
        ratios[s].push_back(ratio);
        all_ended[s].first += ended;
        all_ended[s].second += cell.runs.size();
      });
  std::vector<std::string> ranges, never;
  for (const auto& [s, all] : ratios) {
    const auto [low, high] = std::ranges::minmax(all);
    const std::string name = name_in_sentence(c.optimizers[s]);
    const auto [ended, runs] = all_ended[s];
    if (2 * ended <= runs) {
      never.push_back(words("noise-level.never-in", name, runs - ended, runs));
      continue;
    }
    ranges.push_back(words("noise-level.range", name, reached_figure(std::round(100 * low) / 100),
                           reached_figure(std::round(100 * high) / 100)));
  }
  for (auto& row : table.rows)
    for (TableCell& cell : row) cell.is_best = false;
  table.reading = words("noise-level.ranges", settings.size(), joined(ranges, "; "),
                        never.empty() ? "" : words("noise-level.never", joined(never)));
  return table;
}

// Final losses where the least loss is unknown, and their distances from the best of any run.
Table losses_table(const Comparison& c) {
  std::vector<std::size_t> settings;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (c.problems[p].lacks_least_loss()) settings.push_back(p);
  const auto title = [&](std::size_t p) { return problem_name(c.problems[p]); };
  Table table = settings_table(
      c, "losses", settings, title, [&](TableCell& shown, std::size_t p, std::size_t s) {
        const Cell& cell = c.cell(p, s);
        const auto last = [](const Run& run) {
          const std::vector<Real> left = losses_left(run);
          return left.empty() ? kNever : left.back();
        };
        const Real distance = c.aggregate(cell.runs, last, cell.missing()).median;
        shown.text = fmt::format("{} ({})", reached_figure(cell.loss.median),
                                 distance == kNever ? "✗" : "+" + percent(distance));
        shown.numbers = {{"distance", distance}, {"loss", cell.loss.median}};
      });
  table.is_folded = false;
  return table;
}

}  // namespace

Section standings_section(const Comparison& c) {
  Section section = worded_section("standings", tau_name(c));
  Table contrasts = contrast_table(c);
  if (!contrasts.rows.empty()) section.readings.push_back({"", contrasts.reading});
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  if (!contrasts.rows.empty()) section.tables.push_back(std::move(contrasts));
  if (!c.order.settings.empty()) section.tables.push_back(ranking_table(c));
  if (!c.sanity.settings.empty()) section.tables.push_back(sanity_table(c));
  for (Table table : {c.decision ? linear_table(c) : Table{}, losses_table(c),
                      c.yardstick.has_contrasts ? noise_level_table(c) : ill_posed_table(c)})
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
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
  if (!has_order(c) || !c.decision) return table;
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
  if (!has_order(c) || !c.decision) return table;
  for (const Choice& choice : c.decision->choices)
    table.rows.push_back({choice_text(choice), names_text(c, choice.first, 3)});
  table.reading = robustness_text(c, *c.decision);
  return table;
}

std::vector<std::string> limits_of_evidence(const Comparison& c) {
  std::vector<std::string> all;
  if (c.decision && c.decision->places.size() > 1) {
    const Decision& decision = *c.decision;
    const std::string families = counted_families(decision.families);
    if (decision.fewest_wins())
      all.push_back(words(
          decision.friedman <= kSignificant ? "limits.friedman-differs" : "limits.friedman-equal",
          counted(decision.places.size(), "method"), families, decision.friedman));
    all.push_back(words("limits.least-p", families, decision.least_p));
    all.push_back(decision.detectable < kNever && decision.detectable > 0
                      ? words("limits.detectable", decision.detectable)
                      : words("limits.undetectable", families));
  }
  const auto independent =
      std::max(numbers_of(c, instance_of).second, numbers_of(c, start_of).second);
  if (independent < kFewestForInterval)
    all.push_back(words("limits.seeds", counted(independent, "independent seed")));
  return all;
}

}  // namespace isoline::reports
