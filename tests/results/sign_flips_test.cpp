// The paired test by sign flips and Friedman's test, against enumeration and SciPy.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/results/tests.h"

namespace isoline::results {
namespace {

constexpr Real kRounding = 1e-12;

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
  EXPECT_EQ(sign_flip_p({}), 1);
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

// scipy.stats.t.ppf(0.975, 11) + t.ppf(0.8, 11) = 2.20098516 + 0.87552998.
TEST(SignFlips, WhatTheyFindGrowsWithTheSpread) {
  EXPECT_NEAR(detectable_mean(1.7, 12), 3.07651514 * 1.7 / std::sqrt(12), 1e-3);
  EXPECT_EQ(detectable_mean(1, 1), INFINITY);
  EXPECT_NEAR(deviation_of({1, 2, 3, 4}), std::sqrt(5 / 3.0), kRounding);
}

// By hand: ranks sum to 6, 4 and 2 over two blocks, so χ² = 12 · 8 / (2 · 3 · 4) = 4 and
// p = e^(−2) at two degrees of freedom.
TEST(Friedman, FollowsItsFormula) {
  EXPECT_NEAR(friedman_p({{3, 2, 1}, {9, 5, 4}}), std::exp(-2), kRounding);
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
