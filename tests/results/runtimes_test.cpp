// Running times, areas, ranks and accuracies against hand-computed cases.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/results/statistics.h"
#include "core/results/tests.h"

namespace isoline::results {
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

TEST(MidRanks, ShareTiesAndPutTheUnsolvedLast) {
  EXPECT_EQ(mid_ranks({5, kNever, 3, 5, kNever}), (std::vector<Real>{2.5, 4.5, 1, 2.5, 4.5}));
}

TEST(Quantile, IsTheNearestRank) {
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.5), 2);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.025), 1);
  EXPECT_EQ(quantile({1, 2, 3, 4}, 0.975), 4);
}

}  // namespace
}  // namespace isoline::results
