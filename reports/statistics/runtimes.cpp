// Running times, restarts, areas and resamples.
#include "reports/statistics/runtimes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/digest.h"
#include "core/random.h"

namespace isoline::reports {
namespace {

constexpr Real kTail = 0.025;  // on either side of 95 %

std::size_t drawn(RandomStream& random, std::size_t count) {
  return static_cast<std::size_t>(random.uniform() * Real(count));
}

template <class Statistic>
Interval bootstrap(const std::vector<Real>& values, const std::string& key, Statistic statistic) {
  if (values.empty()) return {};
  std::vector<Real> all, sample(values.size());
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    RandomStream random(fnv1a(key), "report", "bootstrap", draw);
    for (Real& value : sample) value = values[drawn(random, values.size())];
    all.push_back(statistic(sample));
  }
  std::ranges::sort(all);
  return {quantile(all, kTail), quantile(all, 1 - kTail)};
}

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
    RandomStream random(fnv1a(key), "report", "restarts", draw);
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

Interval bootstrap_median(const std::vector<Real>& values, const std::string& key) {
  return bootstrap(values, key, [](const std::vector<Real>& some) { return median_of(some); });
}

Interval bootstrap_mean(const std::vector<Real>& values, const std::string& key) {
  return bootstrap(values, key, [](const std::vector<Real>& some) {
    return std::accumulate(some.begin(), some.end(), 0.0) / Real(some.size());
  });
}

Band bootstrap_ratio(const std::vector<GroupSum>& groups, const std::string& key) {
  GroupSum all;
  for (const GroupSum& group : groups) add(all, group);
  std::vector<std::vector<Real>> draws(all.sums.size());  // by component
  for (std::size_t draw = 0; draw < kDraws && !groups.empty(); ++draw) {
    RandomStream random(fnv1a(key), "report", "groups", draw);
    GroupSum sample;
    for (std::size_t i = 0; i < groups.size(); ++i)
      add(sample, groups[drawn(random, groups.size())]);
    const std::vector<Real> ratios = ratios_of(sample);
    for (std::size_t i = 0; i < ratios.size(); ++i) draws[i].push_back(ratios[i]);
  }
  Band band{.value = ratios_of(all), .low = {}, .high = {}};
  for (std::vector<Real>& values : draws) {
    std::ranges::sort(values);
    band.low.push_back(quantile(values, kTail));
    band.high.push_back(quantile(values, 1 - kTail));
  }
  return band;
}

Real quantile(const std::vector<Real>& ascending, Real share) {
  const Real place = std::ceil(share * Real(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
}

std::vector<Real> mid_ranks(const std::vector<Real>& costs) {
  std::vector<Real> ranks;
  for (const Real cost : costs) {
    const auto below = std::ranges::count_if(costs, [&](Real other) { return other < cost; });
    const auto equal = std::ranges::count(costs, cost);
    ranks.push_back(Real(below) + (Real(equal) + 1) / 2);
  }
  return ranks;
}

Real accuracy(Real loss, Real start, Real minimum) {
  constexpr Real kMost = 16;  // digits of double precision
  if (!std::isfinite(loss)) return -kNever;
  const Real share = (loss - minimum) / (start - minimum);
  return share > 0 ? std::min(kMost, -std::log10(share)) : kMost;
}

}  // namespace isoline::reports
