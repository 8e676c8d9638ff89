// Intervals of contrasts, their order, and their power by simulation.
#include "core/results/contrasts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/draws.h"

namespace isoline::results {
namespace {

// Where a function that increases from below 0 over (0, 1) passes it.
template <class Function>
Real root_of(Function value) {
  Real low = 0, high = 1;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const Real middle = (low + high) / 2;
    (value(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

Real score_margin() { return std::log2(kWorkMargin) / std::log2(kProfileEnd); }

Contrast contrast_of(const std::vector<Real>& differences) {
  std::vector<Real> all = differences;
  all.insert(all.end(), {-1, 1});
  const Real n = static_cast<Real>(all.size());
  Contrast out{.mean = std::accumulate(all.begin(), all.end(), 0.0) / n,
               .deviation = deviation_of(differences),
               .interval = {}};
  constexpr Real kTwoSided = 0.975;
  const Real half = student_quantile(kTwoSided, all.size() - 1) * deviation_of(all) / std::sqrt(n);
  out.interval = {std::max(-1.0, out.mean - half), std::min(1.0, out.mean + half)};
  const Real margin = score_margin();
  out.outcome = out.interval.low > margin                                    ? Outcome::better
                : out.interval.high < -margin                                ? Outcome::worse
                : out.interval.low >= -margin && out.interval.high <= margin ? Outcome::equal
                                                                             : Outcome::undecided;
  return out;
}

std::vector<Contrast> contrasts_in_order(const std::vector<std::vector<Real>>& differences) {
  std::vector<Contrast> all;
  bool is_tested = true;
  for (const std::vector<Real>& each : differences) {
    all.push_back(contrast_of(each));
    all.back().is_tested = is_tested;
    is_tested = is_tested &&
                (all.back().outcome == Outcome::better || all.back().outcome == Outcome::worse);
  }
  return all;
}

Real contrast_power(Real factor, std::size_t families, Real deviation) {
  constexpr std::size_t kSamples = 4000;
  const Real mean = std::log2(factor) / std::log2(kProfileEnd);
  std::size_t found = 0;
  for (std::size_t sample = 0; sample < kSamples; ++sample) {
    Draws random(sample, "report", "power of contrasts", families);
    std::vector<Real> differences;
    for (std::size_t g = 0; g < families; ++g)
      differences.push_back(std::clamp(mean + deviation * random.normal(), -1.0, 1.0));
    found += contrast_of(differences).outcome == Outcome::better;
  }
  return Real(found) / Real(kSamples);
}

Real detectable_factor(std::size_t families, Real deviation) {
  constexpr Real kOften = 0.8;
  for (const Real factor : {2, 3, 4, 5, 6, 8, 16, 32, 64})
    if (contrast_power(factor, families, deviation) >= kOften) return factor;
  return kNever;
}

Real binomial_tail(std::size_t k, std::size_t n, Real q) {
  Real sum = 0;
  for (std::size_t i = k; i <= n; ++i)
    sum += std::exp(std::lgamma(Real(n) + 1) - std::lgamma(Real(i) + 1) -
                    std::lgamma(Real(n - i) + 1)) *
           std::pow(q, Real(i)) * std::pow(1 - q, Real(n - i));
  return sum;
}

Interval exact_share(std::size_t k, std::size_t n) {
  constexpr Real kSide = 0.025;
  return {k == 0 ? 0 : root_of([&](Real q) { return binomial_tail(k, n, q) - kSide; }),
          k == n ? 1 : root_of([&](Real q) { return kSide - (1 - binomial_tail(k + 1, n, q)); })};
}

}  // namespace isoline::results
