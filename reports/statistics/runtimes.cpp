// Running times, restarts, areas and digits.
#include "reports/statistics/runtimes.h"

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "core/random.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {
namespace {

std::size_t drawn(Draws& random, std::size_t count) {
  return static_cast<std::size_t>(random.uniform() * Real(count));
}

}  // namespace

Real expected_running_time(const std::vector<Attempt>& attempts) {
  Real spent = 0, successes = 0;
  for (const Attempt& attempt : attempts) {
    spent += attempt.cost;
    successes += attempt.is_success;
  }
  return successes > 0 ? spent / successes : kNever;
}

std::vector<Real> simulated_restarts(const std::vector<Attempt>& attempts, const std::string& key) {
  if (std::ranges::none_of(attempts, &Attempt::is_success))
    return std::vector<Real>(kDraws, kNever);
  std::vector<Real> costs;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    Draws random(fnv1a(key), "report", "restarts", draw);
    Real cost = 0;
    while (true) {
      const Attempt& attempt = attempts[drawn(random, attempts.size())];
      cost += attempt.cost;
      if (attempt.is_success) break;
    }
    costs.push_back(cost);
  }
  std::ranges::sort(costs);
  return costs;
}

Real area_over_curve(const std::vector<Real>& work, const std::vector<Real>& gap, Real budget,
                     Real digits) {
  Real area = 0, best = 1;
  for (std::size_t i = 0; i < work.size() && work[i] < budget; ++i) {
    if (gap[i] < best) best = gap[i];  // false for not-a-number
    const Real end = i + 1 < work.size() ? std::min(work[i + 1], budget) : budget;
    const Real depth = best > 0 ? -std::log10(best) / digits : 1;
    area += (end - work[i]) * std::clamp(depth, 0.0, 1.0);
  }
  return budget > 0 ? area / budget : 0;
}

}  // namespace isoline::reports
