// Medians with infinities and performance profiles, against hand-computed and independent values.
#include "core/results/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isoline::results {
namespace {

TEST(Spread, AnUnsolvedRunCountsAsInfinite) {
  const Spread spread = spread_of({7, kNever, 3, 5, kNever});  // sorted 3 5 7 ∞ ∞
  EXPECT_EQ(spread.median, 7);
  EXPECT_EQ(spread.low, 3);
  EXPECT_EQ(spread.high, kNever);
  EXPECT_EQ(spread.n, 5U);
  EXPECT_EQ(spread.unsolved, 2U);
}

TEST(Spread, NotANumberCountsAsInfinite) {
  const Spread spread = spread_of({NAN, 1, NAN});
  EXPECT_EQ(spread.median, kNever);
  EXPECT_EQ(spread.unsolved, 2U);
}

TEST(Spread, AnEvenCountTakesTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(spread_of({4, 1, 2, 9}).median, 3);
  EXPECT_EQ(spread_of({1, 2, kNever, kNever}).median, kNever);  // (2 + ∞) / 2
}

TEST(Spread, NothingIsKnownOfNoValues) {
  EXPECT_EQ(spread_of({}).n, 0U);
  EXPECT_FALSE(spread_of({}).is_solved());
}

// Three problems, two solvers, by hand: ratios of a are 1, 2, ∞; of b 2, 1, ∞.
TEST(Profile, FollowsTheDefinition) {
  const Profile profile = performance_profile({{10, 20}, {8, 4}, {kNever, NAN}});
  EXPECT_EQ(profile.solvers[0].problems, 3U);  // the one that nobody solves stays
  EXPECT_DOUBLE_EQ(profile.share(0, 1), 1 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(0, 1.99), 1 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(0, 2), 2 / 3.0);
  EXPECT_DOUBLE_EQ(profile.share(1, kNever), 2 / 3.0);
}

TEST(Profile, TiesWinForAll) {
  const Profile profile = performance_profile({{5, 5, 6}});
  EXPECT_EQ(profile.share(0, 1), 1);
  EXPECT_EQ(profile.share(1, 1), 1);
  EXPECT_EQ(profile.share(2, 1), 0);
}

TEST(Profile, AProblemSolvedAtItsStartLeavesTheOthersFinite) {
  const Profile profile = performance_profile({{0, 8, kNever}});
  EXPECT_EQ(profile.solvers[0].ratios, (std::vector<Real>{1}));
  EXPECT_EQ(profile.solvers[1].ratios, (std::vector<Real>{8}));
  EXPECT_TRUE(profile.solvers[2].ratios.empty());
}

TEST(Profile, OneNotANumberDoesNotFailItsRow) {
  const Profile profile = performance_profile({{NAN, 3}});
  EXPECT_EQ(profile.share(1, 1), 1);
  EXPECT_EQ(profile.share(0, 1e9), 0);
}

// Each solver is judged on what was asked of it: a on the first problem, b on both.
TEST(Profile, AProblemNeverAskedIsNotCounted) {
  const Profile profile = performance_profile({{10, 5}, {std::nullopt, kNever}});
  EXPECT_EQ(profile.solvers[0].problems, 1U);
  EXPECT_EQ(profile.share(0, 2), 1);
  EXPECT_EQ(profile.solvers[1].problems, 2U);
  EXPECT_EQ(profile.share(1, kNever), 0.5);
}

// Drawn and counted by a direct transcription of the definition in Python (random.seed(7)); the
// areas there by the midpoint rule with 200,000 points, hence the tolerance.
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
  const std::vector<Real> areas = {0.334617, 0.348248, 0.166667, 0.388247};
  for (std::size_t s = 0; s < 4; ++s) EXPECT_NEAR(profile.area(s, 4), areas[s], 1e-5);
}

}  // namespace
}  // namespace isoline::results
