// The bootstrap of reports: what a statistic comes to when its data are drawn anew. Efron (1979).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "reports/statistics/statistics.h"

namespace isoline::reports {

inline constexpr std::size_t kDraws = 1000;

// Where draws come from: a random stream each, or one for all of them.
struct DrawStream {
  std::uint64_t seed = 0;
  std::string component, purpose;
  bool is_for_all = false;
};

// The one loop: kDraws times use(places), `count` of the places 0 … count − 1 with replacement.
using Places = std::vector<std::size_t>;
void resample(std::size_t count, const DrawStream& from,
              const std::function<void(const Places&)>& use);

Real quantile(const std::vector<Real>& ascending, Real share);  // the nearest rank

// 95 % of what was drawn, by percentiles. Values may be infinite.
struct Interval {
  Real low = kNever, high = kNever;
};
Interval interval_of(std::vector<Real> draws);

// So many values are the fewest that can give 95 %: 2/2⁶ is the first below 0.05.
inline constexpr std::size_t kFewestForInterval = 6;

// Of the mean of values; of fewer values, their range. The key names the stream.
Interval bootstrap_mean(const std::vector<Real>& values, const std::string& key);

// Ratios of two sums over groups, as a share of problems is: value, and 95 % of the resamples of
// whole groups, for each component of the numerators.
struct GroupSum {
  std::vector<Real> sums;  // of the numerators
  Real n = 0;              // of the denominator
};
struct Band {
  std::vector<Real> value, low, high;
};
Band bootstrap_ratio(const std::vector<GroupSum>& groups, const std::string& key);

}  // namespace isoline::reports
