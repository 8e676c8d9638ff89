// A step length that meets the strong Wolfe conditions,
//   φ(α) ≤ φ(0) + c₁ α φ'(0),  |φ'(α)| ≤ c₂ |φ'(0)|,
// by the bracketing and zooming of Nocedal, Wright (2006), algorithms 3.5 and 3.6, with the
// minimizer of the cubic through both ends of the bracket, kept away from them.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/real.h"

namespace isoline::optimizers {

struct WolfeSearch {
  Real c1 = 1e-4, c2 = 0.9;
  int most_trials = 25;

  struct Trial {
    Real length = 0, value = 0, slope = 0;  // α, φ(α), φ'(α)
  };

  // evaluate(α) -> Trial; is_over() -> bool, asked before each. True where both conditions hold at
  // `found`; else it is the best trial that lowers φ enough, of length 0 where there is none.
  template <class Evaluate, class IsOver>
  bool operator()(const Trial& start, Real first, Evaluate&& evaluate, IsOver&& is_over,
                  Trial& found) const {
    Trial low = start, high = start;
    bool is_bracketed = false;
    Real length = first;
    found = start;
    for (int i = 0; i < most_trials && length > 0 && !is_over(); ++i) {
      const Trial at = evaluate(length);
      const bool is_low_enough = at.value <= start.value + c1 * length * start.slope;
      if (is_low_enough && std::abs(at.slope) <= c2 * std::abs(start.slope)) {
        found = at;
        return true;
      }
      if (is_low_enough && at.value < found.value) found = at;
      if (!is_low_enough || at.value >= low.value) {  // nan as well
        high = at;
        is_bracketed = true;
      } else {
        const Real away = is_bracketed ? high.length - low.length : 1;
        if (at.slope * away >= 0) {
          high = low;
          is_bracketed = true;
        }
        low = at;
      }
      constexpr Real kGrowth = 4;
      length = is_bracketed ? between(low, high) : kGrowth * length;
    }
    return false;
  }

 private:
  // Ibid., eq. 3.59, at least a tenth of the bracket from either end; its middle where an end is
  // not finite.
  static Real between(const Trial& low, const Trial& high) {
    constexpr Real kMargin = 0.1;
    const Real gap = high.length - low.length;
    const Real d1 = low.slope + high.slope - 3 * (high.value - low.value) / gap;
    const Real root = std::copysign(std::sqrt(d1 * d1 - low.slope * high.slope), gap);
    const Real share = 1 - (high.slope + root - d1) / (high.slope - low.slope + 2 * root);
    if (!std::isfinite(share)) return low.length + 0.5 * gap;
    return low.length + std::clamp(share, kMargin, 1 - kMargin) * gap;
  }
};

}  // namespace isoline::optimizers
