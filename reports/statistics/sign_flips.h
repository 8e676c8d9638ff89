// The paired test by sign flips: could differences of this size have had either sign?
#pragma once

#include <cstddef>
#include <vector>

#include "core/real.h"

namespace isoline::reports {

// The two-sided p of the mean of paired differences: the share of all flips of their signs whose
// mean is as far from 0. Fisher (1935). Exact up to kExactFlips of them, beyond that over 2^16
// fixed flips. 1 where all are 0. Differences are finite.
Real sign_flip_p(const std::vector<Real>& differences);
inline constexpr std::size_t kExactFlips = 20;

// The standard deviation of a sample; 0 of fewer than two.
Real deviation_of(const std::vector<Real>& values);

// The mean difference that a two-sided test at 0.05 over n pairs of this deviation finds in 80 % of
// all samples: (t(0.975) + t(0.8)) deviation / √n. Infinite of fewer than two pairs.
Real detectable_mean(Real deviation, std::size_t n);

}  // namespace isoline::reports
