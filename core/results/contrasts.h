// Contrasts of two methods that were named before the data, tested in their order: the difference
// of their scores per family, by a t interval that two pseudo-families at −1 and +1 widen.
//
// The null of a test by flips of signs is symmetry and not equality: a method that fails on a tenth
// of the problems and is faster on the others has differences of mean 0 that are lopsided, and such
// a test calls it better in half of all samples of seven families. The pseudo-families are a
// failure of either method that the sample may not have shown.
#pragma once

#include <cstddef>
#include <vector>

#include "core/real.h"
#include "core/results/decisions.h"
#include "core/results/statistics.h"

namespace isoline::results {

// Methods whose work differs by less are equal for a user: as a difference of scores.
inline constexpr Real kWorkMargin = 1.1;
Real score_margin();

enum class Outcome { better, worse, equal, undecided };

struct Contrast {
  Real mean = 0;                         // over families and pseudo-families
  Real deviation = 0;                    // of the families alone
  Interval interval;                     // 95 %
  Outcome outcome = Outcome::undecided;  // better: the interval lies beyond the margin
  bool is_tested = false;                // as a hypothesis: none before it in the order failed
};
// By the differences of scores of each family, first less second.
Contrast contrast_of(const std::vector<Real>& differences);
// Each at 5 % until one does not find a difference; the others are estimates.
std::vector<Contrast> contrasts_in_order(const std::vector<std::vector<Real>>& differences);

// The share of data sets of so many families in which a method that needs 1/factor of the work is
// found to be better, if differences of scores are normal with this deviation: simulated.
inline constexpr Real kUsualDeviation = 0.25;
Real contrast_power(Real factor, std::size_t families, Real deviation = kUsualDeviation);
// The least factor of 2, 3, 4, 6, 8, 16, 32, 64 that is found in 80 % of data sets; infinite where
// none is.
Real detectable_factor(std::size_t families, Real deviation = kUsualDeviation);

// P(X ≥ k) of n trials that each succeed with the probability q.
Real binomial_tail(std::size_t k, std::size_t n, Real q);

// 95 % of the probability of which k of n trials were successes. Clopper, Pearson (1934).
Interval exact_share(std::size_t successes, std::size_t trials);

}  // namespace isoline::results
