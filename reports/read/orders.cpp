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

}  // namespace isoline::reports
