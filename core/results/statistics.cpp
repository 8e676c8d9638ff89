// Medians that keep failures, performance profiles, running times and the bootstrap.
#include "core/results/statistics.h"

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "core/draws.h"

namespace isoline::results {

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

// Intervals of medians, means and ratios over resamples.

namespace {

void add(GroupSum& all, const GroupSum& some) {
  all.sums.resize(some.sums.size(), 0);
  for (std::size_t i = 0; i < some.sums.size(); ++i) all.sums[i] += some.sums[i];
  all.n += some.n;
}

std::vector<Real> ratios_of(const GroupSum& all) {
  std::vector<Real> ratios;
  for (const Real sum : all.sums) ratios.push_back(all.n > 0 ? sum / all.n : 0);
  return ratios;
}

}  // namespace

void resample(std::size_t count, const DrawStream& from,
              const std::function<void(const Places&)>& use) {
  Places places(count);
  Draws random(from.seed, from.component, from.purpose);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    if (!from.is_for_all) random.restart(draw);
    for (std::size_t& place : places)
      place = static_cast<std::size_t>(random.uniform() * Real(count));
    use(places);
  }
}

Real quantile(const std::vector<Real>& ascending, Real share) {
  const Real place = std::ceil(share * Real(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
}

Interval interval_of(std::vector<Real> draws) {
  constexpr Real kTail = 0.025;
  std::ranges::sort(draws);
  return {quantile(draws, kTail), quantile(draws, 1 - kTail)};
}

Band bootstrap_ratio(const std::vector<GroupSum>& groups, const std::string& key) {
  GroupSum all;
  for (const GroupSum& group : groups) add(all, group);
  Band band{.value = ratios_of(all), .low = {}, .high = {}};
  if (groups.empty()) return band;
  std::vector<std::vector<Real>> draws(all.sums.size());  // by component
  resample(groups.size(), {fnv1a(key), "report", "groups"}, [&](const Places& places) {
    GroupSum sample;
    for (const std::size_t place : places) add(sample, groups[place]);
    const std::vector<Real> ratios = ratios_of(sample);
    for (std::size_t i = 0; i < ratios.size(); ++i) draws[i].push_back(ratios[i]);
  });
  for (std::vector<Real>& values : draws) {
    const Interval interval = interval_of(std::move(values));
    band.low.push_back(interval.low);
    band.high.push_back(interval.high);
  }
  return band;
}

}  // namespace isoline::results
