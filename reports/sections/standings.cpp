// Pairs over the problems that both were given.
#include "reports/sections/standings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/results/statistics.h"
#include "core/results/tests.h"
#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::vector<MethodPair> all_pairs(const Comparison& c) {
  Costs costs = median_costs(c, kTightest);
  for (std::size_t p = 0; p < costs.size(); ++p)
    if (!is_ordered(c, p)) costs[p].assign(costs[p].size(), std::nullopt);
  const Groups groups = groups_of(c);
  std::vector<MethodPair> all;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = a + 1; b < c.optimizers.size(); ++b)
      all.push_back({a, b, pairing_of(costs, groups, a, b)});
  return all;
}

// Words for leads.

namespace {

// The first in rank that cannot be told from the leader by itself; the next where all can be.
const Rival& nearest(const Lead& lead) {
  const auto open = std::ranges::find_if(lead.rivals, [](const Rival& rival) {
    return rival.p > kSignificant || rival.pairing.doublings.size() < kLeastNames;
  });
  return open == lead.rivals.end() ? lead.rivals.front() : *open;
}

// log2 of the other's cost over the first's, the mean over problems.
Real mean_doublings(const Pairing& pairing) {
  const auto& all = pairing.doublings;
  return -std::accumulate(all.begin(), all.end(), 0.0) / std::max(Real(all.size()), 1.0);
}

bool solves_none(const Comparison& c, const Placed& placed) {
  const Standing& standing = c.optimizers[placed.optimizer].tightest();
  return standing.solved == 0 && standing.settings > 0;
}

std::string given_text(const OptimizerAxis& axis) {
  return axis.label == axis.whole ? "where it has no privileged information"
                                  : "where it is " + axis.label.substr(axis.whole.size() + 2);
}

// "17 settings of 15 problems", or "15 problems" where each has one.
std::string ground_text(const Comparison& c, const Order& order) {
  const std::size_t names = names_of(c, order);
  if (names == order.settings.size()) return counted(names, "problem");
  return fmt::format("{} of {}", counted(order.settings.size(), "setting"),
                     counted(names, "problem"));
}

}  // namespace

std::string field_text(const Comparison& c, const Lead& lead) {
  return fmt::format("{} on the {} that all of them were given",
                     counted(lead.ranked.size(), "method"), ground_text(c, c.order));
}

std::string deeds_text(const Comparison& c, const Scored& scored) {
  return fmt::format("solves {} of {} to {}, {} of them with the least {}", scored.solved,
                     counted(scored.problems, common_noun(c)), tau_name(c), scored.wins,
                     counted_name(c));
}

std::string first_text(const Comparison& c, const Lead& lead) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < lead.tied; ++i)
    names.push_back(optimizer_text(c, lead.ranked[i].optimizer));
  if (names.size() > kNamed) return fmt::format("{} and {} others", names[0], names.size() - 1);
  return joined(names, " and ");
}

std::string pairing_text(const Comparison& c, const Pairing& pairing, std::size_t first) {
  return fmt::format("typically takes {} the {} of {}, which needs less on {} of {} and more on {}",
                     multiple(pairing.typical()), counted_name(c), optimizer_text(c, first),
                     pairing.wins, counted(pairing.doublings.size(), "problem"), pairing.losses);
}

std::string settled_text(const Comparison& c, const Lead& lead) {
  if (lead.tied > 1)
    return fmt::format("{} are tied: the scores are equal, and none leads.", first_text(c, lead));
  if (lead.rivals.empty()) return "There is no other method to compare it with.";
  const Rival& rival = nearest(lead);
  const std::string name = optimizer_text(c, rival.optimizer);
  const std::string pairing = pairing_text(c, rival.pairing, lead.ranked[0].optimizer);
  if (lead.is_settled)
    return fmt::format(
        "Its lead is settled for problems like these: each of the {} others is behind at 0.05 by a "
        "paired sign-flip test over problems; the next, {}, {}.",
        lead.rivals.size(), name, pairing);
  if (rival.pairing.doublings.size() < kLeastNames)
    return fmt::format(
        "Its lead is not settled: against {} there are {} to compare, and the test asks for {}; {} "
        "{}.",
        name, counted(rival.pairing.doublings.size(), "problem"), kLeastNames, name, pairing);
  if (rival.p <= kSignificant)
    return "Its lead is not settled: the ranks of all methods together could be chance.";
  const Real mean = mean_doublings(rival.pairing);
  const std::string favoured =
      mean > 0 ? optimizer_text(c, lead.ranked[0].optimizer) : optimizer_text(c, rival.optimizer);
  return fmt::format(
      "Its lead is not settled: {} is not distinguishable from it, since the mean over problems is {:.2g} "
      "doublings in favour of {} (p = {:.2g} by a paired sign-flip test); {} {}.",
      name, std::abs(mean), favoured, rival.p, name, pairing);
}

std::string power_text(const Comparison& c, const Lead& lead) {
  if (lead.rivals.empty()) return "";
  const Rival& rival = nearest(lead);
  const Real factor = detectable_factor(rival.pairing);
  std::string text = fmt::format(
      "After Holm, {} of the {} others that apply to at least half of these problems {} told from {}.",
      lead.told(), lead.rivals.size(), lead.told() == 1 ? "is" : "are",
      optimizer_text(c, lead.ranked[0].optimizer));
  if (factor < kNever && factor > 1)
    text += fmt::format(
        " With the spread there is against {} over {}, a true factor of {} would be found in 80 % "
        "of such comparisons.",
        optimizer_text(c, rival.optimizer), counted(rival.pairing.doublings.size(), "problem"),
        multiple(factor));
  return text;
}

std::string placed_text(const Comparison& c, const Placed& placed) {
  const OptimizerAxis& axis = c.optimizers[placed.optimizer];
  const std::string settings = counted(placed.among.settings.size(), setting_noun(c));
  if (solves_none(c, placed)) {
    const std::string those = placed.among.settings.size() == 1
                                  ? "does not solve the one " + std::string(setting_noun(c))
                                  : "solves none of the " + settings;
    return those + (axis.is_meaning ? " " + given_text(axis) : " it was given");
  }
  if (placed.among.methods.size() < 2)
    return fmt::format("alone on {}", counted(placed.among.settings.size(), setting_noun(c)));
  return fmt::format("{} of {} on the {}{}", ordinal(placed.place), placed.among.methods.size(),
                     settings, axis.is_meaning ? " " + given_text(axis) : " it was given");
}

std::string apart_text(const Comparison& c, const Placed& placed) {
  const OptimizerAxis& axis = c.optimizers[placed.optimizer];
  if (axis.is_meaning) return "has privileged information on some problems only";
  return fmt::format("asked {} of {}", placed.asked, counted(placed.shared, setting_noun(c)));
}

std::string apart_sentence(const Comparison& c) {
  std::vector<std::string> meanings, others;
  for (const Placed& placed : c.apart) {
    const std::string name = shown_spec(c.optimizers[placed.optimizer].label);
    if (c.optimizers[placed.optimizer].is_meaning)
      meanings.push_back(fmt::format("{} {}{}", name, solves_none(c, placed) ? "" : "is ",
                                     placed_text(c, placed)));
    else
      others.push_back(fmt::format("{} ({})", name, apart_text(c, placed)));
  }
  std::string text;
  if (!meanings.empty())
    text +=
        fmt::format("Listed apart, since it has privileged information on some problems only: {}.",
                    joined(meanings, "; "));
  if (!others.empty())
    text += fmt::format("{}Not ranked: {}.", text.empty() ? "" : " ", joined(others));
  return text;
}

// Bootstraps the scores over names of problems.

std::vector<Interval> score_intervals(const Comparison& c) {
  const Costs costs = common_costs(c, kTightest);
  Costs ratios;
  for (const auto& row : costs) ratios.push_back(cost_ratios(row));
  std::vector<Interval> all(c.optimizers.size());
  for (const std::size_t s : c.order.methods) {
    const Band band = band_over_names(c, column_of(ratios, s), "problems", [](Real ratio) {
      return std::vector<Real>{score_of(ratio, kProfileEnd)};
    });
    if (!band.value.empty()) all[s] = {band.low[0], band.high[0]};
  }
  return all;
}

// Who solves the problems: the verdict, the standings of the common order, and who stands apart.

namespace {

std::string typical_text(const Standing& standing) {
  return standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical);
}

std::vector<TableCell> standing_row(const Comparison& c, const std::string& place, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  const Standing& standing = optimizer.tightest();
  std::vector<TableCell> row = {place,
                                optimizer_text(c, s),
                                fmt::format("{}/{}", standing.solved, standing.settings),
                                std::to_string(standing.wins),
                                typical_text(standing),
                                fmt::format("{}/{}", standing.reached, standing.runs),
                                std::to_string(optimizer.failed)};
  for (std::size_t t = kTightest; t-- > 0;)
    row.push_back(std::to_string(optimizer.standings[t].solved));
  return row;
}

Table standings_table(const Comparison& c) {
  const std::string legend = foreign_legend(c);
  Table table{
      .id = "standings-table",
      .caption = fmt::format(
          "Methods given the same {}, ranked by their performance profiles; equal scores share a "
          "place. Solved: {}s whose median run reaches the tolerance. Best on: with the least {} of these "
          "methods. × least: the middle of its {} over the least, in logarithms; ✗ if it solves "
          "fewer than half. Runs: those that reach it. Failed: errors, crashes, time or memory limits, "
          "on all that it was given. †: uses privileged information.{}{}{}",
          counted(c.order.settings.size(), common_noun(c)), common_noun(c), counted_name(c),
          counted_name(c), legend.empty() ? "" : " " + legend, is_any_imported(c) ? " " : "",
          is_any_imported(c) ? kImportedLegend : ""),
      .columns = {"", "optimizer", "solved", "best on", "× least", "runs", "failed"},
      .align = "rlrrrrrrr",
      .names = 2};
  for (std::size_t t = kTightest; t-- > 0;)
    table.columns.push_back(fmt::format("to {}", c.yardstick.tolerances[t].name));
  std::size_t place = 0;
  for (std::size_t i = 0; i < c.order.methods.size(); ++i) {
    const std::size_t s = c.order.methods[i];
    const Real score = c.optimizers[s].tightest().score;
    const bool is_tied =
        i > 0 && are_tied(score, c.optimizers[c.order.methods[i - 1]].tightest().score);
    if (!is_tied) place = i + 1;
    table.rows.push_back(standing_row(c, std::to_string(place), s));
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

Table apart_table(const Comparison& c) {
  Table table{.id = "apart-table",
              .title = "Not ranked with the others",
              .caption =
                  "Each against the ranked methods, on those of its settings that all of "
                  "these were given.",
              .columns = {"optimizer", "why", "where it would stand", "solved", "best on"},
              .align = "lllrr"};
  for (const Placed& placed : c.apart) {
    const Standing& standing = c.optimizers[placed.optimizer].tightest();
    table.rows.push_back(
        {optimizer_text(c, placed.optimizer), apart_text(c, placed), placed_text(c, placed),
         fmt::format("{}/{}", standing.solved, standing.settings), std::to_string(standing.wins)});
    table.row_topics.push_back({.optimizer = placed.optimizer});
  }
  return table;
}

// The first of an order, and the next two.
std::string podium_text(const Comparison& c, const Order& order) {
  const std::vector<Scored> ranked = ranked_by(costs_within(c, order, kTightest, c.yardstick.by));
  constexpr std::size_t kPodium = 3;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ranked.size() && i < kPodium && ranked[i].score > 0; ++i)
    names.push_back(fmt::format("{} ({}/{})", optimizer_text(c, ranked[i].optimizer),
                                ranked[i].solved, ranked[i].problems));
  return names.empty() ? "none solves any" : joined(names);
}

Table orders_table(const Comparison& c) {
  Table table{.id = "orders-table",
              .title = "Settings that only some methods were given",
              .caption =
                  "Each line compares the methods that were given exactly these settings: an "
                  "order of its own, over too few problems for a verdict.",
              .columns = {"settings", "methods", "first by score (solved)"},
              .align = "lrl"};
  for (const Order& order : c.other_orders) {
    std::vector<std::string> settings;
    for (const std::size_t p : order.settings) settings.push_back(problem_name(c.problems[p]));
    table.rows.push_back(
        {joined(settings), std::to_string(order.methods.size()), podium_text(c, order)});
  }
  return table;
}

}  // namespace

Section standings_section(const Comparison& c) {
  Section section{.id = "standings",
                  .title = fmt::format("Who solves the problems to {}", tau_name(c))};
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  if (!c.order.settings.empty()) section.tables.push_back(standings_table(c));
  if (!c.apart.empty()) section.tables.push_back(apart_table(c));
  if (!c.other_orders.empty()) section.tables.push_back(orders_table(c));
  return section;
}

// The leader against each other method, and what so few problems cannot show.

Table leader_table(const Comparison& c) {
  Table table{
      .id = "leader",
      .title = "The leader against each of the others",
      .reading = "There is no leader.",
      .caption = fmt::format(
          "One doubling a problem: log2 of the ratio of median {} to {}, the median over its "
          "settings, within ±6, which is also what solving against not solving counts. × of the "
          "leader: 2 to the median of them. p: exact two-sided paired sign flips of their mean; "
          "after Holm over all methods here. A problem that neither solves is left out; so is a "
          "method that applies to fewer than half of the settings.",
          counted_name(c), tau_name(c)),
      .columns = {"optimizer", "× of the leader", "wins : losses", "p", "after Holm", "n problems",
                  "failed"},
      .rows = {}};
  if (!c.lead) return table;
  const Lead& lead = *c.lead;
  for (const Rival& rival : lead.rivals) {
    if (table.rows.size() >= kMostTableRows) break;
    const Pairing& pairing = rival.pairing;
    table.row_topics.push_back({.optimizer = rival.optimizer});
    table.rows.push_back(
        {optimizer_text(c, rival.optimizer),
         {fmt::format("{:.3g}", pairing.typical()), {{"ratio", pairing.typical()}}},
         {fmt::format("{} : {}", pairing.wins, pairing.losses),
          {{"wins", Real(pairing.wins)}, {"losses", Real(pairing.losses)}}},
         {fmt::format("{:.2g}", rival.p), {{"p", rival.p}}},
         {fmt::format("{:.2g}", rival.adjusted), {{"adjusted_p", rival.adjusted}}},
         count_cell(pairing.doublings.size()),
         failed_cell(c, rival.optimizer)});
  }
  table.reading = settled_text(c, lead) + " " + power_text(c, lead);
  return table;
}

std::vector<std::string> limits_of_evidence(const Comparison& c) {
  std::vector<std::string> all;
  const std::size_t k = c.order.methods.size(), names = names_of(c, c.order);
  if (k < 2 || names == 0) return all;
  const Real friedman = friedman_of(c);
  all.push_back(fmt::format(
      "Friedman’s test of {} over the {} given to all of them: p = {:.2g}, so {}.",
      counted(k, "method"), counted(names, "problem"), friedman,
      friedman <= kSignificant ? "the mean ranks differ" : "equal mean ranks cannot be ruled out"));
  if (c.lead && !c.lead->rivals.empty()) {
    const Real pairs = Real(c.lead->rivals.size()),
               least = std::min(1.0, std::exp2(1 - Real(names)));
    all.push_back(power_text(c, *c.lead));
    all.push_back(fmt::format(
        "Over {} the least p that sign flips can give is {:.2g}, after Holm over the leader’s {} "
        "pairs {:.2g}{}.",
        counted(names, "problem"), least, pairs, std::min(1.0, least * pairs),
        least * pairs > kSignificant ? ": no pair can be told apart after it, whatever the results"
                                     : ""));
  }
  if (c.seeds.size() < kFewestForInterval)
    all.push_back(
        fmt::format("With {} no interval over seeds reaches 95 %: ranges are shown instead.",
                    counted(c.seeds.size(), "seed")));
  all.push_back("Nothing here speaks for problems unlike these: they were chosen, not drawn.");
  return all;
}

// The first against the second method, problem by problem.

// One bar a problem: the doublings by which the leader is told from the next.
Plots log_ratio_plot(const Comparison& c) {
  if (c.order.methods.size() < 2) return {};
  const Costs costs = common_costs(c, kTightest);
  std::vector<std::pair<Real, std::string>> bars;
  std::size_t given = 0;
  for (const auto& [name, problems] : problems_by_name(c)) {
    const Pairing pairing = pairing_of(costs, {problems}, 0, 1);
    given += !pairing.doublings.empty() || pairing.neither > 0;
    if (!pairing.doublings.empty()) bars.emplace_back(pairing.doublings[0], name);
  }
  if (bars.empty()) return {};
  std::ranges::sort(bars);
  const std::string first = optimizer_text(c, 0), second = optimizer_text(c, 1);
  Plot plot{
      .kind = Plot::Kind::bars,
      .id = "plot-log-ratio",
      .title = fmt::format("{} against {}, problem by problem", first, second),
      .reading =
          fmt::format("{} {}.", second, pairing_text(c, pairing_of(costs, groups_of(c), 0, 1), 0)),
      .caption = fmt::format(
          "log2 of the ratio of median {} to {}, sorted, of several settings the median: "
          "below 0 {} needs less, above 0 {}; at ±{:.0f} at least {:.0f} times, or the other never reaches it (Morales 2002). n = {} problems given to both, of which neither "
          "solves {}; failed: {} and {}.",
          counted_name(c), tau_name(c), first, second, std::log2(kProfileEnd), kProfileEnd, given,
          given - bars.size(), failed_cell(c, 0).text, failed_cell(c, 1).text),
      .x_label = "problems",
      .y_label = fmt::format("log2 of the ratio of {}", counted_name(c))};
  PlotSeries series{0, first + " / " + second, {}, {}, {}, {}};
  for (const auto& [ratio, name] : bars) {
    series.x.push_back(Real(plot.rows.size()));
    series.y.push_back(ratio);
    plot.rows.push_back({name, {.problem = problems_by_name(c).at(name)[0]}});
  }
  plot.series.push_back(std::move(series));
  return {std::move(plot)};
}

// Whether the order of methods holds at declared and at measured prices.

namespace {

constexpr std::size_t kFirst = 3;

// The first three by score, at the prices of one measure.
std::vector<std::string> first_by(const Comparison& c, Measure by) {
  std::vector<std::string> names;
  const auto lead = lead_of(c, false, by);
  if (!lead) return names;
  for (std::size_t i = 0; i < std::min(kFirst, lead->ranked.size()); ++i)
    if (lead->ranked[i].score > 0) names.push_back(optimizer_text(c, lead->ranked[i].optimizer));
  return names;
}

}  // namespace

std::string prices_text(const Comparison& c) {
  if (c.yardstick.by == Measure::time && c.is_any_timed_together)
    return "Some of these times were taken while other runs shared the machine, and are marked ≈: an "
           "order by them is no evidence. Runs with --exclusive are timed alone.";
  const bool is_by_calls = c.yardstick.by == Measure::work || c.yardstick.by == Measure::cost;
  if (!is_by_calls || !has_order(c)) return "";
  const auto priced = static_cast<std::size_t>(std::ranges::count_if(
      c.order.settings, [&](std::size_t p) { return c.problems[p].prices.are_measured(); }));
  if (priced == 0)
    return "These results cannot say whether the order holds at measured prices: none was measured "
           "here, or calls are too short to be.";
  const std::vector<std::string> declared = first_by(c, Measure::work),
                                 measured = first_by(c, Measure::cost);
  if (declared.empty() && measured.empty()) return "";
  const std::string where = fmt::format("measured prices (told on {} of {}, declared elsewhere)",
                                        priced, counted(c.order.settings.size(), common_noun(c)));
  if (declared == measured)
    return fmt::format("At declared prices and at {} the first are the same: {}.", where,
                       joined(declared));
  const bool is_same_first = !declared.empty() && !measured.empty() && declared[0] == measured[0];
  return fmt::format("The order {} at both prices: at declared ones the first are {}; at {}, {}.",
                     is_same_first ? "below the first does not hold" : "does not hold",
                     joined(declared), where, joined(measured));
}

}  // namespace isoline::reports
