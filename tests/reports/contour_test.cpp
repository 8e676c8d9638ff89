// Marching squares on shapes whose isolines are known.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "reports/page/page.h"

namespace isoline::reports {
namespace {

Landscape sampled(int n, const std::function<Real(Real, Real)>& loss) {
  Landscape landscape{{-2, 2, -2, 2}, Grid(n, n)};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      landscape.loss(i, j) = loss(-2 + 4.0 * i / (n - 1), -2 + 4.0 * j / (n - 1));
  return landscape;
}

Real length_of(const PlotSeries& line) {
  Real length = 0;
  for (std::size_t i = 1; i < line.x.size(); ++i)
    if (const Real piece = std::hypot(line.x[i] - line.x[i - 1], line.y[i] - line.y[i - 1]);
        std::isfinite(piece))
      length += piece;
  return length;
}

TEST(Contour, OfABowlIsACircle) {
  const Landscape bowl = sampled(101, [](Real a, Real b) { return a * a + b * b; });
  const PlotSeries line = isoline(bowl, 1.5);
  const Real radius = std::sqrt(1.5), h = 0.04;
  // Linear interpolation of r² along an edge of length h errs by at most h²/8 · 2 in r².
  for (std::size_t i = 0; i < line.x.size(); ++i)
    if (!std::isnan(line.x[i])) {
      EXPECT_NEAR(std::hypot(line.x[i], line.y[i]), radius, h * h / (8 * radius));
    }
  EXPECT_NEAR(length_of(line), 2 * std::numbers::pi * radius, 0.01);
}

TEST(Contour, OfASlopeIsALineFromEdgeToEdge) {
  const PlotSeries line = isoline(sampled(5, [](Real a, Real) { return a; }), 0.5);
  EXPECT_EQ(line.x.size(), 4U * 2 + 3) << "four segments, apart";
  EXPECT_NEAR(length_of(line), 4, 1e-12);
  for (const Real x : line.x) EXPECT_TRUE(std::isnan(x) || std::abs(x - 0.5) < 1e-12);
}

TEST(Contour, OfASaddleNeverCrossesItself) {
  const PlotSeries line = isoline(sampled(4, [](Real a, Real b) { return a * b; }), 0.1);
  for (std::size_t i = 1; i < line.x.size(); ++i)
    EXPECT_FALSE(line.x[i] * line.x[i - 1] < 0) << "each segment keeps to its quadrant";
}

TEST(Contour, LeavesOutWhatIsNotFinite) {
  Landscape holed = sampled(21, [](Real a, Real b) { return a * a + b * b; });
  const Real whole = length_of(isoline(holed, 1));
  holed.loss(10, 15) = NAN;
  const PlotSeries line = isoline(holed, 1);
  EXPECT_LT(length_of(line), whole);
  EXPECT_GT(length_of(line), whole / 2);
  for (std::size_t i = 0; i < line.x.size(); ++i)
    EXPECT_EQ(std::isnan(line.x[i]), i % 3 == 2) << "but between segments";
}

TEST(Contour, LevelsAreThoseOfTheFigures) {
  Landscape bowl = sampled(11, [](Real a, Real b) { return a * a + b * b; });
  bowl.spacing = "powers of two";
  const auto powers = contour_levels(bowl);  // 2^i, i = −5 … 7
  ASSERT_EQ(powers.size(), 13U);
  EXPECT_DOUBLE_EQ(powers.front(), 1 / 32.0);
  EXPECT_DOUBLE_EQ(powers.back(), 128);
  bowl.spacing = "fifth root";
  const auto roots = contour_levels(bowl);
  EXPECT_NEAR(std::pow(roots[2], 0.2) - std::pow(roots[1], 0.2), std::pow(roots[0], 0.2), 1e-12);
}

}  // namespace
}  // namespace isoline::reports
