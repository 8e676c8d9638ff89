// Verdicts on claims against figures worked out by hand, and what false claims come to.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/evidence.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// A run whose error in x is `error` throughout; its cell is named by optimizer and seed.
Record run_of(const std::string& optimizer, std::uint64_t seed, Real error) {
  Record record = record_of({.optimizer = optimizer, .seed = seed});
  record.cell = optimizer + std::to_string(seed);
  for (Real& value : record.curve.x_error) value = error;
  return record;
}

struct Asked {
  std::string kind = "ratio";
  Json published = {{"value", 10}};
  Json tolerance = {{"from", "text"}, {"relative", 0.05}};
  std::vector<std::string> optimizers = {"adam", "sip"};
  std::int64_t seeds = 3, iterations = 100;
  Json more = Json::object();  // of the quantity
};

Json claim_of(const Asked& asked) {
  Json terms = Json::array(), cells = Json::array();
  for (const std::string& optimizer : asked.optimizers) {
    terms.push_back({{"optimizer", optimizer}});
    Json digests = Json::array();
    for (std::int64_t seed = 0; seed < asked.seeds; ++seed)
      digests.push_back(optimizer + std::to_string(seed));
    cells.push_back({{{"title", "square × " + optimizer}, {"cells", digests}}});
  }
  Json quantity{{"kind", asked.kind}, {"column", "x_error"}, {"terms", terms}};
  quantity.update(asked.more);
  return {{"id", "claim"},
          {"sentence", "One is ahead of the other."},
          {"source", {{"paper", "Someone (2022)"}, {"figure", "Figure 1"}}},
          {"cells", {{{"iterations", asked.iterations}, {"seeds", "3"}, {"terms", cells}}}},
          {"quantity", quantity},
          {"published", asked.published},
          {"tolerance", asked.tolerance}};
}

// Medians 20 and 2: a ratio of 10.
std::vector<Record> adam_and_sip() {
  std::vector<Record> runs;
  for (const auto& [seed, adam, sip] :
       {std::tuple{0, 20.0, 2.0}, std::tuple{1, 10.0, 1.0}, std::tuple{2, 90.0, 3.0}}) {
    runs.push_back(run_of("adam", seed, adam));
    runs.push_back(run_of("sip", seed, sip));
  }
  return runs;
}

Judgement judgement_of(const Asked& asked, const std::vector<Record>& runs) {
  return judge(Json::array({claim_of(asked)}), runs).at(0);
}

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

TEST(Claims, ARatioIsThatOfMediansWithTheRangeOverPairedSeeds) {
  const Judgement judgement = judgement_of({}, adam_and_sip());
  EXPECT_TRUE(judgement.is_covered);
  ASSERT_TRUE(judgement.measured.has_value());
  EXPECT_EQ(judgement.measured->value, 10);
  EXPECT_EQ(judgement.measured->n, 3U);
  // Seed by seed the ratios are 20/2, 10/1 and 90/3.
  EXPECT_EQ(judgement.measured->low, 10);
  EXPECT_EQ(judgement.measured->high, 30);
}

TEST(Claims, PlantedFalseOnesAreNotReproduced) {
  const std::vector<Record> runs = adam_and_sip();
  const Asked reversed{.optimizers = {"sip", "adam"}};  // sip ten times as far as adam
  const Asked value{.kind = "value", .published = {{"value", 2}}};
  const Asked first{
      .kind = "position", .published = {{"value", 1}}, .tolerance = {{"from", "none"}}};
  for (const Asked& planted : {reversed, value, first})
    EXPECT_EQ(judgement_of(planted, runs).verdict, Verdict::not_reproduced) << planted.kind;
}

TEST(Claims, WithoutTheirCellsTellWhichAreMissing) {
  std::vector<Record> runs = adam_and_sip();
  runs.pop_back();  // sip, seed 2
  const Judgement judgement = judgement_of({}, runs);
  EXPECT_EQ(judgement.verdict, Verdict::not_comparable);
  EXPECT_EQ(judgement.why, "no runs of square × sip");
  EXPECT_FALSE(judgement.is_covered);
  EXPECT_FALSE(judgement.measured.has_value());
}

TEST(Claims, TooShortRunsAreMeasuredAndNotJudged) {
  const Judgement judgement = judgement_of({.more = {{"iteration", 5000}}}, adam_and_sip());
  EXPECT_EQ(judgement.verdict, Verdict::too_short);
  EXPECT_EQ(judgement.why, "100 of the 5000 iterations that it speaks of");
  EXPECT_EQ(judgement.measured->value, 10);
  Json at_the_end = claim_of({});
  at_the_end["length"] = {{"iterations", 101}};
  EXPECT_EQ(judge(Json::array({at_the_end}), adam_and_sip())[0].verdict, Verdict::too_short);
}

// SIP's step takes three times as long: at equal time it is read a third of the way.
TEST(Claims, AreReadAtEqualTimeWhereTheyAskForIt) {
  std::vector<Record> runs = adam_and_sip();
  for (Record& run : runs) {
    const Real price = run.cell.starts_with("sip") ? 3 : 1;
    Curve& curve = run.curve;
    curve.iteration = {0, 33, 66, 100};
    curve.x_error = {90, 9, 3, 1};
    curve.processor_seconds.clear();
    for (const std::int64_t iteration : curve.iteration)
      curve.processor_seconds.push_back(price * static_cast<Real>(iteration));
    run.summary.iterations = 100;
    run.summary.processor_seconds = 100 * price;
  }
  EXPECT_EQ(judgement_of({}, runs).measured->value, 1) << "at equal iterations";
  EXPECT_EQ(judgement_of({.more = {{"clock", "seconds"}}}, runs).measured->value, 1.0 / 9);
}

TEST(Claims, TellWhatElseWouldHaveComeToTheSameVerdict) {
  std::vector<Record> runs = adam_and_sip();
  EXPECT_TRUE(judgement_of({}, runs).survives.empty() ||
              judgement_of({}, runs).survives[0] == "networks that were never trained")
      << "the figures of the fixture do not change on the way";
  for (Record& run : runs) run.curve.x_error.front() = 50;
  EXPECT_TRUE(judgement_of({}, runs).survives.empty());
  // SIP's error is no more than 60: so is any method's, and an untrained network's.
  const Judgement loose = judgement_of({.kind = "greatest", .published = {{"at_most", 90}}}, runs);
  ASSERT_EQ(loose.verdict, Verdict::reproduced);
  EXPECT_EQ(loose.survives.size(), 2U);
}

TEST(Claims, ThatRestateOneFactCountOnceByTheWeakest) {
  Json second = claim_of({.published = {{"value", 0.5}}}), third = claim_of({});
  second["id"] = "second";
  second["fact"] = "claim";
  third["id"] = "third";
  const std::vector<Judgement> judgements =
      judge(Json::array({claim_of({}), second, third}), adam_and_sip());
  EXPECT_EQ(verdicts_on_facts(judgements),
            (std::vector{Verdict::not_reproduced, Verdict::consistent}));
}

TEST(Claims, TheLongestCompleteCellsCount) {
  Json claim = claim_of({});
  Json longer = claim["cells"][0];
  longer["iterations"] = 1000;
  longer["terms"][0][0]["cells"] = {"adam0-long"};
  longer["terms"][1][0]["cells"] = {"sip0"};
  claim["cells"].insert(claim["cells"].begin(), longer);
  std::vector<Record> runs = adam_and_sip();
  EXPECT_EQ(judge(Json::array({claim}), runs)[0].measured->n, 3U);
  runs.push_back(run_of("adam", 0, 5));
  runs.back().cell = "adam0-long";
  EXPECT_EQ(judge(Json::array({claim}), runs)[0].measured->value, 2.5);
}

TEST(Claims, WhoseSourceCannotBeComparedAreMeasuredBesideIt) {
  Json claim = claim_of({});
  claim["not_comparable"] = "their implementation";
  const Judgement judgement = judge(Json::array({claim}), adam_and_sip())[0];
  EXPECT_EQ(judgement.verdict, Verdict::not_comparable);
  EXPECT_EQ(judgement.why, "their implementation");
  EXPECT_EQ(judgement.measured->value, 10);
}

// Adam is 10 times as far as SIP: that it is 10 is true, and refuted once Adam is to be near too.
TEST(Claims, AreNoBetterThanWhatTheyAreHeldAgainst) {
  Json claim = claim_of({});
  claim["contrast"] = claim_of({.kind = "value", .published = {{"at_least", 15}}});
  claim["cells"][0]["contrast_terms"] = {claim["cells"][0]["terms"][0]};
  const auto judged = [&](const Json& published) {
    claim["contrast"]["published"] = published;
    return judge(Json::array({claim}), adam_and_sip()).at(0);
  };
  const Judgement kept = judged({{"at_least", 15}}), refuted = judged({{"at_most", 9}});
  EXPECT_EQ(kept.verdict, Verdict::consistent);  // 10 to 30, and 10 to 90
  EXPECT_EQ(kept.contrast->measured->value, 20);
  EXPECT_EQ(refuted.measured->value, 10);
  EXPECT_EQ(refuted.verdict, Verdict::not_reproduced);
  EXPECT_NE(terminal_section(claims_section({refuted})).find("Checked against the value"),
            std::string::npos);
  EXPECT_EQ(claims_json({refuted})[0].at("contrast").at("measured").at("value"), 20);
}

TEST(Claims, OfAReportAreToldInEveryFormatByTheSameFigures) {
  const Study study;
  const std::vector<Judgement> judgements = {judgement_of({}, adam_and_sip())};
  EXPECT_EQ(measured_text(judgements[0]), "10 (10–30), n = 3");
  const Section section = claims_section(judgements);
  const Document document = document_of(compare_optimizers(study), judgements);
  for (const std::string& text :
       {section_html(section), markdown_report(document), terminal_section(section)}) {
    for (const char* part :
         {"consistent on 3 seeds", "One is ahead of the other.", "10–30 (range of 3)", "±5 %"})
      EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
    EXPECT_NE(text.find("1 fact in 1 claim: 0 reproduced, 1 consistent"), std::string::npos)
        << text;
  }
  EXPECT_EQ(claims_json(judgements)[0].at("measured").at("value"), 10);
  EXPECT_TRUE(claims_section({}).is_empty());
}

}  // namespace
}  // namespace isoline::reports
