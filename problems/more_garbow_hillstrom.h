// The test functions of Moré, Garbow and Hillstrom (1981) and of Moré and Wild (2009), f of n
// unknowns to m residuals, as the papers have them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "problems/jet_physics.h"

namespace isoline::problems {

inline Real real_of(Real a) { return a; }
template <class T, int N>
Real real_of(const Jet<T, N>& a) {
  return real_of(a.value);
}
template <class T>
T square(const T& a) {
  return a * a;
}
template <class T>
T sum(const T* x, int n) {
  T total(0.0);
  for (int i = 0; i < n; ++i) total += x[i];
  return total;
}
// Σ j xⱼ over first ≤ j ≤ last, j from 1.
template <class T>
T weighted_sum(const T* x, int first, int last) {
  T total(0.0);
  for (int j = first; j <= last; ++j) total += static_cast<Real>(j) * x[j - 1];
  return total;
}

// Moré, Garbow, Hillstrom, problems 32, 33 and 34.
inline constexpr JetFunction kLinearFullRank = jet_function([](auto x, int n, auto f, int m) {
  const auto mean = sum(x, n) * (2.0 / m);
  for (int i = 0; i < m; ++i) f[i] = -mean - 1;
  for (int i = 0; i < n; ++i) f[i] += x[i];
});
inline constexpr JetFunction kLinearRankOne = jet_function([](auto x, int n, auto f, int m) {
  const auto s = weighted_sum(x, 1, n);
  for (int i = 0; i < m; ++i) f[i] = (i + 1.0) * s - 1;
});
inline constexpr JetFunction kLinearRankOneZeros = jet_function([](auto x, int n, auto f, int m) {
  const auto s = weighted_sum(x, 2, n - 1);
  for (int i = 0; i < m; ++i) f[i] = (i < m - 1 ? i : 0.0) * s - 1;
});
// 1
inline constexpr JetFunction kRosenbrock = jet_function([](auto x, int, auto f, int) {
  f[0] = 10 * (x[1] - square(x[0]));
  f[1] = 1 - x[0];
});
// 7: (ρ, 2πθ) are the polar coordinates of (x1, x2), θ in (−¼, ¾). The paper leaves x1 = 0
// undefined: here θ = ±¼ there, with the sign of x2.
inline constexpr JetFunction kHelicalValley = jet_function([](auto x, int, auto f, int) {
  constexpr Real kTurn = 2 * std::numbers::pi;
  const Real x1 = real_of(x[0]), x2 = real_of(x[1]);
  auto theta = 0 * x[0];
  if (std::abs(x1) > std::abs(x2))
    theta = atan(x[1] / x[0]) / kTurn + (x1 < 0 ? 0.5 : 0);
  else
    theta = (x2 > 0 ? 0.25 : x1 < 0 ? 0.75 : -0.25) - atan(x[0] / x[1]) / kTurn;
  f[0] = 10 * (x[2] - 10 * theta);
  f[1] = 10 * (sqrt(square(x[0]) + square(x[1])) - 1);
  f[2] = x[2];
});
// 4
inline constexpr JetFunction kBrownBadlyScaled = jet_function([](auto x, int, auto f, int) {
  f[0] = x[0] - 1e6;
  f[1] = x[1] - 2e-6;
  f[2] = x[0] * x[1] - 2;
});
// 5
inline constexpr JetFunction kBeale = jet_function([](auto x, int, auto f, int) {
  f[0] = 1.5 - x[0] * (1 - x[1]);
  f[1] = 2.25 - x[0] * (1 - square(x[1]));
  f[2] = 2.625 - x[0] * (1 - x[1] * square(x[1]));
});
// 14
inline constexpr JetFunction kWood = jet_function([](auto x, int, auto f, int) {
  f[0] = 10 * (x[1] - square(x[0]));
  f[1] = 1 - x[0];
  f[2] = std::sqrt(90.0) * (x[3] - square(x[2]));
  f[3] = 1 - x[2];
  f[4] = std::sqrt(10.0) * (x[1] + x[3] - 2);
  f[5] = (x[1] - x[3]) / std::sqrt(10.0);
});
// 13
inline constexpr JetFunction kPowellSingular = jet_function([](auto x, int, auto f, int) {
  f[0] = x[0] + 10 * x[1];
  f[1] = std::sqrt(5.0) * (x[2] - x[3]);
  f[2] = square(x[1] - 2 * x[2]);
  f[3] = std::sqrt(10.0) * square(x[0] - x[3]);
});
// 2
inline constexpr JetFunction kFreudensteinRoth = jet_function([](auto x, int, auto f, int) {
  f[0] = -13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1];
  f[1] = -29 + x[0] + ((1 + x[1]) * x[1] - 14) * x[1];
});
// 8
inline constexpr JetFunction kBard = jet_function([](auto x, int, auto f, int) {
  constexpr std::array y = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                            0.37, 0.58, 0.73, 0.96, 1.34, 2.1,  4.39};
  for (int i = 0; i < 15; ++i) {
    const Real u = i + 1, v = 15 - i;
    f[i] = y[i] - (x[0] + u / (v * x[1] + std::min(u, v) * x[2]));
  }
});
// 15
inline constexpr JetFunction kKowalikOsborne = jet_function([](auto x, int, auto f, int) {
  constexpr std::array u = {4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
  constexpr std::array y = {0.1957, 0.1947, 0.1735, 0.16,   0.0844, 0.0627,
                            0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
  for (int i = 0; i < 11; ++i)
    f[i] = y[i] - x[0] * (u[i] * (u[i] + x[1])) / (u[i] * (u[i] + x[2]) + x[3]);
});
// 10
inline constexpr JetFunction kMeyer = jet_function([](auto x, int, auto f, int) {
  constexpr std::array y = {34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0,
                            8261.0,  7030.0,  6005.0,  5147.0,  4427.0,  3820.0,  3307.0,  2872.0};
  for (int i = 0; i < 16; ++i) f[i] = x[0] * exp(x[1] / (50.0 + 5 * i + x[2])) - y[i];
});
// 20
inline constexpr JetFunction kWatson = jet_function([](auto x, int n, auto f, int) {
  for (int i = 0; i < 29; ++i) {
    const Real t = (i + 1) / 29.0;
    auto slope = 0 * x[0], polynomial = 0 * x[0];
    for (int j = n - 1; j >= 0; --j) {
      polynomial = t * polynomial + x[j];
      if (j > 0) slope = t * slope + static_cast<Real>(j) * x[j];
    }
    f[i] = slope - square(polynomial) - 1;
  }
  f[29] = x[0];
  f[30] = x[1] - square(x[0]) - 1;
});
// 12
inline constexpr JetFunction kBox3d = jet_function([](auto x, int, auto f, int m) {
  for (int i = 0; i < m; ++i) {
    const Real t = (i + 1) / 10.0;
    f[i] = exp(-t * x[0]) - exp(-t * x[1]) - (std::exp(-t) - std::exp(-10 * t)) * x[2];
  }
});
// 6
inline constexpr JetFunction kJennrichSampson = jet_function([](auto x, int, auto f, int m) {
  for (int i = 0; i < m; ++i) f[i] = 2 * (i + 2.0) - exp((i + 1.0) * x[0]) - exp((i + 1.0) * x[1]);
});
// 16
inline constexpr JetFunction kBrownDennis = jet_function([](auto x, int, auto f, int m) {
  for (int i = 0; i < m; ++i) {
    const Real t = (i + 1) / 5.0;
    f[i] = square(x[0] + t * x[1] - std::exp(t)) + square(x[2] + std::sin(t) * x[3] - std::cos(t));
  }
});
// 35: fᵢ = mean of Tᵢ(xⱼ) over j − ∫Tᵢ, with the shifted Chebyshev polynomials Tᵢ on [0, 1]
inline constexpr JetFunction kChebyquad = jet_function([](auto x, int n, auto f, int m) {
  for (int i = 0; i < m; ++i) f[i] = 0 * x[0];
  for (int j = 0; j < n; ++j) {
    const auto t = 2 * x[j] - 1;
    auto before = 0 * t + 1, now = t;
    for (int i = 0; i < m; ++i) {
      f[i] += now;
      const auto next = 2 * t * now - before;
      before = now;
      now = next;
    }
  }
  for (int i = 0; i < m; ++i) {
    f[i] = f[i] * (1.0 / n);
    if (i % 2 == 1) f[i] += 1 / (square(i + 1.0) - 1);
  }
});
// 27
inline constexpr JetFunction kBrownAlmostLinear = jet_function([](auto x, int n, auto f, int) {
  const auto s = sum(x, n);
  auto product = x[0];
  for (int i = 1; i < n; ++i) product = product * x[i];
  for (int i = 0; i < n - 1; ++i) f[i] = x[i] + s - (n + 1.0);
  f[n - 1] = product - 1;
});
// 17
inline constexpr JetFunction kOsborne1 = jet_function([](auto x, int, auto f, int) {
  constexpr std::array y = {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.85,  0.818,
                            0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603, 0.58,  0.558,
                            0.538, 0.522, 0.506, 0.49,  0.478, 0.467, 0.457, 0.448, 0.438,
                            0.431, 0.424, 0.42,  0.414, 0.411, 0.406};
  for (int i = 0; i < 33; ++i)
    f[i] = y[i] - (x[0] + x[1] * exp(-10.0 * i * x[3]) + x[2] * exp(-10.0 * i * x[4]));
});
// 19
inline constexpr JetFunction kOsborne2 = jet_function([](auto x, int, auto f, int) {
  constexpr std::array y = {
      1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608,
      0.655, 0.616, 0.606, 0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661,
      0.612, 0.558, 0.533, 0.495, 0.5,   0.423, 0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428,
      0.429, 0.523, 0.562, 0.607, 0.653, 0.672, 0.708, 0.633, 0.668, 0.645, 0.632, 0.591, 0.559,
      0.597, 0.625, 0.739, 0.71,  0.729, 0.72,  0.636, 0.581, 0.428, 0.292, 0.162, 0.098, 0.054};
  for (int i = 0; i < 65; ++i) {
    const Real t = i / 10.0;
    f[i] = y[i] - (x[0] * exp(-t * x[4]) + x[1] * exp(-square(t - x[8]) * x[5]) +
                   x[2] * exp(-square(t - x[9]) * x[6]) + x[3] * exp(-square(t - x[10]) * x[7]));
  }
});
// Conn, Gould, Lescrenier, Toint (1994), problem 61
inline constexpr JetFunction kBdqrtic = jet_function([](auto x, int n, auto f, int) {
  for (int i = 0; i < n - 4; ++i) {
    f[i] = 3 - 4 * x[i];
    f[n - 4 + i] = square(x[i]) + 2 * square(x[i + 1]) + 3 * square(x[i + 2]) +
                   4 * square(x[i + 3]) + 5 * square(x[n - 1]);
  }
});
inline constexpr JetFunction kCube = jet_function([](auto x, int n, auto f, int) {
  f[0] = x[0] - 1;
  for (int i = 1; i < n; ++i) f[i] = 10 * (x[i] - x[i - 1] * square(x[i - 1]));
});
// Σⱼ v (sin⁵ log v + cos⁵ log v), v = √(xᵢ² + i/j), i from 1
template <class T>
T mancino_sum(const T& xi, int i, int n) {
  T total(0.0);
  for (int j = 1; j <= n; ++j) {
    const T v = sqrt(square(xi) + static_cast<Real>(i) / j), s = sin(log(v)), c = cos(log(v));
    total += v * (s * square(square(s)) + c * square(square(c)));
  }
  return total;
}
inline Real mancino_cube(int i) { return std::pow(i - 50.0, 3); }
inline constexpr JetFunction kMancino = jet_function([](auto x, int n, auto f, int) {
  for (int i = 1; i <= n; ++i)
    f[i - 1] = 1400 * x[i - 1] + mancino_cube(i) + mancino_sum(x[i - 1], i, n);
});
// Heart dipole: two vectors (x1, x3), (x2, x4) at (x5, x7), (x6, x8)
inline constexpr JetFunction kHeartEight = jet_function([](auto x, int, auto f, int) {
  const auto &a = x[0], &b = x[1], &c = x[2], &d = x[3], &t = x[4], &u = x[5], &v = x[6], &w = x[7];
  f[0] = a + b + 0.69;
  f[1] = c + d + 0.044;
  f[2] = t * a + u * b - v * c - w * d + 1.57;
  f[3] = v * a + w * b + t * c + u * d + 1.31;
  const auto tv = square(t) - square(v), uw = square(u) - square(w);
  f[4] = a * tv - 2 * c * t * v + b * uw - 2 * d * u * w + 2.65;
  f[5] = c * tv + 2 * a * t * v + d * uw + 2 * b * u * w - 2;
  const auto t3 = t * (square(t) - 3 * square(v)), v3 = v * (square(v) - 3 * square(t));
  const auto u3 = u * (square(u) - 3 * square(w)), w3 = w * (square(w) - 3 * square(u));
  f[6] = a * t3 + c * v3 + b * u3 + d * w3 + 12.6;
  f[7] = c * t3 - a * v3 + d * u3 - b * w3 - 9.48;
});

}  // namespace isoline::problems
