// Ranks and ratios by problem.
#include "reports/statistics/orders.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

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

std::vector<Real> values_of(const std::map<std::string, Real>& ratios) {
  std::vector<Real> values;
  for (const auto& [name, value] : ratios) values.push_back(value);
  return values;
}

}  // namespace

Costs costs_of(const Comparison& c, std::array<Spread, kTolerances.size()> Cell::*what) {
  Costs costs;
  for (const auto& row : c.cells) {
    costs.emplace_back();
    for (const Cell& cell : row)
      costs.back().push_back(
          cell.planned == 0 ? std::nullopt : std::optional<Real>((cell.*what)[kTightest].median));
  }
  return costs;
}

std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& c, const Costs& costs) {
  std::map<std::string, std::vector<Real>> sum;
  std::map<std::string, Real> count;
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

Real least_gap(std::size_t optimizers, std::size_t problems) {
  const Real k = Real(optimizers);
  return nemenyi_quantile(optimizers) * std::sqrt(k * (k + 1) / (6 * Real(problems)));
}

std::map<std::string, Real> log_ratios(const Comparison& c, const Costs& costs, std::size_t a,
                                       std::size_t b) {
  std::map<std::string, std::vector<Real>> by_name;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    if (!costs[p][a] || !costs[p][b]) continue;
    const Real left = std::max(*costs[p][a], 1.0), right = std::max(*costs[p][b], 1.0);
    by_name[c.problems[p].name()].push_back(left == right ? 0 : std::log(left) - std::log(right));
  }
  std::map<std::string, Real> ratios;
  for (auto& [name, values] : by_name) {
    std::ranges::sort(values);
    ratios[name] = values[(values.size() - 1) / 2];  // the lower: two infinities have no mean
  }
  return ratios;
}

Real lacking_digits(const Comparison& c, const Cell& cell, Real Summary::*loss) {
  if (!cell.is_measured()) return kNever;
  std::vector<Real> lacking;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Summary& summary = run.record->summary;
    lacking.push_back(is_failure(run.record->status)
                          ? kNever
                          : -accuracy(summary.*loss, summary.start_loss, run.minimum));
  }
  return median_of(lacking);
}

std::vector<Real> lacking_digits(const Comparison& c, std::size_t s, Real Summary::*loss) {
  std::vector<Real> all;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (c.cell(p, s).planned > 0) all.push_back(lacking_digits(c, c.cell(p, s), loss));
  return all;
}

SignedRanks signed_ranks(const Comparison& c, std::size_t k) {
  const Costs costs = costs_of(c, &Cell::work);
  SignedRanks all;
  std::vector<Real> p;
  for (std::size_t a = 0; a < k; ++a)
    for (std::size_t b = a + 1; b < k; ++b) {
      const std::vector<Real> ratios = values_of(log_ratios(c, costs, a, b));
      p.push_back(signed_rank_p(ratios));
      const auto wins = std::ranges::count_if(ratios, [](Real r) { return r < 0; });
      all.pairs.push_back({a, b, p.back(), 1, static_cast<std::size_t>(wins), ratios.size()});
    }
  const std::vector<Real> adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    all.pairs[i].adjusted = adjusted[i];
    all.told += adjusted[i] <= kSignificant;
    all.least = std::min(all.least, adjusted[i]);
  }
  return all;
}

}  // namespace isoline::reports
