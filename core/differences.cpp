// ECNoise, and steps of differences.
#include "core/differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace isoline {
namespace {

enum class Spacing { good, too_small, too_large };
struct Noise {
  Spacing spacing = Spacing::good;
  Real level = 0;
};

// For equally spaced values: differences of order j have the noise times √((2j)!)/j!; three
// successive levels within a factor of 4, of which the first changes sign, are those of noise.
Noise ecnoise(std::array<Real, kNoiseCalls> values) {
  constexpr Real kSmooth = 0.1, kAlike = 4;
  const auto [least, largest] = std::ranges::minmax(values);
  const Real size = std::max(std::abs(least), std::abs(largest));
  if (!std::isfinite(size) || (largest - least) > kSmooth * size) return {Spacing::too_large};
  std::array<Real, kNoiseCalls> levels{};
  std::array<bool, kNoiseCalls> changes_sign{};
  Real factor = 1;
  for (int j = 1; j < kNoiseCalls; ++j) {
    const int count = kNoiseCalls - j;
    Real squares = 0, low = std::numeric_limits<Real>::infinity(), high = -low;
    int zeros = 0;
    for (std::size_t i = 0; std::cmp_less(i, count); ++i) {
      values[i] = values[i + 1] - values[i];
      zeros += values[i] == 0 ? 1 : 0;
      squares += values[i] * values[i];
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    if (j == 1 && 2 * zeros >= kNoiseCalls) return {Spacing::too_small};
    factor *= 0.5 * j / (2 * j - 1);
    const auto order = static_cast<std::size_t>(j);
    levels[order] = std::sqrt(factor * squares / count);
    changes_sign[order] = low * high < 0;
  }
  for (std::size_t j = 1; j + 2 < kNoiseCalls; ++j) {
    const auto [low, high] = std::minmax({levels[j], levels[j + 1], levels[j + 2]});
    if (high <= kAlike * low && changes_sign[j]) return {Spacing::good, levels[j]};
  }
  return {Spacing::too_large};
}

}  // namespace

Vector noise_of_values(const std::function<Vector(Real t)>& f) {
  constexpr Real kFirst = 1e-8, kFactor = 100;
  Real spacing = kFirst;
  Vector noise = Vector::Zero(f(0).size());
  bool was_too_small = false;
  for (int attempt = 0; attempt < kNoiseSpacings; ++attempt) {
    Matrix values(noise.size(), kNoiseCalls);
    for (int i = 0; i < kNoiseCalls; ++i) values.col(i) = f(spacing * (i - kNoiseCalls / 2));
    Index small = 0, good = 0;
    for (Index row = 0; row < noise.size(); ++row) {
      std::array<Real, kNoiseCalls> line;
      for (std::size_t i = 0; i < kNoiseCalls; ++i) line[i] = values(row, static_cast<Index>(i));
      const Noise found = ecnoise(line);
      if (found.spacing == Spacing::good) noise[row] = found.level;
      good += found.spacing == Spacing::good ? 1 : 0;
      small += found.spacing == Spacing::too_small ? 1 : 0;
    }
    if (2 * good >= noise.size()) break;
    const bool is_too_small = 2 * small >= noise.size();
    if (attempt > 0 && is_too_small != was_too_small) break;  // neither would do
    was_too_small = is_too_small;
    spacing = is_too_small ? spacing * kFactor : spacing / kFactor;
  }
  return noise;
}

Real forward_step(Real noise) { return std::pow(8.0, 0.25) * std::sqrt(noise); }
Real central_step(Real noise) { return std::cbrt(3 * noise); }

Vector sizes_of_unknowns(const Vector& start) {
  constexpr Real kNothing = 1e-8;  // of the largest, from which fits differ by up to 1e7: rounding
  const Real largest = start.lpNorm<Eigen::Infinity>();
  const Real unknown = largest > 0 ? std::min<Real>(1, largest) : 1;
  return (start.array().abs() > kNothing * largest).select(start.cwiseAbs(), unknown);
}

}  // namespace isoline
