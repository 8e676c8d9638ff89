// Statistics against hand-computed values and golden/statistics.py, in NumPy and SciPy.
#include "core/results/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/json.h"

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
  EXPECT_EQ(profile.solvers[0].problems, 3U);  // the one that nobody solves stays
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

}  // namespace
}  // namespace isoline::results
