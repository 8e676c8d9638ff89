// The solution of u_t + u u_x = ν u_xx with u(x, 0) = −sin πx, by the transform of Cole and Hopf:
//   u = −⟨sin πy⟩,  y = x − √(4νt) z,  ⟨·⟩ the mean with the weights e^(−cos(πy)/2πν − z²) over z.
// The trapezoidal rule converges exponentially: neither weights nor sine have a kink.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/array.h"

namespace isoline::problems {

inline Real cole_hopf(Real x, Real t, Real viscosity) {
  // Where −z² is below the gain of the first term, 1/πν, by 40, nothing is left; the weights vary
  // over lengths of √(1/2πt) or more.
  constexpr Real kStep = 0.05, kNegligible = 40;
  const Real pi = std::numbers::pi, gain = 1 / (2 * pi * viscosity);
  const auto nodes = static_cast<Index>(std::sqrt(2 * gain + kNegligible) / kStep);
  const Real width = std::sqrt(4 * viscosity * t);
  const auto place = [&](Index i) { return x - width * kStep * static_cast<Real>(i); };
  const auto exponent = [&](Index i) {
    const Real z = kStep * static_cast<Real>(i);
    return -gain * std::cos(pi * place(i)) - z * z;
  };
  Real largest = exponent(0);
  for (Index i = -nodes; i <= nodes; ++i) largest = std::max(largest, exponent(i));
  Real sum = 0, weights = 0;
  for (Index i = -nodes; i <= nodes; ++i) {
    const Real weight = std::exp(exponent(i) - largest);
    sum += weight * std::sin(pi * place(i));
    weights += weight;
  }
  return -sum / weights;
}

}  // namespace isoline::problems
