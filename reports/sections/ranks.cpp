// Orders over problems: mean ranks, signed ranks, and what so few problems cannot show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

std::string rank_reading(const Comparison& c, const std::vector<Real>& means, std::size_t names) {
  if (names == 0) return "No problem was given to every method: ranks are not defined.";
  const auto best = static_cast<std::size_t>(std::ranges::min_element(means) - means.begin());
  return fmt::format(
      "{} has the least mean rank, {:.3g} of {}, over {}; Nemenyi’s test of all pairs resolves no "
      "gap below {:.3g}.",
      optimizer_text(c, best), means[best], means.size(), counted(names, "problem"),
      least_gap(means.size(), names));
}

std::vector<Real> of_optimizer(const std::map<std::string, std::vector<Real>>& ranks,
                               std::size_t s) {
  std::vector<Real> own;
  for (const auto& [name, rank] : ranks) own.push_back(rank[s]);
  return own;
}

Real mean_of(const std::vector<Real>& values) {
  if (values.empty()) return kNever;
  return std::accumulate(values.begin(), values.end(), 0.0) / Real(values.size());
}

TableCell rank_cell(Real mean) {
  if (mean == kNever) return "";
  return {fmt::format("{:.3g}", mean), {{"mean", mean}}};
}

TableCell interval_cell(const Interval& interval) {
  return {fmt::format("{:.3g}–{:.3g}", interval.low, interval.high),
          {{"low", interval.low}, {"high", interval.high}}};
}

}  // namespace

Table rank_table(const Comparison& c) {
  const auto ranks = ranks_by_name(c, c.yardstick.by), measured = ranks_by_name(c, Measure::cost);
  Table table{
      .id = "mean-rank",
      .title = "Mean rank",
      .reading = "",
      .caption = fmt::format(
          "Rank by median {} to {}, 1 the best, ties shared, unsolved ones last; settings of one "
          "problem have one rank. Mean over the problems given to all ranked methods, with its {} "
          "over problems. By cost: the same by {}. Failed: failed runs, of all.",
          counted_name(c), tau_name(c), interval_name(ranks.size()), cost_unit(c)),
      .columns = {"optimizer", "mean rank", "interval", "by cost", "n problems", "failed"},
      .rows = {}};
  std::vector<Real> means;
  for (std::size_t s = 0; s < c.order.methods.size(); ++s) {
    const std::vector<Real> own = of_optimizer(ranks, s);
    means.push_back(mean_of(own));
    if (s >= kMostTableRows) continue;
    const Interval interval = bootstrap_mean(own, "ranks");
    table.rows.push_back({optimizer_text(c, s), rank_cell(means.back()),
                          own.size() < 2 ? TableCell("") : interval_cell(interval),
                          rank_cell(mean_of(of_optimizer(measured, s))), count_cell(own.size()),
                          failed_cell(c, s)});
  }
  rows_are_optimizers(table);
  table.reading = rank_reading(c, means, ranks.size());
  return table;
}

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

Table signed_rank_table(const Comparison& c) {
  const std::size_t k = shown_optimizers(c, kMostTablePairs);
  Table table{
      .id = "signed-rank",
      .title = "Pairs of the best, by signed ranks",
      .reading = "",
      .caption = fmt::format(
          "Wilcoxon’s signed ranks on the doublings of median {} to {}, one a problem, solving "
          "against not solving counting as 6; p after Holm over all pairs shown. In the cell: p, "
          "and on how many problems the row needs less, of n. The best are the most alike: the "
          "leader against each of the others is told above.",
          counted_name(c), tau_name(c)),
      .columns = {"optimizer"},
      .rows = {}};
  for (std::size_t s = 0; s < k; ++s) {
    table.columns.push_back(optimizer_text(c, s));
    table.rows.push_back({optimizer_text(c, s)});
    table.rows.back().resize(k + 1, "");
    table.rows.back().push_back(failed_cell(c, s));
  }
  table.columns.push_back("failed");
  rows_are_optimizers(table);
  columns_are_optimizers(table, k);
  const SignedRanks ranked = signed_ranks(c, k);
  for (const RankedPair& pair : ranked.pairs)
    table.rows[pair.a][pair.b + 1] = {
        fmt::format("{:.2g} ({}/{})", pair.adjusted, pair.wins, pair.n),
        {{"adjusted_p", pair.adjusted},
         {"wins", Real(pair.wins)},
         {"n", Real(pair.n)},
         {"p", pair.p}}};
  table.reading = fmt::format(
      "Of {} pairs among the first {}, {} can be told apart at 0.05; the least adjusted p is {}.",
      ranked.pairs.size(), k, ranked.told,
      ranked.pairs.empty() ? "none" : fmt::format("{:.2g}", ranked.least));
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
  all.push_back(
      fmt::format("Mean ranks of {} over {}: Nemenyi’s test of all pairs resolves no gap below "
                  "{:.3g} at 0.05.",
                  counted(k, "method"), counted(names, "problem"), least_gap(k, names)));
  if (c.seeds.size() < kFewestForInterval)
    all.push_back(
        fmt::format("With {} no interval over seeds reaches 95 %: ranges are shown instead.",
                    counted(c.seeds.size(), "seed")));
  all.push_back("Nothing here speaks for problems unlike these: they were chosen, not drawn.");
  return all;
}

}  // namespace isoline::reports
