// When a measurement agrees with what was published, by bands and quantities worked out by hand.
#include <cmath>

#include "tests/reports/claim_fixture.h"

namespace isoline::reports {
namespace {

const Json kText{{"from", "text"}, {"relative", 0.05}};
const Json kFigure{{"from", "figure"}, {"relative", 0.2}};
const Json kTwo{{"from", "figure"}, {"relative", 0.2}, {"values", 2}};
const Json kNone{{"from", "none"}};

// A measured 10, from 10 to 30. Bands by hand: 18 ± 20 % of each value = 12..27; of 21.5
// = 14.3..32; of 12 = 8..18; of 14.9 = 9.93..22.35; of 20 (5 %) = 19..21.
TEST(Claims, AreReproducedWhereTheIntervalLiesInTheBandAndConsistentWhereItReachesInto) {
  using V = Verdict;
  for (const auto& [published, tolerance, verdict] :
       {std::tuple{Json{{"at_least", 10}}, kNone, V::reproduced},
        std::tuple{Json{{"at_least", 1}}, kNone, V::reproduced},
        std::tuple{Json{{"at_least", 11}}, kNone, V::consistent},
        std::tuple{Json{{"at_least", 31}}, kNone, V::partly},
        std::tuple{Json{{"at_most", 30}}, kNone, V::reproduced},
        std::tuple{Json{{"at_most", 10}}, kNone, V::consistent},
        std::tuple{Json{{"at_most", 0.5}}, kNone, V::not_reproduced},
        std::tuple{Json{{"value", 20}}, kText, V::consistent},
        std::tuple{Json{{"value", 18}}, kTwo, V::consistent},
        std::tuple{Json{{"value", 9}}, kText, V::partly},
        std::tuple{Json{{"value", 50}}, kText, V::partly},
        std::tuple{Json{{"value", 0.5}}, kTwo, V::not_reproduced}}) {
    const Judgement judgement =
        judgement_of({.published = published, .tolerance = tolerance}, adam_and_sip());
    EXPECT_EQ(judgement.verdict, verdict) << published << tolerance;
  }
}

Verdict verdict_on(const Measurement& measured, const Asked& asked, bool is_drawn = true) {
  return verdict_of(measured, claim_of(asked), is_drawn);
}
Measurement over(Real low, Real value, Real high) {
  return {.value = value, .low = low, .high = high, .n = 6};
}

// Both ways round: a ratio and its inverse, with the optimizers exchanged, come to the same.
TEST(Claims, AreJudgedTheSameFromBothSides) {
  for (const auto& [low, value, high] :
       {std::tuple{9.0, 10.0, 11.0}, std::tuple{2.0, 3.0, 4.0}, std::tuple{1.01, 1.1, 1.2},
        std::tuple{0.5, 0.7, 0.9}, std::tuple{0.9, 3.0, 20.0}, std::tuple{900.0, 1100.0, 1200.0}})
    EXPECT_EQ(verdict_on(over(low, value, high), {.published = {{"value", 10}}, .tolerance = kTwo}),
              verdict_on(over(1 / high, 1 / value, 1 / low),
                         {.published = {{"value", 0.1}}, .tolerance = kTwo}))
        << value;
}

TEST(Claims, ATieIsNoReproductionOfWhoIsAhead) {
  const Asked ahead{.published = {{"at_least", 1}}, .tolerance = kNone};
  EXPECT_EQ(verdict_on(over(1, 1, 1), ahead), Verdict::not_reproduced);
  EXPECT_EQ(verdict_on(over(1, 1.1, 1.2), ahead), Verdict::consistent);
  EXPECT_EQ(verdict_on(over(1.01, 1.1, 1.2), ahead), Verdict::reproduced);
  EXPECT_EQ(verdict_on(over(0.8, 0.9, 1.2), ahead), Verdict::not_reproduced);
  // The error of two readings of 1.35, each ±20 %, is 0.9 to 2.03.
  const Asked small{.published = {{"value", 1.35}}, .tolerance = kTwo};
  EXPECT_EQ(verdict_on(over(1, 1, 1), small), Verdict::not_reproduced);
  EXPECT_EQ(verdict_on(over(1.05, 1.2, 1.9), small), Verdict::reproduced);
}

// 7 in logarithms: a third is 1.913, three times 343.
TEST(Claims, PartlyIsFromAThirdToThreeTimesTheEffect) {
  const Asked seven{.published = {{"value", 7}}, .tolerance = kText};
  EXPECT_EQ(verdict_on(over(1.07, 1.08, 1.09), seven), Verdict::not_reproduced);
  EXPECT_EQ(verdict_on(over(1.9, 1.91, 1.95), seven), Verdict::not_reproduced);
  EXPECT_EQ(verdict_on(over(1.9, 1.92, 1.95), seven), Verdict::partly);
  EXPECT_EQ(verdict_on(over(300, 342, 345), seven), Verdict::partly);
  EXPECT_EQ(verdict_on(over(300, 344, 345), seven), Verdict::not_reproduced);
  EXPECT_EQ(verdict_on(over(0.99, 1.92, 1.95), seven), Verdict::not_reproduced) << "or a tie";
}

TEST(Claims, OneRunOfSeveralThatCouldBeDrawnIsNeverMoreThanConsistent) {
  const Measurement one{.value = 10, .low = NAN, .high = NAN, .n = 1};
  EXPECT_EQ(verdict_on(one, {}, true), Verdict::consistent);
  EXPECT_EQ(verdict_on(one, {}, false), Verdict::reproduced);
}

TEST(Quantities, AreThoseWorkedOutByHand) {
  const std::vector<Real> at = {1, 10, 100};
  EXPECT_EQ(quantity_of("greatest", {3, 5, 4}, {}), 5);
  EXPECT_EQ(quantity_of("position", {4, 5, 3}, {}), 2);
  EXPECT_EQ(quantity_of("position", {4, 4, 4}, {}), 2) << "of three equal ones none is first";
  EXPECT_EQ(quantity_of("order", {1, 2, 3}, {}), 1);
  EXPECT_NEAR(quantity_of("order", {1, 3, 2}, {}), 1.0 / 3, 1e-15);  // 2 pairs with, 1 against
  EXPECT_EQ(quantity_of("order", {3, 2, 1}, {}), -1);
  EXPECT_NEAR(quantity_of("slope", {7, 700, 70000}, at), 2, 1e-12);  // 7 at²
  // log10 of the ratio: −1 at 1, 1 at 10: it passes 0 halfway in the logarithm, at √10.
  EXPECT_NEAR(quantity_of("crossing", {1, 10, 10, 10, 1, 1}, at), std::sqrt(10.0), 1e-12);
  EXPECT_TRUE(std::isinf(quantity_of("crossing", {1, 1, 1, 2, 2, 2}, at)));
}

TEST(Quantities, ASlopeReadOffAFigureIsUncertainByItsTwoEnds) {
  // ln(1.2 / 0.8) / ln(100) = 0.0880
  Json claim = claim_of({.kind = "slope",
                         .published = {{"value", 0}},
                         .tolerance = {{"from", "figure"}, {"relative", 0.2}}});
  claim["quantity"]["terms"][0]["at"] = 1;
  claim["quantity"]["terms"][1]["at"] = 100;
  const auto verdict = [&](Real slope) {
    return verdict_of({.value = slope, .low = slope, .high = slope}, claim, true);
  };
  EXPECT_EQ(verdict(0.0880), Verdict::reproduced);
  EXPECT_EQ(verdict(-0.0880), Verdict::reproduced);
  EXPECT_EQ(verdict(0.0881), Verdict::not_reproduced);
}

TEST(Quantities, OfSeveralAlternativesTheBestCounts) {
  Term several{.figures = {{5, 6, 7}, {2, 3, 9}}};
  const Term one{.figures = {{1, 1, 1}}, .scale = 2};
  EXPECT_EQ(measure("ratio", {several, one}, "test").value, 1.5);
  several.is_worst = true;
  EXPECT_EQ(measure("ratio", {several, one}, "test").value, 3);
  EXPECT_TRUE(std::isnan(measure("value", {{.figures = {{4}}}}, "test").low)) << "one seed";
}

TEST(Quantities, AFailedRunCountsAsInfinite) {
  EXPECT_TRUE(std::isinf(measure("value", {{.figures = {{NAN, NAN, 1}}}}, "test").value));
  EXPECT_EQ(measure("value", {{.figures = {{NAN, 2, 1}}}}, "test").value, 2);
}

}  // namespace
}  // namespace isoline::reports
