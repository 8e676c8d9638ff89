// Statistics against values computed by hand and by golden/statistics.py, in NumPy and SciPy.
#include "core/results/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/json.h"
#include "core/random.h"
#include "core/results/decisions.h"

namespace isoline::results {
namespace {

TEST(Spread, AnUnsolvedRunCountsAsInfinite) {
  const Spread spread = spread_of({7, kNever, 3, 5, kNever});  // sorted 3 5 7 ∞ ∞
  EXPECT_EQ(spread.median, 7);
  EXPECT_EQ(spread.low, 3);
  EXPECT_EQ(spread.high, kNever);
  EXPECT_EQ(spread.n, 5U);
  EXPECT_EQ(spread.unsolved, 2U);
  const Spread nan = spread_of({NAN, 1, NAN});
  EXPECT_EQ(nan.median, kNever);
  EXPECT_EQ(nan.unsolved, 2U);
  EXPECT_EQ(spread_of({}).n, 0U);
  EXPECT_FALSE(spread_of({}).is_solved());
}

TEST(Spread, AnEvenCountTakesTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(spread_of({4, 1, 2, 9}).median, 3);
  EXPECT_EQ(spread_of({1, 2, kNever, kNever}).median, kNever);  // (2 + ∞) / 2
}

// Three problems, two solvers, by hand: ratios of a are 1, 2, ∞; of b 2, 1, ∞.
TEST(Profile, FollowsTheDefinition) {
  const Profile profile = performance_profile({{10, 20}, {8, 4}, {kNever, NAN}});
  EXPECT_EQ(profile.solvers[0].problems, 3U);  // the unsolved one stays
  EXPECT_DOUBLE_EQ(profile.share(0, 1), 1 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(0, 1.99), 1 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(0, 2), 2 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(1, kNever), 2 / 3.0);
  const Profile ties = performance_profile({{5, 5, 6}});  // ties win for all
  EXPECT_EQ(ties.share(0, 1), 1);
  EXPECT_EQ(ties.share(1, 1), 1);
  EXPECT_EQ(ties.share(2, 1), 0);
  const Profile nan = performance_profile({{NAN, 3}});  // does not fail its row
  EXPECT_EQ(nan.share(1, 1), 1);
  EXPECT_EQ(nan.share(0, 1e9), 0);
}

TEST(Profile, AProblemSolvedAtItsStartLeavesTheOthersFinite) {
  const Profile profile = performance_profile({{0, 8, kNever}});
  EXPECT_EQ(profile.solvers[0].ratios, (std::vector<Real>{1}));
  EXPECT_EQ(profile.solvers[1].ratios, (std::vector<Real>{8}));
  EXPECT_TRUE(profile.solvers[2].ratios.empty());
  // Each solver is judged on what was asked of it: the first on one problem, the second on both.
  const Profile asked = performance_profile({{10, 5}, {std::nullopt, kNever}});
  EXPECT_EQ(asked.share(0, 2), 1);
  EXPECT_EQ(asked.solvers[1].problems, 2U);
  EXPECT_EQ(asked.share(1, kNever), 0.5);
}

// Drawn and counted by a direct transcription of the definition in Python (random.seed(7)).
TEST(Profile, AgreesWithAnIndependentImplementation) {
  const Profile profile = performance_profile({{10, 4, kNever, 24},
                                               {59, 3, kNever, 16},
                                               {kNever, 53, 15, 38},
                                               {kNever, kNever, kNever, kNever},
                                               {10, 37, 53, 7},
                                               {41, kNever, kNever, 37}});
  const std::vector<std::pair<Real, std::vector<int>>> counts = {
      {1, {0, 2, 1, 2}}, {1.5, {2, 2, 1, 2}}, {2, {2, 2, 1, 2}},
      {4, {3, 3, 1, 3}}, {10, {3, 4, 2, 5}},  {1e9, {4, 4, 2, 5}}};
  for (const auto& [factor, solved] : counts)
    for (std::size_t s = 0; s < 4; ++s)
      EXPECT_DOUBLE_EQ(profile.share(s, factor), solved[s] / 6.0) << factor << ", solver " << s;
}

// (100 + 40 + 60) / 2; one success of three: E[T_s] + (1 − p)/p E[T_us] = 60 + 2 · 100 = 260.
TEST(ExpectedRunningTime, IsAllThatWasSpentOverTheSuccesses) {
  EXPECT_EQ(expected_running_time({{100, false}, {40, true}, {60, true}}), 100);
  EXPECT_EQ(expected_running_time({{100, false}, {100, false}, {60, true}}), 260);
  EXPECT_EQ(expected_running_time({{100, false}}), kNever);
}

// By uncorrected sums of squares, v = numpy.array(…), C = v.sum()**2/12:
//   MSi = ((v.sum(1)**2).sum()/3 − C)/3, MSj = ((v.sum(0)**2).sum()/4 − C)/2,
//   MSe = ((v**2).sum() − C − 3*MSi − 2*MSj)/6; (MSi − MSe)/3, (MSj − MSe)/4, MSe.
TEST(VarianceComponents, AreThoseOfTheBalancedTwoWayDesign) {
  const auto parts =
      variance_components({{5.1, 6.0, 5.7}, {7.9, 9.2, 8.1}, {3.2, 4.6, 4.4}, {6.6, 7.1, 7.5}});
  EXPECT_NEAR(parts.first, 3.4508333333333, 1e-12);
  EXPECT_NEAR(parts.second, 0.2472222222222, 1e-12);
  EXPECT_NEAR(parts.rest, 0.1219444444444, 1e-12);
  const auto interaction = variance_components({{1, 2}, {2, 1}});
  EXPECT_EQ(interaction.first, 0) << "its estimate is below 0";
  EXPECT_EQ(interaction.second, 0);
  EXPECT_NEAR(interaction.rest, 1, 1e-12);
}

// Failures before the first success of chance ½ are geometric with mean 1: E = 10 + 100.
TEST(SimulatedRestarts, HaveTheExpectedMean) {
  const std::vector<Real> costs = simulated_restarts({{100, false}, {10, true}}, "cell");
  ASSERT_EQ(costs.size(), kDraws);
  const Real mean = std::accumulate(costs.begin(), costs.end(), 0.0) / Real(kDraws);
  EXPECT_NEAR(mean, 110, 3 * 100 * std::sqrt(2.0 / Real(kDraws)));  // three standard errors
  EXPECT_EQ(costs.front(), 10);
  EXPECT_EQ(simulated_restarts({{5, false}}, "cell").front(), kNever);
  EXPECT_EQ(simulated_restarts({{5, true}}, "cell").back(), 5);
}

TEST(Quantile, IsTheNearestRank) {
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.5), 2);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.025), 1);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.975), 4);
}

// Of {0, 0, 1} one value is 1 in a third of the draws, one of two in two thirds.
TEST(BestOf, IsTheExpectationOverAllSubsets) {
  const std::vector<Real> few = expected_best({0, 1, 0});
  ASSERT_EQ(few.size(), 3U);
  EXPECT_TRUE(expected_best({}).empty());
  EXPECT_NEAR(few[0], 1.0 / 3, 1e-15);
  EXPECT_NEAR(few[1], 2.0 / 3, 1e-15);
  EXPECT_NEAR(few[2], 1, 1e-15);
  const std::vector<Real> values = {3, -1, 4, 1, -5, 9, 2};
  const std::vector<Real> best = expected_best(values);
  for (std::size_t b = 1; b <= values.size(); ++b) {
    Real sum = 0, count = 0;
    for (unsigned subset = 1; subset < 1U << values.size(); ++subset) {
      if (std::popcount(subset) != static_cast<int>(b)) continue;
      Real greatest = -std::numeric_limits<Real>::infinity();
      for (std::size_t i = 0; i < values.size(); ++i)
        if ((subset >> i & 1U) != 0) greatest = std::max(greatest, values[i]);
      sum += greatest;
      count += 1;
    }
    EXPECT_NEAR(best[b - 1], sum / count, 1e-13) << b;
  }
}

constexpr Real kRounding = 1e-12;

const Json& golden() {
  static const Json json = read_json(ISOLINE_SOURCE_DIR "/tests/results/golden/statistics.json");
  return json;
}

Costs golden_costs() {
  Costs costs;
  for (const Json& row : golden().at("costs")) {
    costs.emplace_back();
    for (const Json& cost : row) costs.back().push_back(real_of(cost));
  }
  return costs;
}

TEST(Golden, ProfilesHaveTheSharesThatNumPyCounts) {
  const Profile profile = performance_profile(golden_costs());
  const Json &factors = golden().at("factors"), &shares = golden().at("shares");
  ASSERT_EQ(profile.solvers.size(), shares.size());
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (std::size_t i = 0; i < factors.size(); ++i)
      EXPECT_NEAR(profile.share(s, factors[i]), shares[s][i].get<Real>(), kRounding)
          << "solver " << s << ", factor " << factors[i];
}

// The closed form against the trapezoidal rule over 2²⁰ intervals: each of at most 12 steps of 1/12
// is off by half an interval of 2⁻²⁰ at most.
TEST(Golden, MeanScoresAreTheIntegralsOfTheProfiles) {
  const Costs costs = golden_costs();
  std::vector<Real> means(costs[0].size(), 0);
  for (const auto& row : costs)
    for (std::size_t s = 0; s < row.size(); ++s)
      means[s] += score_of(*cost_ratios(row)[s], 64) / Real(costs.size());
  for (std::size_t s = 0; s < means.size(); ++s)
    EXPECT_NEAR(means[s], golden().at("areas")[s].get<Real>(), 1e-6) << s;
}

TEST(Golden, ExpectedRunningTimeIsThatOfGeometricRestarts) {
  std::vector<Attempt> attempts;
  for (std::size_t i = 0; i < golden().at("spent").size(); ++i)
    attempts.push_back({golden()["spent"][i], golden().at("success")[i]});
  EXPECT_NEAR(expected_running_time(attempts), golden().at("ert").get<Real>(), 1e-10);
}

// Rank tests and sign-flip tests against SciPy 1.10.1 and enumeration, and verdicts on times over
// simulated jobs. Samples: numpy.random.default_rng(7), normal, rounded to three digits.

using Sample = std::vector<Real>;

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
  EXPECT_EQ(sign_flip_p({1.5, -0.25, 3, 2, 2}), sign_flip_p({-1.5, 0.25, -3, -2, -2}));
  EXPECT_EQ(sign_flip_p({0, 1, 0, 2, 3}), sign_flip_p({1, 2, 3})) << "zeros say nothing";
  EXPECT_EQ(sign_flip_p({0, 0}), 1);
  EXPECT_EQ(sign_flip_p(std::vector<Real>(8, 0.3)), 2 / 256.0) << "unanimity gives the least p";
  EXPECT_EQ(sign_flip_p(std::vector<Real>(20, -2)), std::exp2(-19));
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

constexpr std::size_t kPairs = 100;  // of jobs

// Noise as seen on shared machines: repetitions vary by some percent, one in ten is delayed by up
// to a quarter, and a whole job runs faster or slower than another, the more so a single cell of
// it.
struct Noise {
  Real repetition = 0.03, delayed = 0.1, job = 0.015, cell = 0.01;
};

std::vector<Real> repetitions(RandomStream& random, const Noise& noise, Real seconds) {
  seconds *= std::exp(noise.cell * random.normal());
  std::vector<Real> all;
  for (std::size_t i = 0; i < kLeastRepetitions; ++i) {
    const Real delay = random.uniform() < noise.delayed ? 0.25 * random.uniform() : 0;
    all.push_back(seconds * std::exp(noise.repetition * random.normal()) * (1 + delay));
  }
  return all;
}

// Two jobs of twenty cells; the first cell of the second takes `factor` times as long.
std::vector<TimedCell> two_jobs(std::uint64_t pair, const Noise& noise, Real factor) {
  RandomStream random(pair, "timing", "jobs");
  const Real before = std::exp(noise.job * random.normal());
  const Real after = std::exp(noise.job * random.normal());
  std::vector<TimedCell> cells;
  for (std::size_t i = 0; i < kMostTimed; ++i) {
    const Real seconds = std::pow(10.0, random.uniform(-4, 0));
    const std::string key = std::to_string(pair) + "/" + std::to_string(i);
    cells.push_back({.key = key,
                     .title = key,
                     .before = repetitions(random, noise, before * seconds),
                     .after = repetitions(random, noise, after * seconds * (i == 0 ? factor : 1))});
  }
  return cells;
}

struct Tally {
  std::size_t false_pairs = 0, found = 0;
};

Tally tally_of(const Noise& noise, Real factor) {
  Tally tally;
  for (std::uint64_t pair = 0; pair < kPairs; ++pair) {
    bool is_false = false;
    for (const TimeVerdict& verdict : judge_times(two_jobs(pair, noise, factor), kLeastNoise)) {
      const bool is_planted = factor != 1 && verdict.key.ends_with("/0");
      if (is_planted)
        tally.found += verdict.change == 1;
      else
        is_false = is_false || verdict.change != 0;
    }
    tally.false_pairs += is_false;
  }
  return tally;
}

TEST(Timing, AtMostFiveOfAHundredPairsOfEqualJobsAreCalledDifferent) {
  EXPECT_LE(tally_of({}, 1).false_pairs, 5U);
  EXPECT_LE(tally_of({.repetition = 0.1, .delayed = 0.2}, 1).false_pairs, 5U) << "a noisy machine";
  EXPECT_LE(tally_of({.repetition = 0.002, .delayed = 0}, 1).false_pairs, 5U) << "a quiet one";
}

TEST(Timing, ASlowdownOfThirtyPercentIsFoundInNinetyFiveOfAHundred) {
  const Tally usual = tally_of({}, 1.3);
  EXPECT_GE(usual.found, 95U);
  EXPECT_LE(usual.false_pairs, 5U);
  EXPECT_GE(tally_of({.repetition = 0.05}, 1.3).found, 95U);
}

TEST(Timing, ASpeedupIsFasterAndTheWorstComesFirst) {
  std::vector<TimedCell> cells = two_jobs(1, {.delayed = 0}, 1.5);
  for (Real& seconds : cells[1].after) seconds /= 2;
  const std::vector<TimeVerdict> verdicts = judge_times(cells, kLeastNoise);
  EXPECT_EQ(verdicts.front().key, "1/0");
  EXPECT_EQ(verdicts.front().change, 1);
  EXPECT_EQ(verdicts.back().key, "1/1");
  EXPECT_EQ(verdicts.back().change, -1);
}

// Halves of {1 … 1} agree; halves of a sample that spreads by a factor of ten do not.
TEST(Timing, NoiseIsWhatTheRepetitionsShow) {
  const std::vector<Real> still(9, 1.0), wild = {1, 2, 3, 4, 5, 6, 7, 8, 10};
  EXPECT_EQ(split_noise({{"a", "a", still, still}}), 0);
  EXPECT_GT(split_noise({{"a", "a", wild, wild}}), 0.3);
  EXPECT_EQ(split_noise({{"a", "a", {1}, {1}}}), kNever);
}

TEST(Timing, IsTheSameEachTime) {
  const std::vector<TimedCell> cells = two_jobs(3, {}, 1.1);
  const auto first = judge_times(cells, kLeastNoise), second = judge_times(cells, kLeastNoise);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].noise, second[i].noise);
}

// A rank that equals no other must end the search for its equals.
TEST(Timing, RanksOfWhatIsNotANumberEnd) {
  const std::vector<Real> with_nan = {0.1, std::nan(""), 0.2};
  EXPECT_LE(mann_whitney_p(with_nan, {0.1, 0.3, 0.4}), 1);
}

// Among all orders of the blocks after the first, those whose sums of ranks differ as much.
TEST(Friedman, CountsOrPermutesTheOrdersOfBlocks) {
  EXPECT_NEAR(friedman_p({{3, 2, 1}, {9, 5, 4}}), 1 / 6.0, kRounding);
  EXPECT_NEAR(friedman_p({{3, 2, 1}, {9, 4, 4}}), 1 / 3.0, kRounding);
  EXPECT_EQ(friedman_p({{1, 2}, {1, 2}, {1, 2}, {1, 2}, {1, 2}}), 0.0625);
  EXPECT_EQ(friedman_p({{1, 1, 1}, {2, 2, 2}}), 1);
  EXPECT_EQ(friedman_p({{1, 2}}), 1);
  EXPECT_EQ(friedman_p(std::vector<std::vector<Real>>(6, {1, 2, 3, 4, 5, 6, 7, 8})), 1e-4);
}

}  // namespace
}  // namespace isoline::results
