// Verdicts on claims against figures worked out by hand, and what false claims come to.
#include <cmath>

#include "reports/page/page.h"
#include "reports/report.h"
#include "tests/reports/claim_fixture.h"

namespace isoline::reports {
namespace {

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
  EXPECT_NE(terminal_section(claims_section({refuted})).find("Held against the value"),
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
