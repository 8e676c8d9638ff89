// Axes as SVG.
#include "reports/page/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/formats/escape.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Real share_of(Real value, Real low, Real high) {
  if (!(high > low)) return 0;
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

std::string tick_text(Real value) {
  constexpr Real kInFull = 9999;
  if (value > kInFull) return fmt::format("1e{:.0f}", std::log10(value));
  return figure(value);
}

}  // namespace

Real Frame::x(Real value) const {
  if (is_log_x)
    return left +
           width * share_of(std::log(std::max(value, x_low)), std::log(x_low), std::log(x_high));
  return left + width * share_of(value, x_low, x_high);
}

Real Frame::y(Real value) const {
  if (is_log_y)
    return bottom() -
           height * share_of(std::log(std::max(value, y_low)), std::log(y_low), std::log(y_high));
  return bottom() - height * share_of(value, y_low, y_high);
}

std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic) {
  constexpr Real kMost = 8, kFewDoublings = 100;
  constexpr int kBound =
      64;  // of any axis: where a step is lost to rounding, none goes on for ever
  std::vector<Real> ticks;
  if (is_logarithmic) {
    Real factor = high / low <= kFewDoublings ? 2 : 10;
    const Real powers = std::log(high / low) / std::log(factor);
    factor = std::pow(factor, std::max(1.0, std::ceil(powers / kMost)));
    Real tick = std::pow(factor, std::ceil(std::log(low) / std::log(factor) - 1e-9));
    while (tick <= high * (1 + 1e-9) && std::ssize(ticks) < kBound) {
      ticks.push_back(tick);
      tick *= factor;
    }
    return ticks;
  }
  const Real rough = (high - low) / kMost, power = std::pow(10.0, std::floor(std::log10(rough)));
  Real step = 10 * power;
  for (const Real digit : {5, 2, 1})
    if (digit * power >= rough) step = digit * power;
  const Real first = std::ceil(low / step - 1e-9);
  for (int i = 0; i < kBound && (first + i) * step <= high + 1e-9 * step; ++i)
    ticks.push_back((first + i) * step + 0.0);  // no −0
  return ticks;
}

namespace {

// 1, 2 and 5 times the powers of ten within two decades, else the powers alone.
std::vector<Real> heights_of(const Frame& frame) {
  constexpr Real kNear = 100;
  if (!frame.is_log_y || frame.y_high > kNear * frame.y_low)
    return ticks_of(frame.y_low, frame.y_high, frame.is_log_y);
  std::vector<Real> ticks;
  Real power = std::pow(10.0, std::floor(std::log10(frame.y_low)));
  for (int decade = 0; decade <= 3; ++decade) {
    for (const Real digit : {1, 2, 5})
      if (digit * power >= frame.y_low && digit * power <= frame.y_high)
        ticks.push_back(digit * power);
    power *= 10;
  }
  return ticks;
}

}  // namespace

std::string x_axis(const Frame& frame, const std::string& label) {
  std::string svg;
  for (const Real tick : ticks_of(frame.x_low, frame.x_high, frame.is_log_x))
    svg += fmt::format(
        "<path class=grid d=\"M{0:.1f} {1:.0f}V{2:.0f}\"/><text x={0:.1f} y={3:.0f} "
        "class=tick text-anchor=middle>{4}</text>",
        frame.x(tick), frame.top, frame.bottom(), frame.bottom() + 14, tick_text(tick));
  return svg + fmt::format("<text x={:.0f} y={:.0f} class=tick text-anchor=middle>{}</text>",
                           frame.left + frame.width / 2, frame.bottom() + 30, html_text(label));
}

std::string y_axis(const Frame& frame, const std::string& label, bool is_share) {
  std::string svg;
  for (const Real tick : heights_of(frame)) {
    if (is_share && std::lround(10 * tick) % 2 != 0) continue;
    svg += fmt::format(
        "<path class=grid d=\"M{0:.0f} {1:.1f}H{2:.0f}\"/><text x={3:.0f} y={4:.1f} class=tick "
        "text-anchor=end>{5}</text>",
        frame.left, frame.y(tick), frame.right(), frame.left - 6, frame.y(tick) + 4,
        is_share ? percent(tick) : figure(tick));
  }
  return svg + fmt::format("<text x={:.0f} y={:.0f} class=tick>{}</text>", frame.left,
                           frame.top - 8, html_text(label));
}

}  // namespace isoline::reports
