// Tests by ranks against SciPy 1.10.1 and enumeration. Samples: numpy.random.default_rng(7),
// normal, rounded to three digits.
#include <gtest/gtest.h>

#include <map>

#include "core/results/tests.h"

namespace isoline::results {
namespace {

using Sample = std::vector<Real>;

constexpr Real kRounding = 1e-12;  // of sums of probabilities

const Sample kNineA = {10.001, 10.299, 9.726, 9.109, 9.545, 9.008, 10.06, 11.34, 9.508};
const Sample kNineB = {10.38, 11.49, 11.357, 11.105, 10.07, 10.971, 11.695, 9.656, 10.542};
const Sample kNine = {8.099, 8.71, 8.158, 9.765, 8.733, 10.271, 10.157, 9.813, 7.483};
const Sample kTwelve = {9.461, 9.951,  10.113, 8.47,  9.522,  9.021,
                        9.191, 11.061, 9.192,  9.967, 10.884, 9.416};
const Sample kFive = {9.888, 10.11, 10.064, 8.775, 10.076};
const Sample kSeven = {13.359, 10.453, 12.859, 12.119, 11.359, 14.0, 12.762};

// scipy.stats.mannwhitneyu(b, a, method="exact").pvalue
TEST(MannWhitney, AgreesWithSciPy) {
  EXPECT_NEAR(mann_whitney_p({1.1, 2.2, 3.3}, {4.4, 5.5, 6.6}), 0.1, kRounding);
  EXPECT_NEAR(mann_whitney_p(kNineA, kNineB), 0.007774578362813657, kRounding);
  EXPECT_NEAR(mann_whitney_p(kNine, kTwelve), 0.21884802503997552, kRounding);
  EXPECT_NEAR(mann_whitney_p(kFive, kSeven), 0.0025252525252525255, kRounding);
}

// scipy.stats.permutation_test over rank sums with n_resamples=inf: exact, given the ties.
TEST(MannWhitney, IsExactGivenTheTies) {
  EXPECT_NEAR(mann_whitney_p({1, 2, 2, 3, 5}, {2, 3, 4, 4, 5, 6}), 0.18181818181818182, kRounding);
  EXPECT_NEAR(
      mann_whitney_p({10, 10, 10, 11, 11, 12, 13, 13, 14}, {11, 12, 12, 13, 13, 14, 15, 15, 16}),
      0.03677498971616619, kRounding);
  EXPECT_EQ(mann_whitney_p({1, 1, 1}, {1, 1, 1}), 1);
}

TEST(MannWhitney, HasTheLeastPThatItsSizeAllows) {
  const auto apart = [](std::size_t m) {
    Sample a, b;
    for (std::size_t i = 0; i < m; ++i) {
      a.push_back(Real(i));
      b.push_back(1000 + Real(i));
    }
    return mann_whitney_p(a, b);
  };
  EXPECT_NEAR(apart(4), 2 / 70.0, kRounding);  // 2 / C(2m, m)
  EXPECT_NEAR(apart(9), 2 / 48620.0, kRounding);
  EXPECT_LT(apart(60), 1e-15);  // beyond counting out: the normal approximation
}

TEST(MannWhitney, CrossesToTheApproximationWithoutAStep) {
  Sample a, b;  // interleaved but for a shift of four places
  for (int i = 0; i < 50; ++i) {
    a.push_back(2 * i);
    b.push_back(2 * i + 9);
  }
  const Real exact = mann_whitney_p(a, b);
  a.push_back(50.5);
  EXPECT_NEAR(mann_whitney_p(a, b), exact, 0.02);  // one value of a hundred in the middle
}

// scipy.stats.wilcoxon(d, mode="exact").pvalue
// The median and the order statistics of all ratios in NumPy; the order from the null distribution
// of U, counted by its recurrence in whole numbers.
TEST(RatioEstimate, AgreesWithAnIndependentCount) {
  const auto expect = [](const Sample& a, const Sample& b, const RatioEstimate& expected) {
    const RatioEstimate estimate = ratio_estimate(a, b);
    EXPECT_NEAR(estimate.ratio, expected.ratio, kRounding);
    EXPECT_NEAR(estimate.low, expected.low, kRounding);
    EXPECT_NEAR(estimate.high, expected.high, kRounding);
  };
  expect(kNineA, kNineB, {1.1055000548907672, 1.0155658392932272, 1.181369524984577});
  expect(kNine, kTwelve, {1.079631736008309, 0.968868407578085, 1.1681689097419434});
  expect(kFive, kSeven, {1.2762008733624455, 1.1273322747121872, 1.391096979332273});
}

TEST(RatioEstimate, HasNoIntervalOfThreeAgainstThree) {
  const RatioEstimate estimate = ratio_estimate({1, 2, 3}, {2, 4, 6});
  EXPECT_NEAR(estimate.ratio, 2, kRounding);
  EXPECT_EQ(estimate.low, 0);
  EXPECT_EQ(estimate.high, kNever);
}

// Adjusted by NumPy's running minimum over p.
TEST(Adjustment, AgreesWithNumPy) {
  const Sample p = {0.275, 0.008, 0.039, 0.041, 0.042, 0.06,  0.074, 0.205,
                    0.212, 0.216, 0.222, 0.251, 0.269, 0.001, 0.34};
  const Sample discovery = benjamini_hochberg(p);
  const Sample discovery_of = {0.29464285714285715, 0.06, 0.126, 0.126, 0.126, 0.15,
                               0.15857142857142856};
  for (std::size_t i = 0; i < discovery_of.size(); ++i)
    EXPECT_NEAR(discovery[i], discovery_of[i], kRounding) << i;
  EXPECT_NEAR(discovery[13], 0.015, kRounding);
  EXPECT_NEAR(discovery[14], 0.34, kRounding);
}

// n = 10: P(fewer than 2 of Binomial(10, ½)) = 11/1024, fewer than 3: 56/1024. n = 20: fewer
// than 6.
TEST(RankTests, TheIntervalOfAMedianLeavesOutWhatTheTestOfSignsRejects) {
  const auto interval_of_first = [](int n) {
    std::vector<Real> values;
    for (int i = n; i > 0; --i) values.push_back(i);
    return median_interval(values);
  };
  const std::map<int, std::pair<Real, Real>> known = {{1, {1, 1}}, {5, {1, 5}},  {6, {1, 6}},
                                                      {9, {2, 8}}, {10, {2, 9}}, {20, {6, 15}}};
  for (const auto& [n, ends] : known) {
    const MedianInterval interval = interval_of_first(n);
    EXPECT_EQ(interval.low, ends.first) << n;
    EXPECT_EQ(interval.high, ends.second) << n;
    EXPECT_EQ(interval.median, (n + 1) / 2.0) << n;
  }
  EXPECT_EQ(median_interval({}).low, 0);
  // Beyond 1,000 by the normal law, which agrees with the exact one there.
  EXPECT_EQ(interval_of_first(3000).low, 1446);  // ⌊1500 − 1.96 √3000 / 2⌋
  EXPECT_NEAR(interval_of_first(1000).low, interval_of_first(1001).low, 1);
}

}  // namespace
}  // namespace isoline::results
