// Exact distributions of rank sums, counted out by dynamic programming over doubled midranks, which
// are whole numbers; probabilities instead of counts, so that nothing overflows.
#include "core/results/tests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/draws.h"

namespace isoline::results {
namespace {

constexpr Real kTwoSided = 1.959963984540054;  // the normal quantile of 0.975

// Twice the midranks: a group of ties shares the mean of its ranks.
std::vector<std::size_t> doubled_ranks(const std::vector<Real>& values) {
  std::vector<std::size_t> order(values.size()), ranks(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    ++last;  // even where a value does not equal itself
    while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
    for (std::size_t i = first; i < last; ++i) ranks[order[i]] = first + last + 1;
  }
  return ranks;
}

std::size_t sum_of(const std::vector<std::size_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::size_t{0});
}

// P(sum of the ranks of n drawn without replacement = s), s = 0 … the greatest sum.
std::vector<Real> rank_sum_distribution(const std::vector<std::size_t>& ranks, std::size_t n) {
  const std::size_t most = sum_of(ranks) + 1;
  std::vector<std::vector<Real>> chance(n + 1, std::vector<Real>(most, 0));
  chance[0][0] = 1;
  for (std::size_t seen = 0; seen < ranks.size(); ++seen)
    for (std::size_t k = std::min(n, seen + 1); k > 0; --k) {
      // C(seen + 1, k) subsets: those with this rank are a share of k / (seen + 1) of them.
      const Real with = Real(k) / Real(seen + 1);
      for (std::size_t s = most; s-- > 0;) {
        const Real taken = s >= ranks[seen] ? chance[k - 1][s - ranks[seen]] : 0;
        chance[k][s] = with * taken + (1 - with) * chance[k][s];
      }
    }
  return chance[n];
}

Real two_sided(const std::vector<Real>& chance, std::size_t sum) {
  const auto at = chance.begin() + static_cast<std::ptrdiff_t>(sum);
  const Real below = std::accumulate(chance.begin(), at + 1, 0.0);
  const Real above = std::accumulate(at, chance.end(), 0.0);
  return std::min(1.0, 2 * std::min(below, above));
}

// For a sum with this mean and variance, in the unit of doubled ranks: continuity is one unit, ½·2.
Real two_sided_normal(Real sum, Real mean, Real variance) {
  if (variance <= 0) return 1;
  const Real z = std::max(0.0, std::abs(sum - mean) - 1) / std::sqrt(variance);
  return std::min(1.0, std::erfc(z / std::sqrt(2.0)));
}

Real sum_of_squares(const std::vector<std::size_t>& values) {
  Real sum = 0;
  for (const std::size_t value : values) sum += Real(value) * Real(value);
  return sum;
}

// How many of the ordered ratios lie outside the interval at each end, plus one; 0: all do.
// P(U ≤ k − 1) ≤ (1 − confidence) / 2.
std::size_t interval_order(std::size_t n, std::size_t m) {
  constexpr Real kTail = (1 - kConfidence) / 2;
  const Real product = Real(n) * Real(m), total = Real(n + m + 1);
  if (n + m > kExact)
    return static_cast<std::size_t>(
        std::max(0.0, product / 2 - kTwoSided * std::sqrt(product * total / 12)));
  std::vector<std::size_t> ranks(n + m);
  std::iota(ranks.begin(), ranks.end(), 1);
  const std::vector<Real> chance = rank_sum_distribution(ranks, n);
  std::size_t k = 0;
  constexpr Real kRounding = 1e-12;  // of sums of probabilities
  Real below = chance[n * (n + 1) / 2];
  while (below <= kTail + kRounding) below += chance[n * (n + 1) / 2 + ++k];
  return k;
}

}  // namespace

std::vector<Real> mid_ranks(const std::vector<Real>& values) {
  std::vector<Real> ranks;
  for (const std::size_t doubled : doubled_ranks(values)) ranks.push_back(Real(doubled) / 2);
  return ranks;
}

Real mann_whitney_p(const std::vector<Real>& a, const std::vector<Real>& b) {
  if (a.empty() || b.empty()) return 1;
  std::vector<Real> all = a;
  all.insert(all.end(), b.begin(), b.end());
  const std::vector<std::size_t> ranks = doubled_ranks(all);
  const std::size_t sum =
      sum_of({ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(a.size())});
  if (all.size() <= kExact) return two_sided(rank_sum_distribution(ranks, a.size()), sum);
  const Real n = Real(a.size()), m = Real(b.size()), total = n + m;
  const Real mean = Real(sum_of(ranks)) / total;
  const Real spread = sum_of_squares(ranks) / total - mean * mean;
  return two_sided_normal(Real(sum), n * mean, spread * n * m / (total - 1));
}

RatioEstimate ratio_estimate(const std::vector<Real>& a, const std::vector<Real>& b) {
  std::vector<Real> logs;
  for (const Real left : a)
    for (const Real right : b) logs.push_back(std::log(right) - std::log(left));
  if (logs.empty()) return {};
  std::ranges::sort(logs);
  const std::size_t k = interval_order(a.size(), b.size());
  RatioEstimate estimate{.ratio = std::exp(median_of(logs))};
  if (k > 0) {
    estimate.low = std::exp(logs[k - 1]);
    estimate.high = std::exp(logs[logs.size() - k]);
  }
  return estimate;
}

// From the greatest p down: min over those from it on of n / rank · p.
std::vector<Real> benjamini_hochberg(const std::vector<Real>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[i]; });
  std::vector<Real> adjusted(p.size());
  Real least = 1;
  for (std::size_t i = order.size(); i-- > 0;) {
    least = std::min(least, Real(p.size()) / Real(i + 1) * p[order[i]]);
    adjusted[order[i]] = least;
  }
  return adjusted;
}

MedianInterval median_interval(std::vector<Real> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const std::size_t n = values.size();
  // From the k-th of the values to the k-th from their end: it misses the median where fewer than k
  // lie on one side of it, P(Binomial(n, ½) < k) on each.
  constexpr std::size_t kMany = 1000;  // 2⁻ⁿ is no number soon after: the normal law serves
  std::size_t k = 0;
  if (n > kMany) k = static_cast<std::size_t>(Real(n) / 2 - kTwoSided * std::sqrt(Real(n)) / 2);
  Real term = n > kMany ? 1 : std::pow(0.5, Real(n)), misses = term;
  while (misses <= (1 - kConfidence) / 2 && 2 * k < n) {
    ++k;
    term *= Real(n - k + 1) / Real(k);
    misses += term;
  }
  const std::size_t first = std::max<std::size_t>(k, 1) - 1;
  return {median_of(values), values[first], values[n - 1 - first]};
}

// Friedman's statistic, and the tail of χ² by the incomplete gamma function.

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

namespace {

// Ranks within each block, less their mean.
std::vector<std::vector<Real>> centred_ranks(const std::vector<std::vector<Real>>& values) {
  std::vector<std::vector<Real>> all;
  for (const auto& block : values) {
    all.push_back(mid_ranks(block));
    for (Real& rank : all.back()) rank -= Real(block.size() + 1) / 2;
  }
  return all;
}

Real squares_of_sums(const std::vector<std::vector<Real>>& ranks) {
  Real total = 0;
  for (std::size_t j = 0; j < ranks[0].size(); ++j) {
    Real sum = 0;
    for (const auto& block : ranks) sum += block[j];
    total += sum * sum;
  }
  return total;
}

// How many orders a block's ranks have: k! over the factorials of its ties.
Real orders_of(std::vector<Real> ranks) {
  std::ranges::sort(ranks);
  Real orders = 1, alike = 0;
  for (std::size_t j = 0; j < ranks.size(); ++j) {
    alike = j > 0 && ranks[j] == ranks[j - 1] ? alike + 1 : 1;
    orders *= Real(j + 1) / alike;
  }
  return orders;
}

// Counts the orders of the blocks from `block` on that reach `far`. The first block keeps its own:
// permuting all blocks in the same way changes nothing.
Real orders_reaching(std::vector<std::vector<Real>>& ranks, std::size_t block, Real far) {
  if (block == ranks.size()) return squares_of_sums(ranks) >= far ? 1 : 0;
  Real count = 0;
  std::ranges::sort(ranks[block]);
  do count += orders_reaching(ranks, block + 1, far);
  while (std::ranges::next_permutation(ranks[block]).found);
  return count;
}

Real permuted_friedman_p(std::vector<std::vector<Real>> ranks) {
  constexpr Real kSame = 1e-9;  // sums of halves, squared
  const Real far = squares_of_sums(ranks) - kSame;
  Real orders = 1;
  for (std::size_t block = 1; block < ranks.size(); ++block) orders *= orders_of(ranks[block]);
  if (orders <= Real(kDrawnFlips)) return orders_reaching(ranks, 1, far) / orders;
  Draws random(0, "report", "permutations");
  std::size_t hits = 1;
  for (std::size_t draw = 1; draw < kDrawnFlips; ++draw) {
    for (std::size_t block = 1; block < ranks.size(); ++block)
      for (std::size_t j = ranks[block].size(); j > 1; --j)
        std::swap(ranks[block][j - 1],
                  ranks[block][static_cast<std::size_t>(random.uniform() * Real(j))]);
    hits += squares_of_sums(ranks) >= far;
  }
  return Real(hits) / Real(kDrawnFlips);
}

}  // namespace

// With ties: Σ (R_j − n (k + 1)/2)² (k − 1) over the sum of all (rank − (k + 1)/2)², which ties
// lower.
Real friedman_p(const std::vector<std::vector<Real>>& values) {
  if (values.size() < 2 || values[0].size() < 2) return 1;
  const std::vector<std::vector<Real>> ranks = centred_ranks(values);
  Real spread = 0;
  for (const auto& block : ranks)
    for (const Real rank : block) spread += rank * rank;
  if (spread == 0) return 1;
  if (values.size() * values[0].size() <= kSmallDesign) return permuted_friedman_p(ranks);
  const Real freedom = Real(values[0].size() - 1);
  return chi_square_tail(squares_of_sums(ranks) * freedom / spread, freedom);
}

// Student's t, and what tests find.

Real deviation_of(const std::vector<Real>& values) {
  if (values.size() < 2) return 0;
  const Real n = Real(values.size());
  const Real mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  Real sum = 0;
  for (const Real value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (n - 1));
}

namespace {

// P(t ≤ x) with so many degrees of freedom, x > 0: Abramowitz, Stegun (1964), 26.7.3 and 26.7.4.
Real student_share(Real x, std::size_t freedom) {
  const Real n = Real(freedom), angle = std::atan(x / std::sqrt(n)), cosine = std::cos(angle);
  const bool is_odd = freedom % 2 == 1;
  Real term = is_odd ? cosine : 1, sum = freedom == 1 ? 0 : term;
  for (std::size_t j = is_odd ? 3 : 2; j < freedom - 1; j += 2) {
    term *= cosine * cosine * Real(j - 1) / Real(j);
    sum += term;
  }
  const Real two_sides =
      is_odd ? 2 / std::numbers::pi * (angle + std::sin(angle) * sum) : std::sin(angle) * sum;
  return 0.5 + two_sides / 2;
}

}  // namespace

Real student_quantile(Real share, std::size_t freedom) {
  Real low = 0, high = 1;
  while (student_share(high, freedom) < share) high *= 2;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const Real middle = (low + high) / 2;
    (student_share(middle, freedom) < share ? low : high) = middle;
  }
  return high;
}

Real detectable_mean(Real deviation, std::size_t n) {
  constexpr Real kBelow = 0.975, kPower = 0.8;
  if (n < kFewestForInterval) return kNever;
  const Real quantiles = student_quantile(kBelow, n - 1) + student_quantile(kPower, n - 1);
  return (1 + 2 / Real(n - 3)) * quantiles * deviation / std::sqrt(Real(n));
}

Interval prediction_interval(const std::vector<Real>& values) {
  if (values.size() < 2) return {.low = -kNever, .high = kNever};
  const Real n = Real(values.size());
  const Real mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  const Real half =
      student_quantile(0.975, values.size() - 1) * deviation_of(values) * std::sqrt(1 + 1 / n);
  return {mean - half, mean + half};
}

}  // namespace isoline::results
