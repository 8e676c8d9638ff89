// Medians that keep failures, and performance profiles.
#include "reports/statistics/statistics.h"

#include <algorithm>
#include <cmath>

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

}  // namespace isoline::reports
