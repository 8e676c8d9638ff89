// Medians that keep failures, and performance profiles.
#include "reports/statistics/statistics.h"

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "core/draws.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {

Spread spread_of(std::vector<Real> values) {
  Spread spread;
  spread.n = values.size();
  if (values.empty()) return spread;
  for (Real& value : values)
    if (std::isnan(value)) value = kNever;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  spread.low = values.front();
  spread.high = values.back();
  spread.median = values.size() % 2 == 1 ? values[half] : values[half - 1] / 2 + values[half] / 2;
  spread.unsolved = static_cast<std::size_t>(std::ranges::count(values, kNever));
  return spread;
}

Real median_of(std::vector<Real> values) { return spread_of(std::move(values)).median; }

Real score_of(Real ratio, Real most) {
  return std::max(0.0, std::log2(most) - std::log2(ratio)) / std::log2(most);
}

Real Profile::share(std::size_t solver, Real factor) const {
  const auto& [ratios, problems] = solvers[solver];
  if (problems == 0) return 0;
  const auto within = std::upper_bound(ratios.begin(), ratios.end(), factor) - ratios.begin();
  return static_cast<Real>(within) / static_cast<Real>(problems);
}

Real Profile::area(std::size_t solver, Real most) const {
  const auto& [ratios, problems] = solvers[solver];
  if (problems == 0) return 0;
  Real sum = 0;
  for (const Real ratio : ratios) sum += score_of(ratio, most);
  return sum / static_cast<Real>(problems);
}

std::vector<std::optional<Real>> cost_ratios(const std::vector<std::optional<Real>>& costs) {
  constexpr Real kUnit = 1;
  Real least = kNever;
  for (const std::optional<Real>& cost : costs)
    if (cost && *cost < least) least = *cost;  // false for not-a-number
  std::vector<std::optional<Real>> ratios(costs.size());
  for (std::size_t s = 0; s < costs.size(); ++s)
    if (costs[s])
      ratios[s] = *costs[s] < kNever ? std::max(*costs[s], kUnit) / std::max(least, kUnit) : kNever;
  return ratios;
}

Profile performance_profile(const Costs& costs) {
  Profile profile;
  for (const auto& row : costs) {
    profile.solvers.resize(std::max(profile.solvers.size(), row.size()));
    const auto ratios = cost_ratios(row);
    for (std::size_t s = 0; s < row.size(); ++s) {
      if (!ratios[s]) continue;
      ++profile.solvers[s].problems;
      if (*ratios[s] < kNever) profile.solvers[s].ratios.push_back(*ratios[s]);
    }
  }
  for (ProfileLine& line : profile.solvers) std::sort(line.ratios.begin(), line.ratios.end());
  return profile;
}

// Order statistics of subsets.

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

// Running times, restarts, areas and digits.

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

}  // namespace isoline::reports
