// The decision: the leading method, the group not significantly worse than the best, and
// sensitivity. Small cases by hand, levels against enumeration.
#include "core/results/decisions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/draws.h"
#include "core/results/statistics.h"
#include "core/seeds.h"

namespace isoline::results {
namespace {

constexpr Real kRounding = 1e-12;

std::vector<std::string> families_apart(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t p = 0; p < count; ++p) names.push_back("p" + std::to_string(p));
  return names;
}

// The first needs 10 everywhere, all others a little more, in turn.
Evidence clear_lead(std::size_t problems, std::size_t methods) {
  Evidence evidence{.families = families_apart(problems)};
  for (std::size_t p = 0; p < problems; ++p) {
    evidence.costs.emplace_back();
    for (std::size_t s = 0; s < methods; ++s)
      evidence.costs[p].push_back(s == 0 ? 10 : 40 + 3 * Real((s + p) % (methods - 1)));
  }
  return evidence;
}

// Ratios 1, 2 and 64 of 64: log2 gives 1, 1 − 1/6 and 0; what is unsolved has 0.
TEST(Decision, ScoresAreAreasOfProfiles) {
  const auto decision =
      decide({.costs = {{5, 10, 320, kNever}, {16, 8, 8, 8}}, .families = {"a", "b"}});
  ASSERT_TRUE(decision);
  EXPECT_NEAR(decision->place_of(0)->score, (1 + 5 / 6.0) / 2, kRounding);
  EXPECT_NEAR(decision->place_of(1)->score, (1 + 5 / 6.0) / 2, kRounding);
  EXPECT_NEAR(decision->place_of(2)->score, 0.5, kRounding);
  EXPECT_NEAR(decision->place_of(3)->score, 0.5, kRounding);
  EXPECT_EQ(decision->tied, 2U);
  EXPECT_EQ(decision->place_of(3)->solved, 1U);
  EXPECT_EQ(decision->place_of(3)->wins, 1U);
  EXPECT_EQ(decision->places[0].method, 0U);
}

// Of three settings the second is ahead on two, which share a family: each is ahead on one family.
TEST(Decision, ScoresAreMeansOverFamilies) {
  const auto decision =
      decide({.costs = {{20, 10}, {20, 10}, {10, 20}}, .families = {"a", "a", "b"}});
  ASSERT_TRUE(decision);
  EXPECT_NEAR(decision->place_of(0)->score, (5 / 6.0 + 1) / 2, kRounding);
  EXPECT_NEAR(decision->place_of(1)->score, (5 / 6.0 + 1) / 2, kRounding);
  EXPECT_EQ(decision->tied, 2U);
  EXPECT_NEAR(decision->places[0].share_first, 0.5, 0.064) << "so do samples of families";
}

// Eight problems, ten methods, one first on all: 2 of 2⁸ flips are as far out as the data, for each
// rival alone.
TEST(Decision, AFirstPlaceOnAllProblemsLeadsAndIsTheWholeGroup) {
  const auto decision = decide(clear_lead(8, 10));
  ASSERT_TRUE(decision);
  EXPECT_TRUE(decision->is_lead);
  EXPECT_EQ(decision->group(), std::vector<std::size_t>{0});
  EXPECT_EQ(decision->least_p, 2 / 256.0);
  for (std::size_t s = 1; s < 10; ++s) EXPECT_EQ(decision->place_of(s)->p, 2 / 256.0);
  EXPECT_EQ(decision->places[0].share_first, 1);
  for (const Choice& choice : decision->choices) EXPECT_TRUE(choice.is_kept) << choice.value;
}

// 1,000 against 1,001 on each of eight families is significant, and nothing to a user.
TEST(Decision, ATwinWithinTheMarginOfWorkIsNotBehind) {
  const Evidence evidence{.costs = Costs(8, {1000, 1001, 9000}), .families = families_apart(8)};
  const auto decision = decide(evidence);
  ASSERT_TRUE(decision);
  EXPECT_FALSE(decision->is_lead);
  EXPECT_EQ(decision->group(), (std::vector<std::size_t>{0, 1}));
}

// 2^(1−5) = 0.0625: no result over five families can be significant.
TEST(Decision, FiveFamiliesDecideNothing) {
  const auto decision = decide(clear_lead(5, 3));
  ASSERT_TRUE(decision);
  EXPECT_FALSE(decision->is_lead);
  EXPECT_EQ(decision->group().size(), 3U);
  EXPECT_EQ(decision->places[1].p, 0.0625);
  EXPECT_TRUE(decision->is_range);
  EXPECT_EQ(decision->detectable, kNever);
}

TEST(Decision, VariantsOfOneProblemAreOneWitness) {
  Evidence evidence = clear_lead(6, 4);
  const auto once = decide(evidence);
  const std::size_t count = evidence.costs.size();
  for (std::size_t p = 0; p < count; ++p) {
    evidence.costs.push_back(evidence.costs[p]);
    evidence.families.push_back(evidence.families[p]);
  }
  const auto twice = decide(evidence);
  for (std::size_t i = 0; i < once->places.size(); ++i) {
    EXPECT_EQ(once->places[i].p, twice->places[i].p);
    EXPECT_EQ(once->places[i].adjusted, twice->places[i].adjusted);
    EXPECT_NEAR(once->places[i].interval.low, twice->places[i].interval.low, kRounding);
  }
  EXPECT_EQ(twice->families, 6U);
  EXPECT_EQ(twice->settings, 12U);
}

// The fifth method is the best where it was run.
TEST(Decision, AMethodThatWasNotRunOnEverySettingMovesNoOther) {
  Evidence evidence = clear_lead(8, 4);
  const auto without = decide(evidence);
  for (auto& row : evidence.costs) {
    row.push_back(1);
    row.emplace_back();
  }
  evidence.costs[3][4].reset();
  const auto with = decide(evidence);
  EXPECT_EQ(with->unranked, std::vector<std::size_t>{4}) << "the sixth was never run at all";
  ASSERT_EQ(with->places.size(), without->places.size());
  for (std::size_t i = 0; i < with->places.size(); ++i) {
    EXPECT_EQ(with->places[i].method, without->places[i].method);
    EXPECT_EQ(with->places[i].score, without->places[i].score);
    EXPECT_EQ(with->places[i].p, without->places[i].p);
  }
}

TEST(Decision, NothingIsDecidedWhereNothingIsSolved) {
  EXPECT_FALSE(decide({.costs = {{kNever, kNever}}, .families = {"a"}}));
  EXPECT_FALSE(decide({}));
}

// --- sensitivity to choices

bool is_kept(const Decision& decision, Varied varied, const std::string& value) {
  const auto choice = std::ranges::find_if(decision.choices, [&](const Choice& each) {
    return each.varied == varied && each.value == value;
  });
  EXPECT_NE(choice, decision.choices.end()) << value;
  return choice != decision.choices.end() && choice->is_kept;
}

// Ratios of the second: 1, 1 and 100, of the first 4, 4 and 1. Up to 64: 1 − 2/6 twice and 1
// against 1 twice and 0; up to 16: 1/2 twice and 1 against 2; up to 256: 3/4 twice and 1 against 2
// and 0.17.
TEST(Decision, NamesTheChoicesThatWouldPutAnotherFirst) {
  Evidence evidence{.costs = {{50, 10}, {50, 10}, {10, 1000}}, .families = {"a", "b", "c"}};
  evidence.others = {{Varied::measure, "time", {{2, 9}, {2, 9}, {2, 9}}},
                     {Varied::tolerance, "0.1", {{9, 2}, {9, 2}, {9, 2}}}};
  for (const auto& row : evidence.costs)
    evidence.repetitions.push_back({{.seed = 0, .costs = row}, {.seed = 1, .costs = {5, 1}}});
  const auto decision = decide(evidence);
  ASSERT_EQ(decision->places[0].method, 0U);
  EXPECT_FALSE(is_kept(*decision, Varied::profile_end, "16"));
  EXPECT_TRUE(is_kept(*decision, Varied::measure, "time"));
  EXPECT_FALSE(is_kept(*decision, Varied::tolerance, "0.1"));
  EXPECT_TRUE(is_kept(*decision, Varied::family, "a"));
  EXPECT_FALSE(is_kept(*decision, Varied::family, "c"));
  EXPECT_TRUE(is_kept(*decision, Varied::seed, "0"));
  EXPECT_FALSE(is_kept(*decision, Varied::seed, "1"));
}

// The end that ranks is not another choice.
TEST(Decision, IsHeldAgainstOtherChoicesOnly) {
  std::vector<std::string> ends;
  const auto decision = decide(clear_lead(6, 3));
  for (const Choice& choice : decision->choices)
    if (choice.varied == Varied::profile_end) ends.push_back(choice.value);
  EXPECT_EQ(ends, (std::vector<std::string>{"16", "256"}));
}

// The second is the first again, so that their difference alone would call anything detectable.
TEST(Decision, CallsDetectableWhatAMiddlingRivalShows) {
  Evidence evidence{.families = families_apart(8)};
  for (std::size_t p = 0; p < 8; ++p)
    evidence.costs.push_back({10, 10, p % 2 == 0 ? 20 : 80, p % 2 == 0 ? 80 : 320});
  const auto decision = decide(evidence);
  ASSERT_EQ(decision->places[1].score, 1);
  const Real each =
      detectable_mean(deviation_of({0, 2 / 6.0, 0, 2 / 6.0, 0, 2 / 6.0, 0, 2 / 6.0}), 8);
  EXPECT_NEAR(decision->detectable, each, kRounding);
}

// Of two families each method is best on one by as much. A sample that draws the first twice (a
// quarter) has the first ahead, one that draws both (a half) has both.
TEST(Decision, TheBootstrapSharesTies) {
  const auto decision = decide({.costs = {{10, 20}, {20, 10}}, .families = {"a", "b"}});
  // Of 1,000 samples a half has a standard error of 0.016; four of them.
  EXPECT_NEAR(decision->places[0].share_first, 0.5, 0.064);
  EXPECT_NEAR(decision->places[0].share_first + decision->places[1].share_first, 1, kRounding);
}

// Two seeds. On the first the first method is ahead, on the second the other and by less: the
// median is their mean. A sample of seeds 1, 1 (a quarter) alone puts the other first.
TEST(Decision, TheBootstrapDrawsSeeds) {
  Evidence evidence{.costs = {{10, 20}}, .families = {"a"}};
  evidence.repetitions = {{{.seed = 0, .costs = {10, 40}}, {.seed = 1, .costs = {10, 9}}}};
  const auto decision = decide(evidence);
  EXPECT_NEAR(decision->places[0].share_first, 0.75, 4 * 0.014);  // four standard errors
}

// Two instances with fifty equal starts each are two values: the first method is ahead in the
// sample of the first instance alone, a quarter. One hundred independent seeds would give a half.
TEST(Decision, TheBootstrapDrawsInstancesAndWithinThemStarts) {
  Evidence evidence{.costs = {{25, 20}}, .families = {"a"}, .repetitions = {{}}};
  for (std::uint64_t start = 0; start < 50; ++start)
    for (const std::uint64_t instance : {0U, 1U})
      evidence.repetitions[0].push_back(
          {.seed = seed_of(instance, start), .costs = {instance == 0 ? 10 : 40, 20}});
  const auto decision = decide(evidence);
  EXPECT_NEAR(decision->place_of(0)->share_first, 0.25, 4 * 0.014);  // four standard errors
}

// --- ratios of work

// Both solve a1, a2 and b: by family log2 is the middle of 8 and 10, and −1; the middle of these 4.
TEST(WorkRatio, IsTheMiddleOfFamiliesThatBothSolve) {
  const Costs costs = {{2560, 10}, {10240, 10}, {5, 10}, {7, kNever}, {kNever, kNever}, {3, {}}};
  const WorkRatio ratio = work_ratio(costs, {"a", "a", "b", "c", "d", "e"}, 0, 1);
  EXPECT_NEAR(ratio.median, 16, kRounding);
  EXPECT_NEAR(ratio.high, 512, 1e-9) << "a true ratio, beyond the profile's end";
  EXPECT_NEAR(ratio.low, 0.5, kRounding);
  EXPECT_TRUE(ratio.is_range());
  EXPECT_EQ(ratio.families, 2U);
  EXPECT_EQ(ratio.both, 3U);
  EXPECT_EQ(ratio.only_a, 1U);
  EXPECT_EQ(ratio.only_b, 0U);
  EXPECT_EQ(ratio.neither, 1U);
}

// --- levels against enumeration in another order

using Rows = std::vector<std::vector<Real>>;

Rows random_sums(std::size_t families, std::size_t methods, std::uint64_t seed) {
  Draws random(seed, "test", "sums");
  Rows sums(families, std::vector<Real>(methods));
  for (auto& row : sums)
    for (std::size_t s = 0; s < methods; ++s) row[s] = random.uniform() + 0.2 * Real(s);
  return sums;
}

// Greatest studentized difference among these methods under the signs of `flip`, from the
// definition; `behind` is the method against which it is.
Real greatest(const Rows& sums, const std::vector<std::size_t>& among, std::size_t flip,
              std::size_t* behind) {
  Real most = -1;
  for (const std::size_t s : among)
    for (const std::size_t t : among) {
      if (s == t) continue;
      Real sum = 0, squares = 0;
      for (std::size_t g = 0; g < sums.size(); ++g) {
        const Real difference = sums[g][t] - sums[g][s];
        sum += (flip >> g & 1U) == 1 ? -difference : difference;
        squares += difference * difference;
      }
      if (sum / std::sqrt(squares) <= most) continue;
      most = sum / std::sqrt(squares);
      *behind = s;
    }
  return most;
}

TEST(FlipLevels, AreThoseOfAllFlips) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    constexpr std::size_t kFamilies = 7, kMethods = 5;
    const Rows sums = random_sums(kFamilies, kMethods, seed);
    const FlipLevels levels = flip_levels(sums);
    std::vector<std::size_t> left = {0, 1, 2, 3, 4};
    Real level = 0;
    while (left.size() > 1) {
      std::size_t leaving = 0, ignored = 0, hits = 0;
      const Real observed = greatest(sums, left, 0, &leaving);
      for (std::size_t flip = 0; flip < 1U << kFamilies; ++flip)
        hits += greatest(sums, left, flip, &ignored) >= observed - 1e-9;
      level = std::max(level, Real(hits) / Real(1U << kFamilies));
      EXPECT_NEAR(levels.leaves[leaving], level, kRounding);
      std::erase(left, leaving);
    }
    EXPECT_EQ(levels.leaves[left[0]], 1);
    for (std::size_t s = 0; s < kMethods; ++s)
      for (std::size_t t = 0; t < s; ++t) {
        std::size_t ignored = 0, hits = 0;
        const Real observed = greatest(sums, {s, t}, 0, &ignored);
        for (std::size_t flip = 0; flip < 1U << kFamilies; ++flip)
          hits += greatest(sums, {s, t}, flip, &ignored) >= observed - 1e-9;
        EXPECT_NEAR(levels.pairs[s][t], Real(hits) / Real(1U << kFamilies), kRounding);
      }
  }
}

// 21 families are drawn: a p of 0.05 has a standard error of 0.0009.
TEST(FlipLevels, OfManyFamiliesAreDrawnAndAgree) {
  Rows sums = random_sums(20, 3, 4);
  const FlipLevels exact = flip_levels(sums);
  sums.push_back({1e-7, 0, 0});
  const FlipLevels drawn = flip_levels(sums);
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_NEAR(drawn.leaves[s], exact.leaves[s], 0.01);
    EXPECT_NEAR(drawn.pairs[s][2], exact.pairs[s][2], 0.01);
  }
  EXPECT_EQ(flip_levels(sums).leaves, drawn.leaves) << "the flips are fixed";
}

// --- intervals

// Six families, all scores 1/2: 3/4 of a family of each end are added. The mean stays 1/2;
// (2 (0.75 / 2)²) 8 / 7 under the root, over 7.5 families; t(5) = 2.570582.
TEST(ScoreInterval, AddsThreeQuartersOfAFamilyAtEachEnd) {
  const Interval interval = score_interval(std::vector<Real>(6, 0.5));
  const Real half = 2.570582 * std::sqrt(2 * 0.375 * 0.375 * 8 / 7) / 7.5;
  EXPECT_NEAR(interval.low, 0.5 - half, 1e-6);
  EXPECT_NEAR(interval.high, 0.5 + half, 1e-6);
}

TEST(ScoreInterval, OfFiveFamiliesIsTheirRange) {
  const Interval interval = score_interval({1, 0.5, 0, 0.75, 1});
  EXPECT_EQ(interval.low, 0);
  EXPECT_EQ(interval.high, 1);
}

}  // namespace
}  // namespace isoline::results
