// Spectra of what is missing, of the gradient and of SIP's update, against single modes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "make.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

Vector values_of(const Series& series, const Problem& problem, const Vector& theta, Point& at) {
  Vector values(static_cast<Index>(series.names.size()));
  series.evaluate(problem, theta, at, values);
  return values;
}

Vector cosine_mode(Index k, Index l, Index N) {
  Matrix mode(N, N);
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      mode(i, j) =
          std::cos(2 * std::numbers::pi * static_cast<Real>(i * k + j * l) / static_cast<Real>(N));
  return mode.reshaped();
}

// Heat multiplies a mode by e^(−ℓ), ℓ = 8 (2π |k|)², so ∂L/∂x has it times e^(−2ℓ), and U, where
// the data carry evidence, whole: what is missing in x = x* − a c₂ − b c₅ on 32×32 cells.
TEST(Spectra, OfHeatAreThoseOfItsModes) {
  constexpr Index N = 32;
  const Problem problem = make("heat[N=32]", 1);
  const Real a = 0.02, b = 0.05;
  const Vector theta = problem.truth()->reshaped() - a * cosine_mode(1, 1, N) -
                       b * cosine_mode(0, 5, N);  // |k| = √2/32 = 0.044 and 5/32 = 0.156
  Point at;
  problem.forward(theta, at);
  const Vector values = values_of(spectrum(N), problem, theta, at);
  const auto kept = [](Real k) { return std::exp(-2 * 8 * std::pow(2 * std::numbers::pi * k, 2)); };
  const auto shares = [](Real low, Real high) {
    const Real total = low * low + high * high;
    return Eigen::Vector4d(low * low / total, 0, high * high / total, 0);
  };
  const Eigen::Vector4d missing = shares(a, b),
                        pulled = shares(a * kept(std::sqrt(2.0) / 32), b * kept(5.0 / 32));
  EXPECT_LT((values.head(4) - missing).norm(), 1e-12);      // rounding
  EXPECT_LT((values.segment(4, 4) - pulled).norm(), 1e-9);  // rounding, of the small against y
  EXPECT_LT((values.tail(4) - missing).norm(), 1e-6);       // modes without evidence hold rounding
  EXPECT_GT(pulled[0], 0.99);                               // the adjoint has removed the detail
}

// A wave of the highest number and one along a single axis are counted once each.
TEST(Spectra, CountEveryModeOnce) {
  constexpr Index N = 16;
  const Problem problem = make("heat[N=16]", 1);
  const Vector theta = problem.truth()->reshaped() - 0.3 * cosine_mode(N / 2, N / 2, N) -
                       0.3 * std::sqrt(2.0) * cosine_mode(2, 0, N);
  Point at;
  problem.forward(theta, at);
  const Vector values = values_of(spectrum(N), problem, theta, at);
  // A cosine has the mean square ½ but for the highest, (−1)^(i+j), which has 1.
  EXPECT_NEAR(values[2], 0.5, 1e-12);
  EXPECT_NEAR(values[3], 0.5, 1e-12);
}

}  // namespace
}  // namespace isoline::problems
