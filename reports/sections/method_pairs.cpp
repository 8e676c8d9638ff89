// Pairs over the problems that both were given.
#include "reports/sections/method_pairs.h"

#include "reports/read/grounds.h"

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

}  // namespace isoline::reports
