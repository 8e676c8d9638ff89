// Running times, areas, ranks and accuracies against hand-computed cases.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "reports/statistics/resampling.h"
#include "reports/statistics/statistics.h"
#include "reports/statistics/tests.h"

namespace isoline::reports {
namespace {

// (100 + 40 + 60) / 2; one success of three: E[T_s] + (1 − p)/p E[T_us] = 60 + 2 · 100 = 260.
TEST(ExpectedRunningTime, IsAllThatWasSpentOverTheSuccesses) {
  EXPECT_EQ(expected_running_time({{100, false}, {40, true}, {60, true}}), 100);
  EXPECT_EQ(expected_running_time({{100, false}, {100, false}, {60, true}}), 260);
  EXPECT_EQ(expected_running_time({{100, false}}), kNever);
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

// From gap 1 down to 1e-2 at work 10 and 1e-4 at 50 of 100, over 8 digits:
// 40/100 · 2/8 + 50/100 · 4/8 = 0.35.
TEST(AreaOverCurve, IsExactForSteps) {
  EXPECT_NEAR(area_over_curve({0, 10, 50}, {1, 1e-2, 1e-4}, 100, 8), 0.35, 1e-15);
  EXPECT_NEAR(area_over_curve({0, 10, 50, 60}, {1, 1e-2, 1e-4, 7}, 100, 8), 0.35, 1e-15)
      << "the best so far counts";
  EXPECT_EQ(area_over_curve({0}, {1}, 100, 8), 0);
  EXPECT_EQ(area_over_curve({}, {}, 100, 8), 0);
  EXPECT_NEAR(area_over_curve({0, 50}, {1, 0}, 100, 8), 0.5, 1e-15);
}

// The ECDF of n targets 10^(−8 j / n) has the same area in the limit.
TEST(AreaOverCurve, IsTheAreaUnderTheEcdfOfManyTargets) {
  const std::vector<Real> work = {0, 3, 17, 40}, gap = {1, 0.3, 2e-3, 5e-7};
  constexpr int kTargets = 100'000;
  Real sum = 0;
  for (int j = 1; j <= kTargets; ++j)
    for (std::size_t i = 0; i < gap.size(); ++i)
      if (gap[i] <= std::pow(10.0, -8.0 * j / kTargets)) {
        sum += 1 - work[i] / 100;
        break;
      }
  EXPECT_NEAR(area_over_curve(work, gap, 100, 8), sum / kTargets, 1e-4);
}

// Five values: the resampled median is the least with chance about 0.058, so 95 % reach all of
// them.
TEST(Bootstrap, OfAMedianSpansWhatResamplesReach) {
  const Interval interval = bootstrap_median({1, 2, 3, 4, 5}, "cell");
  EXPECT_EQ(interval.low, 1);
  EXPECT_EQ(interval.high, 5);
  EXPECT_EQ(bootstrap_median({1, kNever, kNever}, "cell").high, kNever);
  EXPECT_EQ(bootstrap_mean({2, 2}, "cell").low, 2);
}

TEST(MidRanks, ShareTiesAndPutTheUnsolvedLast) {
  EXPECT_EQ(mid_ranks({5, kNever, 3, 5, kNever}), (std::vector<Real>{2.5, 4.5, 1, 2.5, 4.5}));
}

TEST(Quantile, IsTheNearestRank) {
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.5), 2);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.025), 1);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.975), 4);
}

}  // namespace
}  // namespace isoline::reports
