// Ranks and ratios by problem.
#include "reports/read/orders.h"

#include <algorithm>
#include <cmath>

#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {

std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& c, const Costs& costs) {
  std::map<std::string, std::vector<Real>> all;
  for (const auto& [name, problems] : problems_by_name(c)) {
    std::vector<Real> sum;
    Real count = 0;
    for (const std::size_t p : problems) {
      if (!std::ranges::all_of(costs[p], [](const auto& cost) { return cost.has_value(); }))
        continue;
      std::vector<Real> values;
      for (const auto& cost : costs[p]) values.push_back(*cost);
      const std::vector<Real> ranks = mid_ranks(values);
      sum.resize(ranks.size(), 0);
      for (std::size_t s = 0; s < ranks.size(); ++s) sum[s] += ranks[s];
      count += 1;
    }
    for (Real& rank : sum) rank /= count;
    if (count > 0) all.emplace(name, std::move(sum));
  }
  return all;
}

std::vector<Real> log_ratios(const Comparison& c, const Costs& costs, std::size_t a,
                             std::size_t b) {
  std::vector<Real> ratios;
  for (const auto& [name, problems] : problems_by_name(c)) {
    std::vector<Real> values;
    for (const std::size_t p : problems) {
      if (!costs[p][a] || !costs[p][b]) continue;
      const Real left = std::max(*costs[p][a], 1.0), right = std::max(*costs[p][b], 1.0);
      values.push_back(left == right ? 0 : std::log(left) - std::log(right));
    }
    if (values.empty()) continue;
    std::ranges::sort(values);
    ratios.push_back(values[(values.size() - 1) / 2]);  // the lower: two infinities have no mean
  }
  return ratios;
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
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (c.cell(p, s).planned > 0) all.push_back(lacking_digits(c, c.cell(p, s), loss));
  return all;
}

SignedRanks signed_ranks(const Comparison& c, std::size_t k) {
  const Costs costs = median_costs(c, kTightest);
  SignedRanks all;
  std::vector<Real> p;
  for (std::size_t a = 0; a < k; ++a)
    for (std::size_t b = a + 1; b < k; ++b) {
      const std::vector<Real> ratios = log_ratios(c, costs, a, b);
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
