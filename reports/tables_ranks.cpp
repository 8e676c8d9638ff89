// Orders over problems: mean ranks, signed ranks, and what so few problems cannot show.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "reports/rank_tests.h"
#include "reports/runtimes.h"
#include "reports/tables.h"
#include "reports/text.h"

namespace isoline {
namespace {

// Mean ranks of each optimizer by name of problem, on problems that were given to all of them.
// Settings of one problem are no two witnesses: their ranks are averaged.
std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& c) {
  std::map<std::string, std::vector<Real>> sum;
  std::map<std::string, Real> count;
  const Costs costs = tightest_costs(c);
  for (std::size_t p = 0; p < costs.size(); ++p) {
    if (!std::ranges::all_of(costs[p], [](const auto& cost) { return cost.has_value(); })) continue;
    std::vector<Real> values;
    for (const auto& cost : costs[p]) values.push_back(*cost);
    const std::vector<Real> ranks = mid_ranks(values);
    auto& total =
        sum.emplace(c.problems[p].name(), std::vector<Real>(ranks.size(), 0)).first->second;
    for (std::size_t s = 0; s < ranks.size(); ++s) total[s] += ranks[s];
    count[c.problems[p].name()] += 1;
  }
  for (auto& [name, ranks] : sum)
    for (Real& rank : ranks) rank /= count[name];
  return sum;
}

// q at 0.05 over √2 for k optimizers: scipy.stats.studentized_range.ppf(0.95, k, inf) / 2**0.5.
Real nemenyi_quantile(std::size_t k) {
  constexpr std::array<Real, 13> kSmall = {0,     0,     1.960, 2.344, 2.569, 2.728, 2.850,
                                           2.948, 3.031, 3.102, 3.164, 3.219, 3.268};
  constexpr std::array<std::pair<std::size_t, Real>, 7> kLarge = {
      {{15, 3.391}, {20, 3.544}, {30, 3.749}, {40, 3.888}, {60, 4.076}, {100, 4.302}, {400, 4.7}}};
  if (k < kSmall.size()) return kSmall[k];
  for (const auto& [size, quantile] : kLarge)
    if (k <= size)
      return quantile;  // of the next larger size: no gap is called resolvable that is not
  return kLarge.back().second;
}

Real least_gap(std::size_t optimizers, std::size_t problems) {
  const Real k = Real(optimizers);
  return nemenyi_quantile(optimizers) * std::sqrt(k * (k + 1) / (6 * Real(problems)));
}

// log(cost of a / cost of b) by name of problem, where both were asked; 0 where neither solves it.
std::vector<Real> log_ratios(const Comparison& c, const Costs& costs, std::size_t a,
                             std::size_t b) {
  std::map<std::string, std::vector<Real>> by_name;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    if (!costs[p][a] || !costs[p][b]) continue;
    const Real left = std::max(*costs[p][a], 1.0), right = std::max(*costs[p][b], 1.0);
    by_name[c.problems[p].name()].push_back(left == right ? 0 : std::log(left) - std::log(right));
  }
  std::vector<Real> ratios;
  for (auto& [name, values] : by_name) {
    std::ranges::sort(values);
    ratios.push_back(
        values[(values.size() - 1) / 2]);  // the lower median: two infinities have no mean
  }
  return ratios;
}

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

}  // namespace

StatisticTable rank_table(const Comparison& c) {
  const auto ranks = ranks_by_name(c);
  StatisticTable table{
      .id = "mean-rank",
      .title = "Mean rank",
      .reading = "",
      .caption =
          "Rank by median work to 1e-6, 1 the best, ties shared, unsolved ones last; mean over "
          "the problems given to every optimizer, with the 95 % bootstrap interval over "
          "problems (1,000 draws). Failed: runs that went wrong, of all.",
      .columns = {"optimizer", "mean rank", "interval", "n problems", "failed"},
      .rows = {}};
  std::vector<Real> means;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::vector<Real> own;
    for (const auto& [name, rank] : ranks) own.push_back(rank[s]);
    Real sum = 0;
    for (const Real rank : own) sum += rank;
    means.push_back(own.empty() ? kNever : sum / Real(own.size()));
    if (s >= kMostTableRows) continue;
    const Interval interval = bootstrap_mean(own, "ranks");
    table.rows.push_back(
        {optimizer_text(c, s), own.empty() ? "" : fmt::format("{:.3g}", means.back()),
         own.size() < 2 ? "" : fmt::format("{:.3g}–{:.3g}", interval.low, interval.high),
         std::to_string(own.size()), failed_text(c, s)});
  }
  table.reading = rank_reading(c, means, ranks.size());
  return table;
}

StatisticTable signed_rank_table(const Comparison& c) {
  const std::size_t k = shown_optimizers(c, kMostTablePairs);
  const Costs costs = tightest_costs(c);
  StatisticTable table{
      .id = "signed-rank",
      .title = "Pairs, by signed ranks",
      .reading = "",
      .caption =
          "Wilcoxon's signed ranks on the logarithm of the ratio of median work to 1e-6, one "
          "ratio a problem, unsolved counting as infinite; p after Holm over all pairs shown. "
          "In the cell: p, and on how many problems the row needs less work, of n.",
      .columns = {"optimizer"},
      .rows = {}};
  std::vector<Real> p;
  std::vector<std::string> wins;
  for (std::size_t a = 0; a < k; ++a) {
    table.columns.push_back(optimizer_text(c, a));
    for (std::size_t b = a + 1; b < k; ++b) {
      const std::vector<Real> ratios = log_ratios(c, costs, a, b);
      p.push_back(signed_rank_p(ratios));
      wins.push_back(fmt::format(
          "{}/{}", std::ranges::count_if(ratios, [](Real r) { return r < 0; }), ratios.size()));
    }
  }
  const std::vector<Real> adjusted = holm(p);
  std::size_t pair = 0, told = 0;
  for (std::size_t a = 0; a < k; ++a) {
    std::vector<std::string> row(k + 1);
    row[0] = optimizer_text(c, a);
    for (std::size_t b = a + 1; b < k; ++b, ++pair) {
      told += adjusted[pair] <= 0.05;
      row[b + 1] = fmt::format("{:.2g} ({})", adjusted[pair], wins[pair]);
    }
    table.rows.push_back(std::move(row));
  }
  table.reading = fmt::format(
      "Of {} pairs among the first {}, {} can be told apart at 0.05; the least adjusted p is {}.",
      p.size(), k, told,
      p.empty() ? "none" : fmt::format("{:.2g}", *std::ranges::min_element(adjusted)));
  return table;
}

std::vector<std::string> limits_of_evidence(const Comparison& c) {
  std::vector<std::string> all;
  const std::size_t k = c.optimizers.size(), names = c.names, complete = ranks_by_name(c).size();
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

}  // namespace isoline
