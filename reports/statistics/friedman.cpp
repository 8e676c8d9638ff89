// Friedman's statistic, and the tail of χ² by the incomplete gamma function.
#include "reports/statistics/friedman.h"

#include <cmath>

#include "reports/statistics/rank_tests.h"

namespace isoline::reports {
namespace {

constexpr Real kEnough = 1e-15;
constexpr int kMostTerms = 10'000;

// γ(a, x) / Γ(a) by its series: Abramowitz, Stegun (1964), 6.5.29. For x < a + 1.
Real lower_gamma(Real a, Real x) {
  Real term = 1 / a, sum = term;
  for (int n = 1; n < kMostTerms && term > kEnough * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

// Γ(a, x) / Γ(a) by its continued fraction, 6.5.31, after Lentz. For x ≥ a + 1.
Real upper_gamma(Real a, Real x) {
  constexpr Real kTiny = 1e-300;
  Real b = x + 1 - a, c = 1 / kTiny, d = 1 / b, fraction = d;
  for (int n = 1; n < kMostTerms; ++n) {
    const Real numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b;
    c = b + numerator / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1 / d;
    fraction *= c * d;
    if (std::abs(c * d - 1) < kEnough) break;
  }
  return fraction * std::exp(a * std::log(x) - x - std::lgamma(a));
}

}  // namespace

Real chi_square_tail(Real x, Real freedom) {
  if (!(x > 0)) return 1;
  const Real a = freedom / 2, half = x / 2;
  return half < a + 1 ? 1 - lower_gamma(a, half) : upper_gamma(a, half);
}

// With ties: 12 Σ (R_j − n (k + 1)/2)² / (n k (k + 1) (1 − Σ (t³ − t) / (n (k³ − k)))), the last
// factor from Σ ranks², which ties lower.
Real friedman_p(const std::vector<std::vector<Real>>& values) {
  if (values.size() < 2 || values[0].size() < 2) return 1;
  const Real n = Real(values.size()), k = Real(values[0].size()), mean = (k + 1) / 2;
  std::vector<Real> sums(values[0].size(), 0);
  Real spread = 0;  // of all ranks about their mean
  for (const auto& block : values) {
    const std::vector<Real> ranks = mid_ranks(block);
    for (std::size_t j = 0; j < ranks.size(); ++j) {
      sums[j] += ranks[j];
      spread += (ranks[j] - mean) * (ranks[j] - mean);
    }
  }
  if (spread == 0) return 1;
  Real between = 0;
  for (const Real sum : sums) between += (sum - n * mean) * (sum - n * mean);
  return chi_square_tail(between * (k - 1) / spread, k - 1);
}

}  // namespace isoline::reports
