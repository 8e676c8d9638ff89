// Ranks and ratios by problem.
#include "reports/read/orders.h"

#include <algorithm>
#include <cmath>

#include "reports/read/grounds.h"
#include "reports/statistics/friedman.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {

std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& c, Measure by) {
  const Costs costs = common_costs(c, kTightest, by);
  std::map<std::string, std::vector<Real>> sums;
  for (const std::size_t p : c.order.settings) {
    std::vector<Real> values;
    for (const std::size_t s : c.order.methods) values.push_back(*costs[p][s]);
    const std::vector<Real> ranks = mid_ranks(values);
    std::vector<Real>& sum = sums[c.problems[p].name];
    sum.resize(ranks.size(), 0);
    for (std::size_t i = 0; i < ranks.size(); ++i) sum[i] += ranks[i];
  }
  for (auto& [name, sum] : sums) sum = mid_ranks(sum);
  return sums;
}

Real friedman_of(const Comparison& c) {
  const std::vector<bool> is_in = family_of(c, c.order);
  std::vector<std::vector<Real>> blocks;
  for (const auto& [name, ranks] : ranks_by_name(c, c.yardstick.by)) {
    std::vector<Real>& block = blocks.emplace_back();
    for (std::size_t i = 0; i < ranks.size(); ++i)
      if (is_in[c.order.methods[i]]) block.push_back(ranks[i]);
  }
  return friedman_p(blocks);
}

Real lacking_digits(const Comparison& c, const Cell& cell, Real Summary::*loss) {
  if (!cell.is_measured()) return kNever;
  std::vector<Real> lacking;
  for (const std::size_t index : cell.runs) {
    const Run& run = c.runs[index];
    const Summary& summary = run.record->summary;
    const Real scale = run.record->scale.value_or(summary.start_loss - run.minimum);
    const Real digits =
        accuracy(summary.*loss, run.minimum, scale, run.record->request.budget.target);
    lacking.push_back(is_failure(run.record->status) ? kNever : -digits);
  }
  return median_of(lacking);
}

std::vector<Real> lacking_digits(const Comparison& c, std::size_t s, Real Summary::*loss) {
  std::vector<Real> all;
  const bool is_ranked = c.order.has(s);
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const bool is_common = std::ranges::find(c.order.settings, p) != c.order.settings.end();
    if (c.cell(p, s).planned > 0 && (is_common || !is_ranked))
      all.push_back(lacking_digits(c, c.cell(p, s), loss));
  }
  return all;
}

SignedRanks signed_ranks(const Comparison& c, std::size_t k) {
  const Costs costs = common_costs(c, kTightest);
  const Groups groups = groups_of(c);
  SignedRanks all;
  std::vector<Real> p;
  for (std::size_t a = 0; a < k; ++a)
    for (std::size_t b = a + 1; b < k; ++b) {
      const Pairing pairing = pairing_of(costs, groups, a, b);
      p.push_back(signed_rank_p(pairing.doublings));
      all.pairs.push_back({a, b, p.back(), 1, pairing.wins, pairing.doublings.size()});
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
