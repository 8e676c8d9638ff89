// Marching squares on shapes whose isolines are known.
#include "reports/page/contour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace isoline::reports {
namespace {

Landscape sampled(int n, const std::function<Real(Real, Real)>& loss) {
  Landscape landscape{{-2, 2, -2, 2}, Grid(n, n)};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      landscape.loss(i, j) = loss(-2 + 4.0 * i / (n - 1), -2 + 4.0 * j / (n - 1));
  return landscape;
}

Real length_of(const Polyline& line) {
  Real length = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    length += std::hypot(line[i].x1 - line[i - 1].x1, line[i].x2 - line[i - 1].x2);
  return length;
}

TEST(Contour, OfABowlIsOneClosedCircle) {
  const Landscape bowl = sampled(101, [](Real a, Real b) { return a * a + b * b; });
  const auto lines = isolines(bowl, 1.5);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].front().x1, lines[0].back().x1);
  EXPECT_EQ(lines[0].front().x2, lines[0].back().x2);
  const Real radius = std::sqrt(1.5), h = 0.04;
  // Linear interpolation of r² along an edge of length h errs by at most h²/8 · 2 in r².
  for (const Point& p : lines[0]) EXPECT_NEAR(std::hypot(p.x1, p.x2), radius, h * h / (8 * radius));
  EXPECT_NEAR(length_of(lines[0]), 2 * std::numbers::pi * radius, 0.01);
}

TEST(Contour, ThatLeavesTheWindowIsOpen) {
  const auto lines = isolines(sampled(5, [](Real a, Real) { return a; }), 0.5);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].size(), 5U);
  EXPECT_NEAR(length_of(lines[0]), 4, 1e-12);
  for (const Point& p : lines[0]) EXPECT_NEAR(p.x1, 0.5, 1e-12);
}

TEST(Contour, OfTwoPitsIsTwoLines) {
  const auto pits = sampled(81, [](Real a, Real b) { return std::pow(a * a - 1, 2) + b * b; });
  EXPECT_EQ(isolines(pits, 0.25).size(), 2U);
  EXPECT_EQ(isolines(pits, 2).size(), 1U);
}

TEST(Contour, OfASaddleNeverCrossesItself) {
  const auto lines = isolines(sampled(4, [](Real a, Real b) { return a * b; }), 0.1);
  ASSERT_EQ(lines.size(), 2U);
  for (const Polyline& line : lines)
    for (const Point& p : line) EXPECT_GT(p.x1 * line[0].x1, 0);  // each keeps to its quadrant
}

TEST(Contour, LeavesOutWhatIsNotFinite) {
  Landscape holed = sampled(21, [](Real a, Real b) { return a * a + b * b; });
  holed.loss(10, 15) = NAN;
  const auto lines = isolines(holed, 1);
  ASSERT_FALSE(lines.empty());
  for (const Polyline& line : lines)
    for (const Point& p : line) EXPECT_TRUE(std::isfinite(p.x1) && std::isfinite(p.x2));
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

// The isoline L = 2⁻⁵ of x1² + x2² is a circle of radius 0.1768, a tenth of the grid's spacing from
// a corner of it; cubic refinement is exact for quadratics, its chords are not: hence 2 %.
TEST(Contours, ASmallCircleOfACoarseGridIsRound) {
  Landscape landscape{{-2, 2, -2, 2}, Grid(33, 33), "powers of two"};
  const auto at = [](Index i) { return -2 + static_cast<Real>(i) / 8; };
  for (Index j = 0; j < 33; ++j)
    for (Index i = 0; i < 33; ++i) landscape.loss(i, j) = at(i) * at(i) + at(j) * at(j);
  const Contour smallest = contours(landscape).front();
  ASSERT_EQ(smallest.lines.size(), 1U);
  for (const Point& p : smallest.lines[0])
    EXPECT_NEAR(std::hypot(p.x1, p.x2), std::sqrt(smallest.level),
                0.02 * std::sqrt(smallest.level));
}

}  // namespace
}  // namespace isoline::reports
