// Tests by ranks: do two samples differ, by how much, and what is left of it among many tests.
#pragma once

#include <vector>

#include "reports/statistics/statistics.h"

namespace isoline::reports {

// Ranks, 1 the least; ties share the mean, infinite values the last ranks.
std::vector<Real> mid_ranks(const std::vector<Real>& values);

// The two-sided p of Mann and Whitney (1947), 2 min(P(U ≤ u), P(U ≥ u)), given the ties there are:
// exact up to kExact values in all, by the normal approximation with continuity and ties beyond.
Real mann_whitney_p(const std::vector<Real>& a, const std::vector<Real>& b);

// What b takes as a multiple of what a takes: the median of all b_j / a_i, in logarithms, and the
// interval that inverts the test of Mann and Whitney. Hodges, Lehmann (1963). Values above 0.
struct RatioEstimate {
  Real ratio = 1, low = 0, high = kNever;  // 0 and infinite: too few values for an interval
};
RatioEstimate ratio_estimate(const std::vector<Real>& a, const std::vector<Real>& b);
inline constexpr Real kConfidence = 0.95;

// 95 % of the median, the test of signs inverted: order statistics that leave out at most 2.5 % of
// Binomial(n, ½) on either side, whatever the distribution. Of fewer than six values their range;
// of none 0. The page's scripts have the same function, of a pair that a reader chooses.
struct MedianInterval {
  Real median = 0, low = 0, high = 0;
};
MedianInterval median_interval(std::vector<Real> values);

// p adjusted for their number, in the order given: at most q of the discoveries below q are false
// (Benjamini, Hochberg 1995); the chance of any false one below q is at most q (Holm 1979).
std::vector<Real> benjamini_hochberg(const std::vector<Real>& p);
std::vector<Real> holm(const std::vector<Real>& p);

inline constexpr std::size_t kExact = 100;  // values up to which distributions are counted out

}  // namespace isoline::reports
