// ECNoise, and steps of differences.
#include "core/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/numbers.h"
#include "core/random.h"

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

namespace {

// The error of the last place of each of these values, if all have at most nine decimal digits, at
// most eight decimals, or single precision, over their factors; the largest of these. `rows`: those
// that count.
Vector last_places(const std::vector<Vector>& values, const std::vector<Index>& rows,
                   const auto& factor) {
  constexpr int kMostDigits = 9, kMostDecimals = 8;
  constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();
  constexpr Real kRounded = 0.2887;  // the standard deviation of rounding to 1
  int digits = 1, decimals = 0;
  bool is_single = true;
  std::array<char, 32> text;
  for (const Vector& y : values)
    for (const Index i : rows) {
      const Real value = y[i] / factor(i);
      const Real rounding = factor(i) == 1 ? 0 : 2 * kEpsilon * std::abs(value);
      const auto is_value = [&](Real other) { return std::abs(other - value) <= rounding; };
      const auto has = [&](const char* form, int places) {
        std::snprintf(text.data(), text.size(), form, places, value);
        return is_value(std::strtod(text.data(), nullptr));
      };
      is_single = is_single && is_value(static_cast<float>(value));
      while (digits <= kMostDigits && !has("%.*e", digits - 1)) ++digits;
      while (decimals <= kMostDecimals && !has("%.*f", decimals)) ++decimals;
    }
  Vector place = Vector::Zero(values[0].size());
  for (Index i = 0; i < place.size(); ++i) {
    if (factor(i) == 0) continue;
    const Real size = std::abs(values[0][i] / factor(i));
    if (digits <= kMostDigits && size > 0)
      place[i] = std::pow(10.0, std::floor(std::log10(size)) + 1 - digits);
    if (decimals <= kMostDecimals) place[i] = std::max(place[i], std::pow(10.0, -decimals));
    if (is_single)
      place[i] =
          std::max(place[i], size * static_cast<Real>(std::numeric_limits<float>::epsilon()));
    place[i] *= factor(i);
  }
  return kRounded * place;
}

}  // namespace

Real noise_of_calls(const Vector& y0, const std::function<Vector(Real t)>& y, const Vector& factors,
                    Vector* slope) {
  const Real near = kNoiseSteps[2];
  Real far = kNoiseSteps[0];
  constexpr Real kNotSmooth = 0.5, kSmooth = 0.1, kSmaller = 0.01, kFalls = 0.01, kBends = 0.3;
  constexpr Real kWild = 10;
  constexpr Real kBent = 1e-4;  // of the change: a smooth y bends less over so small a step
  constexpr int kMostAgain = 2;
  constexpr std::size_t kMostRows = 1000;
  const Real size = y0.norm();
  Real noise = std::numeric_limits<Real>::epsilon();
  if (size == 0) {  // as of an amplitude that starts at 0: what is printed shows beside it
    constexpr Real kBeside = kNoiseStep / 5;
    const Vector beside = y(kBeside);
    const bool shows = is_finite(beside) && !beside.isZero(0);
    return shows ? noise_of_calls(
                       beside, [&](Real t) { return y(kBeside + t); }, factors)
                 : noise;
  }
  if (!std::isfinite(size)) return noise;
  std::vector<Vector> values{y0, y(far), y(2 * far), y(near)};
  // Steps so small do not change y so much: a call that failed, with numbers or without.
  const auto is_wild = [&](const Vector& each) { return !((each - y0).norm() <= kWild * size); };
  const auto difference = [&](const Vector& once, const Vector& two) -> Vector {
    return two - 2 * once + y0;
  };
  // The third difference over steps of t, of which y(t) and y(2 t) are known.
  const auto third_over = [&](Real t, const Vector& once, const Vector& two) {
    const Vector thrice = y(3 * t);
    const Real third = (thrice - two - once + y0 - 2 * difference(once, two)).norm();
    values.push_back(thrice);
    return third;
  };
  const Vector moved = values[3] - y0;
  Vector second;
  const auto gap_to = [&](Real t, const Vector& once) {
    return (moved - near / t * (once - y0 - second / 2)).norm();
  };
  Real gap = 0, third = 0;
  const auto have_values = [&] {
    second = difference(values[1], values[2]);
    gap = gap_to(far, values[1]);
    third = 0;
    if (is_wild(values[1]) || is_wild(values[2])) return false;
    if (far / near * gap <= kSmooth * second.norm()) return true;
    third = third_over(far, values[1], values[2]);
    return !is_wild(values.back());
  };
  for (int again = 0; !have_values() && again < kMostAgain; ++again) {  // beside failed calls
    far *= 0.75;
    values[1] = y(far);
    values[2] = y(2 * far);
  }
  if (third > kNotSmooth * second.norm()) {
    // A narrow feature of a smooth y bends over small steps as much as over large ones, and its
    // third difference falls with the cube of the step. Noise does not fall, and jumps do not
    // bend.
    const Real small = far * kSmaller;
    const Vector once = y(small), two = y(2 * small);
    second = difference(once, two);
    const Real smaller = third_over(small, once, two);
    gap = gap_to(small, once);
    const bool bends = second.norm() >= kBends * kSmaller * kSmaller * third;
    third = bends && smaller <= kFalls * third ? 0 : std::max(third, smaller);
    if (third <= kWild * size) noise = std::max(noise, third / std::sqrt(20.0) / size);
  }
  const Real change = moved.norm();
  if (!(gap <= kBent * change)) {
    const Real bend = difference(values[3], y(2 * near)).norm() / std::sqrt(6.0);
    if (bend > kBent * change && bend <= kWild * size) noise = std::max(noise, bend / size);
  }
  std::erase_if(values, is_wild);
  const auto factor = [&](Index i) { return i < factors.size() ? factors[i] : 0; };
  std::vector<Index> rows;
  for (Index i = 0; i < y0.size() && rows.size() < kMostRows; ++i)
    if (factor(i) > 0 &&
        std::ranges::any_of(values, [&](const Vector& each) { return each[i] != y0[i]; }))
      rows.push_back(i);
  if (!rows.empty()) noise = std::max(noise, last_places(values, rows, factor).norm() / size);
  if (slope != nullptr && noise == std::numeric_limits<Real>::epsilon() && change <= kWild * size)
    *slope = moved / near;
  return noise;
}

Vector line_inside(const Vector& start, const Vector& sizes, const Vector* lower,
                   const Vector* upper) {
  constexpr Real kFarthest = 4e-3;  // t of the calls of noise_of_calls, and more
  RandomStream stream(0, "", "noise of values");
  Vector line = sizes.cwiseProduct(stream.uniform_vector(start.size(), -1, 1));
  line /= line.cwiseQuotient(sizes).lpNorm<Eigen::Infinity>();
  if (lower == nullptr) return line;
  const auto is_outside = [&](Index i) {
    const Real end = start[i] + kFarthest * line[i];
    return end > (*upper)[i] || end < (*lower)[i];
  };
  for (Index i = 0; i < line.size(); ++i) {
    if (is_outside(i)) line[i] = -line[i];
    if (is_outside(i)) line[i] = 0;
  }
  return line;
}

std::array<Real, 2> difference_offsets(Real h, bool is_central, Real up, Real down) {
  const Real side = up >= down ? 1 : -1, room = std::max({up, down, 0.0});
  if (!is_central) return {up >= h ? h : down >= h ? -h : side * std::min(h, room), 0};
  if (up >= h && down >= h) return {h, -h};
  const Real inward = side * std::min(h, room / 2);
  return {inward, 2 * inward};
}

Real forward_step(Real noise) { return std::pow(8.0, 0.25) * std::sqrt(noise); }
Real central_step(Real noise) { return std::cbrt(3 * noise); }
Real size_for_steps(Real size, Real column, Real size_of_y) {
  constexpr Real kLeast = 1e-3, kMost = 1e3;
  const Real share = size_of_y / (column * size);
  if (!(share > 0)) return size;
  return size * std::clamp(share < 1 ? share : std::sqrt(share), kLeast, kMost);
}

Real GivenSteps::of(Index j, Index n, Real size, Real otherwise) const {
  if (steps.empty()) return otherwise * size;
  require(steps.size() == 1 || std::ssize(steps) == n, [&] {
    return fmt::format("difference-step has {} steps for {} unknowns", steps.size(), n);
  });
  const Real step = steps.size() == 1 ? steps[0] : steps[static_cast<std::size_t>(j)];
  return are_absolute ? step : step * size;
}

GivenSteps given_steps(const std::string& text) {
  constexpr std::string_view kAbsolute = " absolute";
  GivenSteps given;
  if (text.empty()) return given;
  given.are_absolute = text.ends_with(kAbsolute);
  std::string_view left = text;
  if (given.are_absolute) left.remove_suffix(kAbsolute.size());
  while (true) {
    const std::size_t end = std::min(left.find(':'), left.size());
    const std::optional<Real> step = number_in(left.substr(0, end));
    require(step && *step > 0 && std::isfinite(*step), [&] {
      return fmt::format(
          "difference-step must be one positive number, or one for each unknown as "
          "1e-3:0.1, got '{}'",
          text);
    });
    given.steps.push_back(*step);
    if (end == left.size()) return given;
    left.remove_prefix(end + 1);
  }
}

Vector sizes_of_unknowns(const Vector& start) {
  constexpr Real kNothing = 1e-14;  // of the largest: rounding
  const Real largest = start.lpNorm<Eigen::Infinity>();
  const Real unknown = largest > 0 ? std::min<Real>(1, largest) : 1;
  return (start.array().abs() > kNothing * largest).select(start.cwiseAbs(), unknown);
}

std::string name_of_unknown(const std::vector<std::string>& names, Index i) {
  const auto at = static_cast<std::size_t>(i);
  return at < names.size() && !names[at].empty() ? names[at] : fmt::format("x{}", i + 1);
}

}  // namespace isoline
