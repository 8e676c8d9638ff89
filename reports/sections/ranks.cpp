// Orders over problems: mean ranks, signed ranks, and what so few problems cannot show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

std::string rank_reading(const Comparison& c, const std::vector<Real>& means, std::size_t names) {
  if (names == 0) return "No problem was given to every optimizer: no rank has a meaning.";
  const auto best = static_cast<std::size_t>(std::ranges::min_element(means) - means.begin());
  return fmt::format(
      "{} has the least mean rank, {:.3g} of {}, over {} problem{}; gaps below {:.3g} cannot be "
      "told "
      "from chance.",
      optimizer_text(c, best), means[best], means.size(), names, names == 1 ? "" : "s",
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
  const auto ranks = ranks_by_name(c, median_costs(c, kTightest));
  const auto measured = ranks_by_name(c, median_costs(c, kTightest, Measure::cost));
  Table table{
      .id = "mean-rank",
      .title = "Mean rank",
      .reading = "",
      .caption =
          "Rank by median declared work to 1e-6, 1 the best, ties shared, unsolved ones last; mean "
          "over the problems given to every optimizer, with the 95 % bootstrap interval over "
          "problems (1,000 draws). By cost: the same by " +
          cost_unit(c) + ". Failed: runs that went wrong, of all.",
      .columns = {"optimizer", "mean rank", "interval", "by cost", "n problems", "failed"},
      .rows = {}};
  std::vector<Real> means;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
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

Table signed_rank_table(const Comparison& c) {
  const std::size_t k = shown_optimizers(c, kMostTablePairs);
  Table table{
      .id = "signed-rank",
      .title = "Pairs, by signed ranks",
      .reading = "",
      .caption =
          "Wilcoxon's signed ranks on the logarithm of the ratio of median declared work to 1e-6, "
          "one ratio a problem, unsolved counting as infinite; p after Holm over all pairs shown. "
          "In the cell: p, and on how many problems the row needs less work, of n.",
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
  const std::size_t k = c.optimizers.size(), names = c.names,
                    complete = ranks_by_name(c, median_costs(c, kTightest)).size();
  if (k < 2 || names == 0) return all;
  if (complete >= 2)
    all.push_back(fmt::format(
        "{} problems given to all, {} optimizers: mean-rank gaps below {:.3g} are not resolvable "
        "(Nemenyi at 0.05).",
        complete, k, least_gap(k, complete)));
  const Real least = std::min(1.0, 2 * std::pow(0.5, Real(names)));
  const std::size_t shown = shown_optimizers(c, kMostTablePairs), pairs = shown * (shown - 1) / 2;
  const bool is_hopeless = least * Real(pairs) > 0.05;
  all.push_back(fmt::format(
      "With {} problem{} the least p that signed ranks can give is {:.2g}, after Holm over {} "
      "pairs "
      "{:.2g}: {}.",
      names, names == 1 ? "" : "s", least, pairs, std::min(1.0, least * Real(pairs)),
      is_hopeless ? "no pair of methods can be told apart at 0.05, whatever their results"
                  : "only nearly unanimous pairs can be told apart"));
  constexpr std::size_t kFewSeeds = 6;  // 2/2⁶ is the first below 0.05
  if (c.seeds.size() < kFewSeeds)
    all.push_back(fmt::format(
        "With {} seed{} no interval over seeds reaches 95 %: the ranges shown are all there is.",
        c.seeds.size(), c.seeds.size() == 1 ? "" : "s"));
  all.push_back("Nothing here speaks for problems unlike these: they were chosen, not drawn.");
  return all;
}

}  // namespace isoline::reports
