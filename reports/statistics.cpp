// Medians that keep failures, and performance profiles.
#include "reports/statistics.h"

#include <algorithm>
#include <cmath>

namespace isoline {

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

Real Profile::share(std::size_t solver, Real factor) const {
  if (problems == 0) return 0;
  const auto& ratios = solvers[solver].ratios;
  const auto within = std::upper_bound(ratios.begin(), ratios.end(), factor) - ratios.begin();
  return static_cast<Real>(within) / static_cast<Real>(problems);
}

Real Profile::area(std::size_t solver, Real most) const {
  if (problems == 0) return 0;
  Real sum = 0;
  for (const Real ratio : solvers[solver].ratios)
    sum += std::max(0.0, std::log2(most) - std::log2(ratio)) / std::log2(most);
  return sum / static_cast<Real>(problems);
}

Profile performance_profile(const std::vector<std::vector<Real>>& costs) {
  constexpr Real kUnit = 1;
  Profile profile;
  profile.problems = costs.size();
  for (const std::vector<Real>& row : costs) {
    profile.solvers.resize(std::max(profile.solvers.size(), row.size()));
    Real least = kNever;
    for (const Real cost : row)
      if (cost < least) least = cost;  // false for not-a-number
    for (std::size_t s = 0; s < row.size(); ++s)
      if (row[s] < kNever)
        profile.solvers[s].ratios.push_back(std::max(row[s], kUnit) / std::max(least, kUnit));
  }
  for (ProfileLine& line : profile.solvers) std::sort(line.ratios.begin(), line.ratios.end());
  return profile;
}

}  // namespace isoline
