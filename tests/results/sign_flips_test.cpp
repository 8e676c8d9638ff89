// The paired test by sign flips and Friedman's test, against enumeration and SciPy.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/results/decisions.h"
#include "core/results/tests.h"

namespace isoline::results {
namespace {

constexpr Real kRounding = 1e-12;

// Two methods that differ by these in each family.
Real sign_flip_p(const std::vector<Real>& differences) {
  std::vector<std::vector<Real>> sums;
  for (const Real difference : differences) sums.push_back({difference, 0});
  return flip_levels(sums).pairs[0][1];
}

// All eight signs of 1, 2, 3: |sum| is 6 twice, 4 twice, 2 twice and 0 twice.
TEST(SignFlips, CountAllSignsOfAFew) {
  EXPECT_EQ(sign_flip_p({1, 2, 3}), 0.25);
  EXPECT_EQ(sign_flip_p({-1, 2, 3}), 0.5);
  EXPECT_EQ(sign_flip_p({1, 2, -3}), 1);
}

TEST(SignFlips, TakeNoSide) {
  EXPECT_EQ(sign_flip_p({1.5, -0.25, 3, 2, 2}), sign_flip_p({-1.5, 0.25, -3, -2, -2}));
}

TEST(SignFlips, ZerosTellNothing) {
  EXPECT_EQ(sign_flip_p({0, 1, 0, 2, 3}), sign_flip_p({1, 2, 3}));
  EXPECT_EQ(sign_flip_p({0, 0}), 1);
}

TEST(SignFlips, UnanimityGivesTheLeastP) {
  const std::vector<Real> eight(8, 0.3), twenty(20, -2);
  EXPECT_EQ(sign_flip_p(eight), 2 / 256.0);
  EXPECT_EQ(sign_flip_p(twenty), std::exp2(-19));
}

// Twenty and twenty-one values about alike: 2^16 flips give a p of 0.05 to a standard error of
// sqrt(0.05 · 0.95 / 2^16) = 0.0009.
TEST(SignFlips, ManyAreDrawnAndAgree) {
  std::vector<Real> values;
  Draws random(0, "test", "signs");
  for (std::size_t i = 0; i < kExactFlips; ++i) values.push_back(random.normal() + 0.45);
  const Real exact = sign_flip_p(values);
  values.push_back(1e-7);
  EXPECT_NEAR(sign_flip_p(values), exact, 0.004);
  EXPECT_EQ(sign_flip_p(values), sign_flip_p(values)) << "the flips are fixed";
}

// scipy.stats.t.ppf(0.975, 11) + t.ppf(0.8, 11) = 2.20098516 + 0.87552998, and 2/9 more.
TEST(SignFlips, WhatTheyFindGrowsWithTheSpread) {
  EXPECT_NEAR(detectable_mean(1.7, 12), 11 / 9.0 * 3.07651514 * 1.7 / std::sqrt(12), 1e-7);
  EXPECT_EQ(detectable_mean(1, 5), INFINITY) << "no p of five pairs is below 0.0625";
  EXPECT_NEAR(deviation_of({1, 2, 3, 4}), std::sqrt(5 / 3.0), kRounding);
}

// scipy.stats.t.ppf, to its digits.
TEST(Student, HasTheQuantilesOfSciPy) {
  EXPECT_NEAR(student_quantile(0.975, 1), 12.7062047364, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.30265272991, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 5), 2.57058183661, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 10), 2.22813885196, 1e-9);
  EXPECT_NEAR(student_quantile(0.8, 11), 0.875529978, 1e-8);
}

// Mean 2, variance 1, t(2) = 4.30265273: ±4.30265273 √(4/3).
TEST(Prediction, AddsBothVariances) {
  const Interval interval = prediction_interval({1, 2, 3});
  const Real half = 4.30265273 * std::sqrt(4 / 3.0);
  EXPECT_NEAR(interval.low, 2 - half, 1e-7);
  EXPECT_NEAR(interval.high, 2 + half, 1e-7);
  EXPECT_EQ(prediction_interval({1}).high, INFINITY);
}

// By hand: of 21 blocks twelve rank 3, 2, 1 and nine 1, 2, 3. The sums are 45, 42 and 39 about 42,
// so χ² = 12 · 18 / (21 · 3 · 4), and p = e^(−χ²/2) at two degrees of freedom.
TEST(Friedman, FollowsItsFormulaInALargeDesign) {
  std::vector<std::vector<Real>> values(12, {3, 2, 1});
  values.resize(21, {0.1, 0.2, 0.3});
  EXPECT_NEAR(friedman_p(values), std::exp(-12 * 18 / (2 * 21.0 * 3 * 4)), kRounding);
}

// Of the six orders of the second block one agrees with the first; of five blocks of two, 2 of 2⁵.
TEST(Friedman, CountsPermutationsInASmallDesign) {
  EXPECT_NEAR(friedman_p({{3, 2, 1}, {9, 5, 4}}), 1 / 6.0, kRounding);
  EXPECT_EQ(friedman_p({{1, 2}, {1, 2}, {1, 2}, {1, 2}, {1, 2}}), 0.0625);
  // The second block's tie leaves three orders, whose squared sums are 6.5 as here, 3.5 and 0.5.
  EXPECT_NEAR(friedman_p({{3, 2, 1}, {9, 4, 4}}), 1 / 3.0, kRounding);
}

// Of 18 blocks of two 14 one way: 2 Σ C(18, j ≥ 14) / 2¹⁸ = 8096 / 262144, by 2¹⁶ drawn
// permutations to a standard error of 0.0007.
TEST(Friedman, DrawsPermutationsWhereThereAreMany) {
  std::vector<std::vector<Real>> values(14, {1, 2});
  values.resize(18, {2, 1});
  EXPECT_NEAR(friedman_p(values), 8096 / 262144.0, 0.003);
}

TEST(Friedman, SeesNoDifferenceAmongTies) {
  EXPECT_EQ(friedman_p({{1, 1, 1}, {2, 2, 2}}), 1);
  EXPECT_EQ(friedman_p({{1, 2}}), 1);
}

// Of two degrees of freedom e^(−x/2); of four (1 + x/2) e^(−x/2); of one erfc(√(x/2)).
TEST(Friedman, TheTailOfChiSquareIsTheClosedOneWhereThereIsOne) {
  for (const Real x : {0.1, 1.0, 3.0, 10.0, 50.0}) {
    EXPECT_NEAR(chi_square_tail(x, 2), std::exp(-x / 2), kRounding) << x;
    EXPECT_NEAR(chi_square_tail(x, 4), (1 + x / 2) * std::exp(-x / 2), kRounding) << x;
    EXPECT_NEAR(chi_square_tail(x, 1), std::erfc(std::sqrt(x / 2)), kRounding) << x;
  }
}

}  // namespace
}  // namespace isoline::results
