// Order statistics of subsets.
#include "reports/statistics/best_of.h"

#include <algorithm>

namespace isoline::reports {

std::vector<Real> expected_best(std::vector<Real> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  std::vector<Real> best;
  for (std::size_t b = 1; b <= n; ++b) {
    // The chance that the i-th is the greatest of b, from the last one down: b / n, and each
    // further one (i − b) / (i − 1) times the chance of the one above it.
    Real chance = Real(b) / Real(n), sum = 0;
    for (std::size_t i = n; i >= b; --i) {
      sum += chance * values[i - 1];
      if (i > b) chance *= Real(i - b) / Real(i - 1);
    }
    best.push_back(sum);
  }
  return best;
}

}  // namespace isoline::reports
