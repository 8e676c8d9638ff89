// Flips of signs, counted out where they are few enough.
#include "reports/statistics/sign_flips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/random.h"

namespace isoline::reports {
namespace {

constexpr Real kRounding = 1e-9;  // of sums, relative: flips as far out as the data count as such

// Of all 2^left signs of the last sizes, how many bring |sum| to `far`. Sizes descend, so that most
// branches are decided early; after[i] is the sum from i on.
struct Counter {
  const std::vector<Real>& sizes;
  const std::vector<Real>& after;
  Real far = 0;

  Real count(std::size_t i, Real sum) const {
    const Real left = after[i];
    if (std::abs(sum) + left < far) return 0;
    if (std::abs(sum) - left >= far) return std::exp2(Real(sizes.size() - i));
    return count(i + 1, sum + sizes[i]) + count(i + 1, sum - sizes[i]);
  }
};

Real exact_p(const std::vector<Real>& sizes, Real far) {
  std::vector<Real> after(sizes.size() + 1, 0);
  for (std::size_t i = sizes.size(); i-- > 0;) after[i] = after[i + 1] + sizes[i];
  return Counter{sizes, after, far}.count(0, 0) / std::exp2(Real(sizes.size()));
}

// With the data themselves among the flips, so that no p is 0.
Real drawn_p(const std::vector<Real>& sizes, Real far) {
  constexpr std::size_t kFlips = 1U << 16;
  constexpr int kBits = 52;  // of one draw
  Draws random(0, "report", "signs");
  std::size_t hits = 0;
  for (std::size_t flip = 0; flip < kFlips; ++flip) {
    Real sum = 0;
    std::uint64_t signs = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (i % kBits == 0)
        signs = static_cast<std::uint64_t>(random.uniform() * std::exp2(Real(kBits)));
      sum += (signs & 1U) == 1 ? sizes[i] : -sizes[i];
      signs >>= 1U;
    }
    hits += std::abs(sum) >= far;
  }
  return Real(hits + 1) / Real(kFlips + 1);
}

// Of Student's t with so many degrees of freedom, from the normal's: Cornish, Fisher (1938); to
// 1e-3 from seven on.
Real student_quantile(Real z, Real freedom) {
  const Real z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * freedom) + (5 * z5 + 16 * z3 + 3 * z) / (96 * freedom * freedom) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * freedom * freedom * freedom);
}

}  // namespace

Real sign_flip_p(const std::vector<Real>& differences) {
  std::vector<Real> sizes;
  for (const Real difference : differences)
    if (difference != 0) sizes.push_back(std::abs(difference));
  std::ranges::sort(sizes, std::ranges::greater{});
  const Real observed = std::abs(std::accumulate(differences.begin(), differences.end(), 0.0));
  const Real far = observed - kRounding * std::accumulate(sizes.begin(), sizes.end(), 0.0);
  if (far <= 0) return 1;
  return sizes.size() <= kExactFlips ? exact_p(sizes, far) : drawn_p(sizes, far);
}

Real deviation_of(const std::vector<Real>& values) {
  if (values.size() < 2) return 0;
  const Real n = Real(values.size());
  const Real mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  Real sum = 0;
  for (const Real value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (n - 1));
}

Real detectable_mean(Real deviation, std::size_t n) {
  constexpr Real kLevel = 1.959963984540054, kPower = 0.8416212335729143;  // normal quantiles
  if (n < 2) return std::numeric_limits<Real>::infinity();
  const Real freedom = Real(n - 1);
  return (student_quantile(kLevel, freedom) + student_quantile(kPower, freedom)) * deviation /
         std::sqrt(Real(n));
}

}  // namespace isoline::reports
