// Tests of differences between methods by ranks, and what tests by flips of signs can find.
#pragma once

#include <cstddef>
#include <vector>

#include "core/real.h"
#include "core/results/statistics.h"

namespace isoline::results {

// Ranks, 1 the least; ties share the mean, infinite values the last ranks.
std::vector<Real> mid_ranks(const std::vector<Real>& values);

// The two-sided p of Mann and Whitney (1947), 2 min(P(U ≤ u), P(U ≥ u)), given the ties there are:
// exact up to kExact values in all, by the normal approximation with continuity and ties beyond.
Real mann_whitney_p(const std::vector<Real>& a, const std::vector<Real>& b);

// The ratio of b to a: the median of all b_j / a_i, in logarithms, and the
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

// p adjusted for their number, in the order given: at most q of the discoveries below q are false.
// Benjamini, Hochberg (1995).
std::vector<Real> benjamini_hochberg(const std::vector<Real>& p);

inline constexpr std::size_t kExact = 100;  // values up to which distributions are counted out

// Do several methods differ at all over the same problems? Friedman's test by ranks (1937).

// values[block][treatment], the less the better; infinite values rank last, ties share. 1 where
// nothing differs. Up to kSmallDesign values, where the χ² approximation rejects too often, the
// share of permutations within blocks with as great a statistic: all of them if they are at most
// kDrawnFlips, else so many. Beyond, χ² with k − 1 degrees of freedom, corrected for ties.
Real friedman_p(const std::vector<std::vector<Real>>& values);
inline constexpr std::size_t kSmallDesign = 60, kDrawnFlips = 1U << 16U;

// P(χ² with so many degrees of freedom ≥ x).
Real chi_square_tail(Real x, Real freedom);

// The power of a paired test by sign flips.

// The standard deviation of a sample; 0 of fewer than two.
Real deviation_of(const std::vector<Real>& values);

// The share of Student's t with so many degrees of freedom that lies below the quantile; share > ½.
Real student_quantile(Real share, std::size_t freedom);

// The mean difference over n pairs that the flips find at 0.05 in 80 % of all samples, if
// differences are as variable as a sample with this deviation: (t(0.975) + t(0.8)) deviation / √n,
// and 1 + 2 / (n − 3) times that for the flips' steps and the deviation's own error, without which
// it is 60 to 76 % of samples. Infinite of fewer than six pairs, whose p cannot be 0.05.
Real detectable_mean(Real deviation, std::size_t n);

// Where a single further value lies in 95 % of all cases, by values of the same kind (on the scale
// on which they are normal), of variance v: mean ± t √(v (1 + 1/n)). Everywhere, of fewer than two
// values.
Interval prediction_interval(const std::vector<Real>& values);

}  // namespace isoline::results
