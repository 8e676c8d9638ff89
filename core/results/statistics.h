// Statistics of comparison: medians that keep failures in the denominator, performance profiles,
// the bootstrap, tests by ranks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/draws.h"
#include "core/real.h"

namespace isoline::results {

inline constexpr Real kNever = std::numeric_limits<Real>::infinity();

// The median and range of n values, of which `unsolved` are infinite. Nothing is known if n = 0.
struct Spread {
  Real median = kNever, low = kNever, high = kNever;
  std::size_t n = 0, unsolved = 0;

  bool is_solved() const { return n > 0 && median < kNever; }
};

// Not-a-number counts as infinite: what failed was not reached. With n even the median is the mean
// of the two in the middle, infinite if either is.
Spread spread_of(std::vector<Real> values);
Real median_of(std::vector<Real> values);

// The correct digits of a figure with this relative error, within 0 and the eleven that NIST
// certifies; 0 where it is not a number. A regression with four is solved, as in Ceres' nist.cc.
inline constexpr Real kCertifiedDigits = 11, kSolvedDigits = 4, kAccurateDigits = 6;
inline Real log_relative_error(Real error) {
  return error >= 0 ? std::clamp(-std::log10(error), 0.0, kCertifiedDigits) : 0;
}

// The share of its problems that each solver solves within a factor of the least cost.
// Dolan, Moré (2002), Math. Program. 91:201–213; but n_p is a solver's own: a problem never asked
// of it says nothing about it, while one it failed on, or to which it does not apply, does.
struct ProfileLine {
  std::vector<Real> ratios;  // r_{p,s} of the problems solved, ascending
  std::size_t problems = 0;  // n_p: all of this solver, also those that no solver solves
};
struct Profile {
  std::vector<ProfileLine> solvers;

  Real share(std::size_t solver, Real factor) const;  // ρ_s(factor)
};

// costs[p][s]; infinite or not-a-number: unsolved; nothing: never asked. A cost below one unit
// counts as one unit, so that a problem solved at its start leaves the other ratios finite.
using Costs = std::vector<std::vector<std::optional<Real>>>;
Profile performance_profile(const Costs& costs);

// r_{p,s} of one problem: its costs over the least of them; infinite where unsolved.
std::vector<std::optional<Real>> cost_ratios(const std::vector<std::optional<Real>>& costs);

// A ratio's part in the area of a profile: 1 at the least cost, 0 from `most` times it on.
Real score_of(Real ratio, Real most);

// The gain of tuning: the best of b values sampled from those that were tried.

// The expected greatest of b of these values, b = 1 … n, drawn without replacement: each subset of
// b is as likely as any other. E = Σ_i v_(i) [C(i, b) − C(i − 1, b)] / C(n, b), v ascending.
std::vector<Real> expected_best(std::vector<Real> values);

// The slope of log10 y over log10 x by least squares, and the root mean square of the residuals;
// not a number without two different x.
std::pair<Real, Real> log_slope(std::vector<Real> x, std::vector<Real> y);

// Statistics of runs to a target: expected running time, simulated restarts, areas, digits.

// The cost of one run: up to the target if it was reached, otherwise all of it.
struct Attempt {
  Real cost = 0;
  bool is_success = false;
};

// All that was spent over the successes; infinite without one. Hansen et al. (2016), COCO.
Real expected_running_time(const std::vector<Attempt>& attempts);

// Costs of kDraws simulated runs that restart until a success: attempts drawn with replacement,
// their costs summed. Ascending; all infinite without a success.
std::vector<Real> simulated_restarts(const std::vector<Attempt>& attempts, const std::string& key);

// The bootstrap of reports: the distribution of a statistic over resampled data. Efron (1979).

inline constexpr std::size_t kDraws = 1000;

// One of so many places.
std::size_t drawn_place(Draws& random, std::size_t count);

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

// Parts of a variance by two crossed random factors: the components of a balanced two-way
// analysis of variance with one value per pair, from values[i][j], two or more of each. Searle,
// Casella, McCulloch (1992), section 4.5. Estimates below 0 are set to 0.
struct VarianceComponents {
  Real first = 0, second = 0, rest = 0;

  Real total() const { return first + second + rest; }
};
VarianceComponents variance_components(const std::vector<std::vector<Real>>& values);

// Tests of differences between methods by ranks, what tests by flips of signs can find, and
// verdicts on times.

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

// The power of a paired test by sign flips.

// The standard deviation of a sample; 0 of fewer than two.
Real deviation_of(const std::vector<Real>& values);

// The share of Student's t with so many degrees of freedom that lies below the quantile; share > ½.
Real student_quantile(Real share, std::size_t freedom);
// P(χ² ≥ value) with so many degrees of freedom; Abramowitz, Stegun (1964), 26.4.4 and 26.4.5.
Real chi_square_tail(Real value, std::size_t freedom);

// The mean difference over n pairs that the flips find at 0.05 in 80 % of all samples, if
// differences are as variable as a sample with this deviation: (t(0.975) + t(0.8)) deviation / √n,
// and 1 + 2 / (n − 3) times that for the flips' steps and the deviation's own error, without which
// it is 60 to 76 % of samples. Infinite of fewer than six pairs, whose p cannot be 0.05.
Real detectable_mean(Real deviation, std::size_t n);

// Where a single further value lies in 95 % of all cases, by values of the same kind (on the scale
// on which they are normal), of variance v: mean ± t √(v (1 + 1/n)). Everywhere, of fewer than two
// values.
Interval prediction_interval(const std::vector<Real>& values);

// Did the time of a cell change by more than it varies by itself?

inline constexpr std::size_t kLeastRepetitions = 9;  // of each side
inline constexpr std::size_t kMostTimed = 20;        // cells, of which each costs the others power
inline constexpr Real kFalseDiscoveries = 0.05;
// Repetitions within one job do not show how one job differs from the next, by frequency,
// neighbours and layout of memory: some percent on shared machines.
inline constexpr Real kLeastNoise = 0.1;

struct TimedCell {
  std::string key, title;
  std::vector<Real> before, after;  // seconds of each repetition
};

struct TimeVerdict {
  std::string key, title;
  std::size_t n_before = 0, n_after = 0;
  RatioEstimate ratio;       // after over before
  Real p = 1, adjusted = 1;  // Mann-Whitney; after Benjamini and Hochberg
  Real noise = kLeastNoise;  // [1 / (1 + noise), 1 + noise] is no change
  int change = 0;            // 1 slower, −1 faster, 0 neither
};

// Worst first. Slower or faster: the adjusted p is at most kFalseDiscoveries, and the whole
// interval of the ratio lies outside the band of noise.
std::vector<TimeVerdict> judge_times(const std::vector<TimedCell>& cells, Real least_noise);

// How far the estimate of a ratio strays where nothing has changed: the repetitions of each side of
// each cell are split into random halves, and 95 of 100 estimates between halves stay within
// 1 + noise. Halves have fewer repetitions than the sides, so their logarithm is scaled by the
// standard errors of both. One figure for all cells: nine repetitions tell little of their own
// noise, and the interval of a cell's ratio already widens with it.
Real split_noise(const std::vector<TimedCell>& cells);

// Spearman's ρ: the correlation of the ranks, ties at their mean; not-a-number where one side has
// no order, or of fewer than two.
Real rank_correlation(const std::vector<Real>& a, const std::vector<Real>& b);

// Do several methods differ at all over the same blocks? Friedman's test by ranks (1937), with
// permutations within the blocks: all of them in a small design, else random ones.
Real friedman_p(const std::vector<std::vector<Real>>& values);  // [block][method]

}  // namespace isoline::results
