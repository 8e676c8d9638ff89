// Who is ahead, by how much, and when that is settled: counts by hand, and simulated data.
#include "reports/read/lead.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace isoline::reports {
namespace {

Groups one_each(std::size_t problems) {
  Groups groups;
  for (std::size_t p = 0; p < problems; ++p) groups.push_back({p});
  return groups;
}

std::optional<Lead> lead_over(const Costs& costs) {
  return lead_among(costs, one_each(costs.size()), std::vector<bool>(costs[0].size(), true));
}

TEST(Leads, AConstantFactorIsSettled) {
  const Costs costs(9, {10, 30});
  const auto lead = lead_over(costs);
  ASSERT_TRUE(lead.has_value());
  EXPECT_EQ(lead->ranked[0].optimizer, 0U);
  EXPECT_EQ(lead->ranked[0].score, 1);
  EXPECT_EQ(lead->ranked[0].wins, 9U);
  EXPECT_DOUBLE_EQ(lead->rivals[0].pairing.typical(), 3);
  EXPECT_EQ(lead->rivals[0].pairing.wins, 9U);
  EXPECT_EQ(lead->rivals[0].p, 2 / 512.0);
  EXPECT_TRUE(lead->is_settled);
  EXPECT_EQ(lead->told(), 1U);
}

TEST(Leads, SevenProblemsSettleNothing) {
  EXPECT_FALSE(lead_over(Costs(7, {10, 1000}))->is_settled);
  EXPECT_TRUE(lead_over(Costs(8, {10, 1000}))->is_settled);
}

// The same algorithm under two names, ahead of a third.
TEST(Leads, ATieIsCalledATie) {
  Costs costs;
  for (int p = 0; p < 12; ++p) costs.push_back({10.0 + p, 10.0 + p, 70});
  const auto lead = lead_over(costs);
  EXPECT_EQ(lead->tied, 2U);
  EXPECT_FALSE(lead->is_settled);
  EXPECT_EQ(lead->stays_first, 0.5) << "ties share the first place in every draw";
  EXPECT_EQ(lead->rivals[0].p, 1);
}

TEST(Leads, NobodyLeadsWhereNothingIsSolved) {
  EXPECT_FALSE(lead_over(Costs(3, {kNever, kNever})).has_value());
}

TEST(Leads, SolvingAgainstNotSolvingIsSixDoublings) {
  const auto lead = lead_over(Costs(8, {10, kNever}));
  EXPECT_EQ(lead->rivals[0].pairing.typical(), 64);
  EXPECT_EQ(lead->ranked[1].solved, 0U);
}

// One setting each way: 10 to 1 for either is a tie of the name, and no win of either.
TEST(Leads, TwoSettingsThatDisagreeAreATie) {
  const Costs costs = {{1, 1024}, {1024, 1}};
  const Pairing pairing = pairing_of(costs, {{0, 1}}, 0, 1);
  EXPECT_EQ(pairing.doublings, (std::vector<Real>{0}));
  EXPECT_EQ(pairing.ties, 1U);
  EXPECT_EQ(pairing.typical(), 1);
}

TEST(Leads, WhatNeitherSolvesIsLeftOut) {
  const Pairing pairing = pairing_of({{kNever, kNever}, {1, 4}}, one_each(2), 0, 1);
  EXPECT_EQ(pairing.neither, 1U);
  EXPECT_EQ(pairing.doublings, (std::vector<Real>{-2}));
}

Real drawn_cost(Draws& random) {
  const Real kind = random.uniform();
  if (kind < 0.2) return kNever;
  if (kind < 0.4) return 64;  // ties
  return std::exp2(random.uniform(0, 14));
}

// Random tables with even numbers of settings, ties and failures: the ratio of a over b is that of
// b over a turned round, to the last bit.
TEST(Leads, RatiosAreTheSameFromBothSides) {
  Draws random(1, "test", "tables");
  for (int table = 0; table < 500; ++table) {
    Costs costs;
    Groups groups;
    for (std::size_t name = 0; name < 6; ++name) {
      groups.emplace_back();
      const auto settings = static_cast<std::size_t>(random.uniform(1, 5));
      for (std::size_t i = 0; i < settings; ++i) {
        groups.back().push_back(costs.size());
        costs.push_back({drawn_cost(random), drawn_cost(random)});
      }
    }
    const Pairing ab = pairing_of(costs, groups, 0, 1), ba = pairing_of(costs, groups, 1, 0);
    ASSERT_EQ(ab.doublings.size(), ba.doublings.size());
    for (std::size_t i = 0; i < ab.doublings.size(); ++i)
      EXPECT_EQ(ab.doublings[i], -ba.doublings[i]);
    EXPECT_EQ(ab.wins, ba.losses);
    EXPECT_NEAR(ab.typical() * ba.typical(), 1, 1e-12);
  }
}

// The lead's factor and its wins never point two ways: with 7 of 14 ratios on each side, of
// whatever size, the typical factor lies between the middle two.
TEST(Leads, TheTypicalFactorIsTheMiddleOfTheLogarithms) {
  Costs costs;
  for (int p = 0; p < 7; ++p) costs.push_back({100, 100 * std::exp2(0.5 + p)});
  for (int p = 0; p < 7; ++p) costs.push_back({100 * std::exp2(0.5 + p), 100});
  EXPECT_DOUBLE_EQ(pairing_of(costs, one_each(14), 0, 1).typical(), 1);
}

// 1,000 data sets of `methods` whose costs differ by chance alone, a pair by 1.7 doublings.
Real share_settled(std::size_t methods, std::size_t problems, Real doublings, Real spread) {
  constexpr std::size_t kSets = 1000;
  Draws random(2, "test", "leads");
  std::size_t settled = 0;
  for (std::size_t set = 0; set < kSets; ++set) {
    Costs costs;
    for (std::size_t p = 0; p < problems; ++p) {
      const Real hard = random.uniform(6, 10);
      auto& row = costs.emplace_back();
      for (std::size_t s = 0; s < methods; ++s)
        row.push_back(
            std::exp2(hard + spread / std::sqrt(2.0) * random.normal() + (s > 0 ? doublings : 0)));
    }
    const auto lead = lead_over(costs);
    settled += lead->is_settled && (doublings == 0 || lead->ranked[0].optimizer == 0);
  }
  return Real(settled) / Real(kSets);
}

constexpr Real kSpread = 1.7;          // doublings, of the difference of two methods in `quick`
constexpr Real kMostByChance = 0.065;  // 0.05 and two standard errors of 1,000 sets

TEST(Leads, TwoExchangeableMethodsAreSeldomSettled) {
  EXPECT_LE(share_settled(2, 17, 0, kSpread), kMostByChance);
}

TEST(Leads, TenExchangeableMethodsAreSeldomSettled) {
  EXPECT_LE(share_settled(10, 17, 0, kSpread), kMostByChance);
}

TEST(Leads, OneMethodUnderTwoNamesIsNeverSettled) {
  Draws random(3, "test", "twins");
  for (int set = 0; set < 1000; ++set) {
    Costs costs;
    for (int p = 0; p < 17; ++p) {
      const Real cost = std::exp2(random.uniform(0, 10));
      costs.push_back({cost, cost});
    }
    ASSERT_FALSE(lead_over(costs)->is_settled);
  }
}

TEST(Leads, AFactorOfFourOverTwelveProblemsIsFound) {
  EXPECT_GE(share_settled(2, 12, 2, kSpread), 0.9);
}

// Over twelve problems with that spread 80 % of all data sets show the factor that is told.
TEST(Leads, TheFactorThatDataCouldHaveShownIsShownInFourOfFive) {
  Pairing pairing;
  for (int i = 0; i < 6; ++i) {
    pairing.doublings.push_back(kSpread * std::sqrt(11 / 12.0));
    pairing.doublings.push_back(-kSpread * std::sqrt(11 / 12.0));
  }
  const Real share = share_settled(2, 12, std::log2(detectable_factor(pairing)), kSpread);
  EXPECT_NEAR(share, 0.8, 0.05);  // a standard error is 0.013; the flips are not Student's test
}

}  // namespace
}  // namespace isoline::reports
