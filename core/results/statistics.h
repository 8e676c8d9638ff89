// Statistics of comparison: medians that keep failures in the denominator, performance profiles,
// the bootstrap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

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

// The share of its problems that each solver solves within a factor of the least cost.
// Dolan, Moré (2002), Math. Program. 91:201–213; but n_p is a solver's own: a problem never asked
// of it says nothing about it, while one it failed on, or to which it does not apply, does.
struct ProfileLine {
  std::vector<Real> ratios;  // r_{p,s} of the problems solved, ascending
  std::size_t problems =
      0;  // n_p: all problems of this solver, including those that no solver solves
};
struct Profile {
  std::vector<ProfileLine> solvers;

  Real share(std::size_t solver, Real factor) const;  // ρ_s(factor)
  Real area(std::size_t solver, Real most) const;  // ∫ ρ_s over log2 factor in [0, log2 most], mean
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

}  // namespace isoline::results
