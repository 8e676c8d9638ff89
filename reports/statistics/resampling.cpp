// Intervals of medians, means and ratios over resamples.
#include "reports/statistics/resampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/digest.h"
#include "core/draws.h"

namespace isoline::reports {
namespace {

template <class Statistic>
Interval bootstrap(const std::vector<Real>& values, const std::string& key, Statistic statistic) {
  if (values.empty()) return {};
  std::vector<Real> all, sample(values.size());
  resample(values.size(), {fnv1a(key), "report", "bootstrap"}, [&](const Places& places) {
    for (std::size_t i = 0; i < sample.size(); ++i) sample[i] = values[places[i]];
    all.push_back(statistic(sample));
  });
  return interval_of(std::move(all));
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

Interval bootstrap_mean(const std::vector<Real>& values, const std::string& key) {
  if (!values.empty() && values.size() < kFewestForInterval)
    return {std::ranges::min(values), std::ranges::max(values)};
  return bootstrap(values, key, [](const std::vector<Real>& some) {
    return std::accumulate(some.begin(), some.end(), 0.0) / Real(some.size());
  });
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

}  // namespace isoline::reports
