// Verdicts on claims against numbers computed by hand, and on false claims.
#include "reports/sections/claims.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/results/statistics.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/asked_claim.h"
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

using Asked = AskedClaim;

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

// A claim asks for cells without a limit of time.
TEST(Claims, AreOpenWhereARunIsInapplicable) {
  std::vector<Record> runs = adam_and_sip();
  runs[0].curve = {};
  const Judgement open = judge(Json::array({claim_of({})}), runs).at(0);
  EXPECT_FALSE(is_decided(open.verdict));
  EXPECT_FALSE(open.measured);
}

TEST(Claims, TakeRunsThatNoLimitOfTimeHasEnded) {
  Json claim = claim_of({});
  std::vector<Record> runs = adam_and_sip();
  for (Record& run : runs) {
    for (Json& term : claim["cells"][0]["terms"])
      for (Json& cell : term[0]["cells"])
        if (cell == run.cell) cell = cell_digest(run.request);
    run.request.budget.seconds = 600;
    run.cell = cell_digest(run.request);
  }
  EXPECT_EQ(judge(Json::array({claim}), runs).at(0).verdict, Verdict::too_noisy);
  for (Record& run : runs) run.is_nondeterministic = true;
  EXPECT_EQ(judge(Json::array({claim}), runs).at(0).verdict, Verdict::not_comparable);
}

// A run of `length` iterations, for a claim that asks for 100.
Record published_run(const char* optimizer, int seed, Real error, Index length, Json& claim) {
  Record record = run_of(optimizer, static_cast<std::uint64_t>(seed), error);
  record.request.budget.iterations = 100;
  for (Json& term : claim["cells"][0]["terms"])
    for (Json& cell : term[0]["cells"])
      if (cell == record.cell) cell = cell_digest(record.request);
  record.request.budget.iterations = length;
  record.cell = cell_digest(record.request);
  record.status = Status::budget;
  return record;
}

// Adam and SIP over 3 seeds and 100 iterations are asked for; published are seeds 0 and 1 of SIP
// and 0 of Adam, of 40 and 60 iterations.
TEST(Claims, TakeTheBeginningsThatPublishedRecordsHave) {
  Json claim = claim_of({.more = {{"iteration", 5}}});
  std::vector<Record> published;
  for (const auto& [optimizer, seed, error, length] :
       {std::tuple{"adam", 0, 20.0, 40}, {"sip", 0, 2.0, 60}, {"sip", 1, 3.0, 60}})
    published.push_back(published_run(optimizer, seed, error, length, claim));
  const auto judged = [&](const Json& asked, const std::vector<Record>& runs = {}) {
    return judge(Json::array({asked}), runs, published).at(0);
  };
  const Judgement one = judged(claim);
  EXPECT_EQ(one.verdict, Verdict::one_run) << "its spread is unknown";
  EXPECT_EQ(one.measured->value, 10);
  EXPECT_EQ(one.measured->n, 1U);
  EXPECT_EQ(one.reached, words("claim.published-part", "40", "100", 1, 3));
  EXPECT_NE(joined(one.caveats, " ").find(published[0].build), std::string::npos);
  claim["quantity"]["iteration"] = 50;
  EXPECT_EQ(judged(claim).verdict, Verdict::too_short);
  // A whole set of other cells decides where the beginning is too short, or has fewer seeds.
  claim["cells"].push_back(claim_of({.iterations = 50}).at("cells")[0]);
  EXPECT_TRUE(judged(claim, adam_and_sip()).reached.empty());
  claim["quantity"]["iteration"] = 5;
  EXPECT_TRUE(judged(claim, adam_and_sip()).reached.empty());
  claim["cells"].erase(1);
  published[0].status = Status::crashed;
  EXPECT_EQ(judged(claim).verdict, Verdict::not_comparable);
}

// A published run of 40 iterations does not shorten those of 60 of another seed.
TEST(Claims, TakeThePublishedSeedsThatAreLongEnough) {
  Json claim = claim_of({.more = {{"iteration", 5}}});
  std::vector<Record> published;
  for (const char* optimizer : {"adam", "sip"})
    for (const int seed : {0, 1})
      published.push_back(published_run(optimizer, seed, seed + 1, seed == 0 ? 60 : 40, claim));
  const auto judged = [&] { return judge(Json::array({claim}), {}, published).at(0); };
  EXPECT_EQ(judged().measured->n, 2U);
  claim["quantity"]["iteration"] = 50;
  EXPECT_EQ(judged().measured->n, 1U);
  EXPECT_EQ(judged().reached, words("claim.published-part", "60", "100", 1, 3));
  claim["quantity"]["iteration"] = 90;
  EXPECT_EQ(judged().verdict, Verdict::too_short);
  EXPECT_EQ(judged().reached, words("claim.published-part", "60", "100", 1, 3)) << "the longest";
}

const Json kText{{"from", "text"}, {"relative", 0.05}};
const Json kFigure{{"from", "figure"}, {"relative", 0.2}};
const Json kTwo{{"from", "figure"}, {"relative", 0.2}, {"values", 2}};
const Json kNone{{"from", "none"}};

// A measurement of these values, one a seed.
Measurement of(const std::vector<Real>& each) {
  return {.value = median_of(each), .low = NAN, .high = NAN, .n = each.size(), .each = each};
}
Verdict verdict_on(const std::vector<Real>& each, const Asked& asked, bool is_drawn = true) {
  return verdict_of(of(each), claim_of(asked), is_drawn);
}

// Values whose logarithms are `middle` ± `spread` in turn: n of them, n even. Then s is
// spread √(n/(n − 1)).
std::vector<Real> around(Real middle, Real spread, std::size_t n) {
  std::vector<Real> each;
  for (std::size_t i = 0; i < n; ++i)
    each.push_back(std::exp(middle + (i % 2 == 0 ? spread : -spread)));
  return each;
}

// By hand, n = 6: t(5) = 2.5706; s = 0.1 √1.2 = 0.10954; e = 2.5706 · 0.10954 · √(7/6) = 0.30415; w
// = ln 1.1 = 0.09531; √(e² + w²) = 0.31874. With a spread of 0.25, e = 0.7604 > ln 2.
TEST(Claims, DifferAreTooNoisyOrAgreeByOneRule) {
  const Asked ten{.kind = "value", .published = {{"value", 10}}, .tolerance = kNone};
  const Real middle = std::log(10.0);
  EXPECT_EQ(verdict_on(around(middle + 0.3186, 0.1, 6), ten), Verdict::reproduced);
  EXPECT_EQ(verdict_on(around(middle + 0.3189, 0.1, 6), ten), Verdict::differs);
  EXPECT_EQ(verdict_on(around(middle - 0.3189, 0.1, 6), ten), Verdict::differs);
  EXPECT_EQ(verdict_on(around(middle, 0.25, 6), ten), Verdict::too_noisy);
  EXPECT_EQ(verdict_on(around(middle + 0.9, 0.25, 6), ten), Verdict::differs)
      << "noise excuses nothing";
  EXPECT_EQ(verdict_on(around(middle, 0.01, 4), ten), Verdict::agrees) << "fewer than six runs";
  EXPECT_EQ(verdict_on({10}, ten), Verdict::one_run);
  EXPECT_EQ(verdict_on({10}, ten, false), Verdict::reproduced) << "no seed varies it";
  EXPECT_EQ(verdict_on({10.99}, ten, false), Verdict::reproduced) << "at least ten percent";
  EXPECT_EQ(verdict_on({11.02}, ten, false), Verdict::differs);
  // Two readings of a figure, ± 20 % each: ln(1.2/0.8) = 0.405.
  EXPECT_EQ(verdict_on({14.9}, {.published = {{"value", 10}}, .tolerance = kTwo}, false),
            Verdict::reproduced);
  EXPECT_EQ(verdict_on({15.1}, {.published = {{"value", 10}}, .tolerance = kTwo}, false),
            Verdict::differs);
  // Printed digits are exact.
  const Asked digits{.kind = "value",
                     .published = {{"value", 10}},
                     .tolerance = {{"from", "digits"}, {"absolute", 0.5}}};
  EXPECT_EQ(verdict_on({10.5}, digits, false), Verdict::reproduced);
  EXPECT_EQ(verdict_on({10.6}, digits, false), Verdict::differs);
}

// Both ways round: a ratio and its inverse, with the optimizers exchanged, come to the same.
TEST(Claims, AreJudgedTheSameFromBothSides) {
  for (const Real middle : {2.3, 2.0, 1.5, 0.1, -0.3})
    for (const Real spread : {0.05, 0.3}) {
      std::vector<Real> inverse = around(middle, spread, 6);
      for (Real& value : inverse) value = 1 / value;
      EXPECT_EQ(
          verdict_on(around(middle, spread, 6), {.published = {{"value", 10}}, .tolerance = kTwo}),
          verdict_on(inverse, {.published = {{"value", 0.1}}, .tolerance = kTwo}))
          << middle;
    }
}

// n = 6: t(5) one-sided 2.0150; half = 2.0150 · 0.10954/√6 = 0.09011.
TEST(Claims, AboutAThresholdAreJudgedByAOneSidedInterval) {
  const Asked ahead{.published = {{"at_least", 1}}, .tolerance = kNone},
      behind{.published = {{"at_most", 1}}, .tolerance = kNone};
  for (const auto& [middle, verdict] : {std::pair{0.0902, Verdict::reproduced},
                                        {0.0900, Verdict::too_noisy},
                                        {-0.0900, Verdict::too_noisy},
                                        {-0.0902, Verdict::differs}}) {
    EXPECT_EQ(verdict_on(around(middle, 0.1, 6), ahead), verdict) << middle;
    EXPECT_EQ(verdict_on(around(-middle, 0.1, 6), behind), verdict) << middle;
  }
  EXPECT_EQ(verdict_on({1}, ahead, false), Verdict::differs) << "a tie is no lead";
  // A run that diverged has no logarithm: then seeds are counted, 6 of 6 but not 5.
  EXPECT_EQ(verdict_on({2, 2, 2, 2, 2, kNever}, ahead), Verdict::reproduced);
  EXPECT_EQ(verdict_on({2, 2, 2, 2, 0.5, kNever}, ahead), Verdict::too_noisy);
}

TEST(Claims, AboutAnOrderAreJudgedByTheShareOfSeeds) {
  const Asked first{.kind = "position", .published = {{"value", 1}}, .tolerance = kNone};
  EXPECT_EQ(verdict_on({1, 1, 1, 1, 1, 1}, first), Verdict::reproduced);
  EXPECT_EQ(verdict_on({1, 1, 1, 1, 1}, first), Verdict::agrees);  // 1/32
  EXPECT_EQ(verdict_on({1, 1, 1, 1}, first), Verdict::too_noisy);  // 1/16
  EXPECT_EQ(verdict_on({1, 1, 1, 1, 1, 2}, first), Verdict::too_noisy);
  EXPECT_EQ(verdict_on({2, 2, 2, 2, 2, 2}, first), Verdict::differs);
}

TEST(Claims, StateTheDirectionApart) {
  const auto direction = direction_of(of({1.1, 2, 3, 1.2, 1.3, 4}), claim_of({}));
  ASSERT_TRUE(direction.has_value());
  EXPECT_EQ(direction->with, 6U);
  EXPECT_NEAR(direction->p, 1.0 / 32, 1e-12);  // rounding
  EXPECT_EQ(direction_of(of({2, 2, 2, 2, 2, 0.5}), claim_of({}))->with, 5U);
  EXPECT_FALSE(direction_of(of({1, 2}), claim_of({.kind = "value"})).has_value());
}

// One run of 100 iterations, six of 50: e = 2.5706 · 0.10954 · √2 = 0.39822.
TEST(Claims, OfOneLongRunTakeTheirSpreadFromShorterOnes) {
  Json claim = claim_of({.kind = "value",
                         .published = {{"value", 10}},
                         .tolerance = kNone,
                         .optimizers = {"adam"},
                         .seeds = 1});
  claim["cells"].push_back(
      claim_of({.optimizers = {"short"}, .seeds = 6, .iterations = 50})["cells"][0]);
  std::vector<Record> runs;
  const std::vector<Real> each = around(0, 0.1, 6);
  for (std::uint64_t seed = 0; seed < 6; ++seed) runs.push_back(run_of("short", seed, each[seed]));
  const auto judged = [&](Real value) {
    std::vector<Record> all = runs;
    all.push_back(run_of("adam", 0, value));
    return judge(Json::array({claim}), all).at(0);
  };
  EXPECT_EQ(judged(10 * std::exp(0.40)).verdict, Verdict::agrees);  // √(e² + w²) = 0.4095
  EXPECT_EQ(judged(10 * std::exp(0.42)).verdict, Verdict::differs);
  EXPECT_EQ(judged(10).measured->shorter_runs, 6U);
  runs.pop_back();
  EXPECT_EQ(judged(10).verdict, Verdict::one_run);
}

TEST(Claims, OfLessThanATenthOfThePublishedLengthAreNotDecided) {
  const std::vector<Record> runs = adam_and_sip();
  for (const auto& [published, is_short] : {std::pair{1000, false}, {1001, true}}) {
    Json claim = claim_of({});
    claim["length"] = {{"published", published}};
    EXPECT_EQ(judge(Json::array({claim}), runs).at(0).verdict == Verdict::too_short, is_short);
  }
  Json claim = claim_of({});
  claim["length"] = {{"published_seconds", 3600}};
  EXPECT_EQ(judge(Json::array({claim}), runs).at(0).verdict, Verdict::too_short);
  claim.erase("length");
  claim["cells"][0]["stands_in"] = "another batch";
  EXPECT_EQ(judge(Json::array({claim}), runs).at(0).verdict, Verdict::too_short);
}

// By hand: logarithms −1, 0, 1, mean 0, variance 1; t(2) = 4.30265273; exp(± t √(4/3)).
TEST(Claims, PredictWhereOneFurtherRunOfOursWouldLie) {
  const Real e = std::exp(1.0);
  const Measurement three = measure("value", {{.figures = {{1 / e, 1, e}}}}, "test");
  ASSERT_TRUE(three.predicted.has_value());
  const Real factor = std::exp(4.30265273 * std::sqrt(4 / 3.0));
  EXPECT_NEAR(three.predicted->low, 1 / factor, 1e-8);
  EXPECT_NEAR(three.predicted->high, factor, 1e-4);
  EXPECT_FALSE(measure("value", {{.figures = {{-1, 1, 2}}}}, "test").predicted.has_value());
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
  // Of the ratios of two halves.
  EXPECT_NEAR(quantity_of("ratio_slope", {1, 10, 100, 1, 1, 1}, at), 1, 1e-12);  // rounding
  EXPECT_NEAR(quantity_of("ratio_slope", {1, 10, 100, 1, 10, 100}, at), 0, 1e-12);
  EXPECT_EQ(quantity_of("trend", {2, 3, 4, 1, 1, 1}, at), 1);
  EXPECT_EQ(quantity_of("trend", {2, 4, 3, 1, 1, 1}, at), 1.0 / 3);
  EXPECT_EQ(quantity_of("trend", {5, 5, 5, 5, 5, 5}, at), 0);
}

TEST(Quantities, ASlopeReadOffAFigureIsUncertainByItsTwoEnds) {
  // ln(1.2 / 0.8) / ln(100) = 0.0880
  Json claim = claim_of({.kind = "slope",
                         .published = {{"value", 0}},
                         .tolerance = {{"from", "figure"}, {"relative", 0.2}}});
  claim["quantity"]["terms"][0]["at"] = 1;
  claim["quantity"]["terms"][1]["at"] = 100;
  const auto verdict = [&](Real slope) {
    return verdict_of(of(std::vector<Real>(6, slope)), claim, true);
  };
  EXPECT_EQ(verdict(0.0880), Verdict::reproduced);
  EXPECT_EQ(verdict(-0.0880), Verdict::reproduced);
  EXPECT_EQ(verdict(0.0881), Verdict::differs);
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
    EXPECT_FALSE(is_supported(judgement_of(planted, runs).verdict)) << planted.kind;
}

TEST(Claims, WithoutTheirCellsTellWhichAreMissing) {
  std::vector<Record> runs = adam_and_sip();
  runs.pop_back();  // sip, seed 2
  const Judgement judgement = judgement_of({}, runs);
  EXPECT_EQ(judgement.verdict, Verdict::not_comparable);
  EXPECT_TRUE(judgement.why.ends_with("square × sip"));
  EXPECT_FALSE(judgement.is_covered);
  EXPECT_FALSE(judgement.measured.has_value());
}

TEST(Claims, TooShortRunsAreMeasuredAndNotJudged) {
  const Judgement judgement = judgement_of({.more = {{"iteration", 5000}}}, adam_and_sip());
  EXPECT_EQ(judgement.verdict, Verdict::too_short);
  EXPECT_TRUE(judgement.why.starts_with("100 of the 5000 "));
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
    curve.work = curve.iteration;
    run.summary.work = 100;
  }
  EXPECT_EQ(judgement_of({}, runs).measured->value, 1) << "at equal iterations";
  const Asked at_equal_time{
      .published = {{"at_most", 1}}, .tolerance = kNone, .more = {{"clock", "seconds"}}};
  EXPECT_EQ(judgement_of(at_equal_time, runs).measured->value, 1.0 / 9);
  // Beside it by counted work, which no machine changes: a step of either has as much of it.
  const Judgement both = judgement_of(at_equal_time, runs);
  ASSERT_EQ(both.others.size(), 1U);
  EXPECT_EQ(both.others[0].measured.value, 1);
  EXPECT_EQ(both.others[0].verdict, Verdict::differs);
  EXPECT_EQ(both.verdict, Verdict::partly) << "for it by the one, against it by the other";
  for (Record& run : runs)  // SIP a third as dear again
    if (run.cell.starts_with("sip"))
      for (Real& second : run.curve.processor_seconds) second *= 1.3;
  EXPECT_EQ(judgement_of(at_equal_time, runs).verdict, both.verdict);
}

// Adam has the error of SIP's end after 66 of its steps, while SIP makes 100; or never.
TEST(Claims, ByTheClockStateTheirBreakEvenAlsoByPublishedRecords) {
  std::vector<Record> runs = adam_and_sip(), published;
  const auto shape = [](Record& run) {
    const bool is_sip = run.request.optimizer.name == "sip";
    run.curve.iteration = run.curve.work = {0, 33, 66, 100};
    run.curve.x_error = is_sip ? std::vector<Real>{90, 30, 9, 3} : std::vector<Real>{90, 9, 3, 1};
    run.curve.processor_seconds = {0, 33, 66, 100};
    run.summary.iterations = run.summary.work = 100;
  };
  for (Record& run : runs) shape(run);
  const Asked by_time{
      .published = {{"at_most", 1}}, .tolerance = kNone, .more = {{"clock", "seconds"}}};
  EXPECT_EQ(judgement_of({}, runs).break_even, "");
  const std::string at_66 = words("claim.break-even", "sip", "adam", "0.66 × ");
  EXPECT_EQ(judgement_of(by_time, runs).break_even, at_66);
  const std::vector<Judgement> judgements = {judgement_of(by_time, runs)};
  EXPECT_TRUE(has(papers_section(judgements).tables.at(0).rows.at(0).back().text, at_66));
  Json claim = claim_of(by_time);
  for (const char* optimizer : {"adam", "sip"}) {
    published.push_back(published_run(optimizer, 0, 1, 100, claim));
    shape(published.back());
  }
  EXPECT_EQ(judge(Json::array({claim}), {}, published).at(0).break_even, at_66);
  for (Record& run : runs)
    if (run.cell.starts_with("sip")) run.curve.x_error.back() = 0.5;
  EXPECT_EQ(judgement_of(by_time, runs).break_even,
            words("claim.break-even-at-least", "sip", "adam", ""));
}

TEST(Claims, ThatWereReadInTwoWaysAreTheWeakerOrPartly) {
  using V = Verdict;
  EXPECT_EQ(joint_verdict(V::agrees, V::reproduced), V::agrees);
  EXPECT_EQ(joint_verdict(V::partly, V::differs), V::differs);
  EXPECT_EQ(joint_verdict(V::differs, V::reproduced), V::partly);
  EXPECT_EQ(joint_verdict(V::too_noisy, V::reproduced), V::too_noisy);
}

// 100 iterations are our guess: SIP is also read at the 33rd, where its error is three times 3.
TEST(Claims, OfAGuessedLengthAreReadAtAThirdOfSipsIterationsToo) {
  std::vector<Record> runs = adam_and_sip();
  for (Record& run : runs) {
    run.curve.iteration = {0, 33, 66, 100};
    run.curve.x_error = {90, 9, 3, 1};
    if (run.cell.starts_with("sip")) run.request.optimizer.name = "sip";
  }
  Json claim = claim_of({.kind = "value", .published = {{"value", 1}}, .optimizers = {"sip"}});
  EXPECT_TRUE(judge(Json::array({claim}), runs)[0].others.empty());
  claim["length"] = {{"iterations", 100}, {"guessed", true}};
  const Judgement judgement = judge(Json::array({claim}), runs)[0];
  ASSERT_EQ(judgement.others.size(), 1U);
  EXPECT_EQ(judgement.others[0].measured.value, 9);
  EXPECT_EQ(judgement.verdict, Verdict::partly);
  EXPECT_EQ(judgement.alone, Verdict::agrees);
  // Where the other reading made the verdict, the row of the papers' page says what it is without.
  claim["published"]["value"] = 9;
  const std::vector<Judgement> by_the_other = judge(Json::array({claim}), runs);
  EXPECT_EQ(by_the_other[0].verdict, Verdict::partly);
  ASSERT_EQ(by_the_other[0].alone, Verdict::differs);
  const std::string row = papers_section(by_the_other).tables.at(0).rows.at(0).back().text;
  EXPECT_NE(row.find(name_of(Verdict::differs)), std::string::npos) << row;
  EXPECT_NE(row.find("iterations: 9, " + std::string(name_of(Verdict::agrees))), row.npos) << row;
}

TEST(Claims, OfWhoIsTheQuickestReadWhatWasSpentUntilALevel) {
  Record run = run_of("adam", 0, 1);
  run.curve.iteration = {0, 10, 20, 30};
  run.curve.work = {0, 15, 25, 35};
  run.curve.processor_seconds = {0, 1, 2, 3};
  run.curve.x_error = {9, 5, 2, 1};
  const std::string until = "until: x_error 2.5";
  EXPECT_EQ(figure_of(run, {.column = until}), 20);
  EXPECT_EQ(figure_of(run, {.column = until, .seconds = 2.5}), 2);
  EXPECT_EQ(figure_of(run, {.column = until, .work = 30}), 25);
  EXPECT_EQ(figure_of(run, {.column = "work " + until}), 25);
  EXPECT_TRUE(std::isinf(figure_of(run, {.column = until, .seconds = 1.5}))) << "not by then";
  EXPECT_TRUE(std::isinf(figure_of(run, {.column = "until: x_error 0.5"})));
}

TEST(Claims, TellWhatElseWouldHaveComeToTheSameVerdict) {
  std::vector<Record> runs = adam_and_sip();
  EXPECT_TRUE(judgement_of({}, runs).survives.empty() ||
              judgement_of({}, runs).survives[0] == "untrained networks")
      << "the figures of the fixture do not change on the way";
  for (Record& run : runs) run.curve.x_error.front() = 50;
  EXPECT_TRUE(judgement_of({}, runs).survives.empty());
  // SIP's error is no more than 60: so is any method's, and an untrained network's.
  const Judgement loose = judgement_of({.kind = "greatest", .published = {{"at_most", 1e4}}}, runs);
  ASSERT_EQ(loose.verdict, Verdict::agrees);
  EXPECT_EQ(loose.survives.size(), 2U);
}

TEST(Claims, ThatRestateOneFactCountOnceByTheWeakest) {
  Json second = claim_of({.published = {{"value", 0.5}}}), third = claim_of({});
  second["id"] = "second";
  second["fact"] = "claim";
  third["id"] = "third";
  const std::vector<Judgement> judgements =
      judge(Json::array({claim_of({}), second, third}), adam_and_sip());
  EXPECT_EQ(verdicts_on_facts(judgements, false),
            (std::vector{Verdict::differs, Verdict::too_noisy}));
}

// No seed varies the runs: what holds to the digit is no reproduction of an experiment.
TEST(Claims, OfIdentitiesAreCountedApartAsVerification) {
  Json identity = claim_of({.seeds = 1});
  identity["id"] = "identity";
  identity["cells"][0].erase("seeds");
  const std::vector<Judgement> judgements =
      judge(Json::array({claim_of({}), identity}), adam_and_sip());
  EXPECT_FALSE(judgements[0].is_verification);
  EXPECT_TRUE(judgements[1].is_verification);
  EXPECT_EQ(verdicts_on_facts(judgements, false), std::vector{Verdict::too_noisy});
  EXPECT_EQ(verdicts_on_facts(judgements, true), std::vector{Verdict::reproduced});
  EXPECT_EQ(verdict_text(judgements[1]), "verified");
  const std::string text = claims_reading(judgements);
  EXPECT_FALSE(has(text, "reproduced")) << text;
  EXPECT_TRUE(has(text, "1 of 1 identities")) << text;
}

TEST(Claims, WhoseSourceTellsTooLittleOrCannotBeComparedAreMeasuredAllTheSame) {
  for (const auto& [key, verdict] : {std::pair{"undecidable", Verdict::undecidable},
                                     std::pair{"not_comparable", Verdict::not_comparable}}) {
    Json claim = claim_of({});
    claim[key] = "settings unpublished";
    for (const auto& runs : {adam_and_sip(), std::vector<Record>()}) {
      const Judgement judgement = judge(Json::array({claim}), runs)[0];
      EXPECT_EQ(judgement.verdict, verdict);
      EXPECT_EQ(judgement.why, "settings unpublished");
      EXPECT_FALSE(is_decided(judgement.verdict));
      EXPECT_EQ(judgement.measured ? judgement.measured->value : 0, runs.empty() ? 0 : 10);
    }
  }
}

TEST(Claims, ReadOffAFigureSaySo) {
  EXPECT_TRUE(judgement_of({}, adam_and_sip()).reading.empty());
  const Judgement judgement = judgement_of({.tolerance = kFigure}, adam_and_sip());
  EXPECT_TRUE(has(judgement.reading, "Figure 1"));
  const std::vector<Reading> notes = claim_notes(judgement);
  EXPECT_TRUE(std::ranges::any_of(
      notes, [&](const Reading& note) { return note.text == judgement.reading; }));
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

// Adam is 10 times as far as SIP: that it is 10 is true, and refuted once Adam is to be near too.
TEST(Claims, AreNoBetterThanWhatTheyAreHeldAgainst) {
  Json claim = claim_of({});
  const Json contrast = claim_of({.kind = "value", .published = {{"at_least", 15}}});
  claim["contrasts"] = {contrast, contrast};
  claim["cells"][0]["contrast_terms"] = {Json{claim["cells"][0]["terms"][0]},
                                         Json{claim["cells"][0]["terms"][0]}};
  const auto judged = [&](std::size_t which, const Json& published) {
    Json one = claim;
    one["contrasts"][which]["published"] = published;
    return judge(Json::array({one}), adam_and_sip()).at(0);
  };
  const Judgement kept = judged(0, {{"at_least", 15}});
  EXPECT_EQ(kept.verdict, Verdict::too_noisy);  // 10 to 30, and 10 to 90
  EXPECT_EQ(kept.contrasts.at(0).measured->value, 20);
  for (const std::size_t which : {0, 1}) {
    const Judgement refuted = judged(which, {{"at_most", 9}});
    EXPECT_EQ(refuted.measured->value, 10);
    EXPECT_FALSE(is_supported(refuted.verdict));
    EXPECT_NE(terminal_section(claims_section({refuted})).find("with the value"),
              std::string::npos);
    EXPECT_EQ(claims_json({refuted})[0].at("contrasts").at(1).at("measured").at("value"), 20);
  }
}

TEST(Claims, OfAReportAreToldInEveryFormatByTheSameFigures) {
  const std::vector<Judgement> judgements = {judgement_of({}, adam_and_sip())};
  EXPECT_EQ(measured_text(judgements[0]), "10, mean 14.42 (10–30), n = 3");
  const Section section = claims_section(judgements);
  const Document document = document_of(compare_optimizers(Study()), judgements);
  for (const std::string& text :
       {section_html(section), markdown_report(document), terminal_section(section)}) {
    for (const char* part :
         {"too noisy, n = 3", "One is ahead of the other.", "10–30 (range of 3)", "±5 %"})
      EXPECT_TRUE(has(text, part)) << part << " in " << text;
    EXPECT_TRUE(has(text, "1 fact in 1 claim: 1 too noisy")) << text;
  }
  EXPECT_EQ(claims_json(judgements)[0].at("measured").at("value"), 10);
  EXPECT_TRUE(claims_section({}).is_empty());
}

TEST(Claims, OfEachVerdictStandInTheSummaryFromTheRefutedToTheUndecided) {
  std::vector<Judgement> judgements(kVerdictNames.size(), judgement_of({}, adam_and_sip()));
  for (std::size_t i = 0; i < judgements.size(); ++i) {
    judgements[i].verdict = static_cast<Verdict>(i);
    judgements[i].id = kVerdictNames[i];
  }
  const Section section = claims_summary(judgements);
  const auto& rows = section.tables.at(0).rows;
  ASSERT_EQ(rows.size(), judgements.size());
  EXPECT_EQ(rows.front().at(0).text, name_of(Verdict::differs));
  EXPECT_EQ(rows.back().at(0).text, name_of(Verdict::not_comparable));
}

// Two steps from (3, 4): to (3, 1), then to (1.5, −0.5). y is x, but for its last point.
Record two_steps() {
  Record record;
  record.curve.iteration = {0, 1, 2};
  record.curve.loss = {10, 7, 6};
  record.curve.x_error = {5, 3, 1};
  record.curve.step_norm = {0, 3, 2};
  record.trajectory = Trajectory{.x = {{3, 4}, {3, 1}, {1.5, -0.5}}, .y = {{3, 4}, {3, 1}, {3, 4}}};
  return record;
}

Real path_figure(const std::string& column, std::optional<std::int64_t> iteration = {},
                 std::vector<std::vector<Real>> table = {}) {
  return figure_of(two_steps(),
                   {.column = column, .iteration = iteration, .seconds = {}, .table = table});
}

TEST(RunFigures, OfStepsAreThoseThatLedToTheIteration) {
  EXPECT_EQ(path_figure("step_norm", 1), 3);
  EXPECT_EQ(path_figure("step_2", 1), 3);
  EXPECT_EQ(path_figure("step_2", 2), 1.5);
  EXPECT_EQ(path_figure("relative_step_2", 1), 0.75);
  EXPECT_EQ(path_figure("loss_drop", 1), 3);
}

TEST(RunFigures, OfPathsGoUpToTheIteration) {
  EXPECT_EQ(path_figure("least_coordinate"), -0.5);
  EXPECT_EQ(path_figure("least_coordinate", 1), 1);
  EXPECT_EQ(path_figure("bend", 1), 0.75);
  EXPECT_EQ(path_figure("deviation", {}, {{3, 2}, {1, 0}}), 1);
  EXPECT_EQ(path_figure("mean_deviation", {}, {{3, 2}, {1, 0}}), 0.5);
  // From (3, 4) to (3, 1): straight down, and the way to the origin has a cosine of 4/5 with it.
  EXPECT_NEAR(path_figure("turn", 1), std::acos(0.8) * 180 / 3.14159265358979, 1e-9);  // rounding
}

// What claims must not be decided by: a run that made no step has none of these, and stays put.
TEST(RunFigures, OfWhatMadeNoStepAreAbsentOrThoseOfTheStart) {
  for (const char* column : {"step_2", "relative_step_2", "turn", "alignment", "slowdown"})
    EXPECT_TRUE(std::isnan(path_figure(column, 0))) << column;
  EXPECT_EQ(path_figure("bend", 0), 0);
  EXPECT_EQ(path_figure("loss_drop", 0), 0);
  EXPECT_EQ(path_figure("deviation", 0, {{3, 2}, {1, 0}}), 4);
}

// The error in x at every one of 90 iterations.
Record curve_with(Real (*error)(Real iteration)) {
  Record record;
  for (std::int64_t i = 0; i <= 90; ++i) {
    record.curve.iteration.push_back(i);
    record.curve.loss.push_back(1);
    record.curve.x_error.push_back(error(static_cast<Real>(i)));
  }
  return record;
}

Real slowdown_of(Real (*error)(Real iteration)) {
  return figure_of(curve_with(error),
                   {.column = "slowdown", .iteration = 90, .seconds = {}, .table = {}});
}

TEST(RunFigures, AnExponentialDoesNotSlowDownAndAHyperbolaDoes) {
  EXPECT_NEAR(slowdown_of([](Real i) { return std::exp(-i / 10); }), 1, 1e-9);  // rounding
  // Sums of ln(1 + i) by factorials: of the mean over 15 iterations from `first`, half weights at
  // ends.
  const auto mean = [](Real first) {
    const auto sum = [&](Real shift) {
      return std::lgamma(first + 15 + shift) - std::lgamma(first + shift);
    };
    return (sum(1) + sum(2)) / 30;
  };
  EXPECT_NEAR(slowdown_of([](Real i) { return 1 / (1 + i); }),
              (mean(15) - mean(0)) / (mean(75) - mean(60)), 1e-9);
  EXPECT_EQ(slowdown_of([](Real i) { return i < 40 ? 50 - i : 10; }), kNever);
  EXPECT_TRUE(std::isnan(slowdown_of([](Real) { return 1.0; })));
}

TEST(RunFigures, RisesAreTheShareOfStepsThatRaiseTheLoss) {
  Record record = curve_with([](Real) { return 1.0; });
  record.curve.loss[3] = 2;
  record.curve.loss[7] = 0.5;
  const Place place{.column = "rises", .iteration = 10, .seconds = {}, .table = {}};
  EXPECT_EQ(figure_of(record, place), 0.2);
  EXPECT_TRUE(std::isnan(figure_of(record, {.column = "rises", .iteration = 0})));
}

TEST(Quantities, AShareCountsSeedsOfTheAlternativeThatSpeaksForTheMethod) {
  const Term term{.figures = {{0, 1, 7, 0}, {7, 7, 7, 0}}, .at = 1};
  EXPECT_EQ(measure("share", {term}, "test").value, 0.5);
  Term worst = term;
  worst.is_worst = true;
  EXPECT_EQ(measure("share", {worst}, "test").value, 0.75);
}

TEST(Quantities, DigitsOfTheLossAreThoseOfTheLastTargetReached) {
  Record record = record_of({});
  record.hits.reset();
  EXPECT_TRUE(std::isnan(figure_of(record, {.column = "loss_digits"})));
  record.hits = Hits{.target = {0.1, 1e-3, 1e-5}, .iteration = {4, 7, -1}};
  EXPECT_NEAR(figure_of(record, {.column = "loss_digits"}), 3, 1e-12);  // rounding
  Record trimmed = record;
  trim_for_report(trimmed, true);
  EXPECT_EQ(figure_of(trimmed, {.column = "loss_digits"}),
            figure_of(record, {.column = "loss_digits"}))
      << "a report judges a claim as `isoline claims` does";
  record.hits->iteration = {-1, -1, -1};
  EXPECT_EQ(figure_of(record, {.column = "loss_digits"}), 0);
}

// Of the pairs of a run's digits and another's, 1e-2 … 1e-13 of x_scale 10 and not finite.
TEST(Quantities, DigitsAreThoseOfTheErrorInXAndTheirMeansAreCompared) {
  Record record = record_of({});
  record.x_scale = 10;
  const auto digits = [&](Real error) {
    record.curve.x_error.assign(record.curve.iteration.size(), error);
    return figure_of(record, {.column = "digits"});
  };
  EXPECT_NEAR(digits(1e-3), 4, 1e-12);  // rounding
  EXPECT_EQ(digits(1e-13), 11);
  EXPECT_EQ(digits(0), 11);
  EXPECT_EQ(digits(1e3), 0);
  EXPECT_EQ(digits(std::nan("")), 0);
  EXPECT_EQ(
      measure("mean_difference", {{.figures = {{9, 4}}}, {.figures = {{5, 2}}}}, "test").value, 3);
}

TEST(Quantities, SignedOnesAreTiedAtZeroAndRatiosAtOne) {
  for (const char* kind : {"slope", "ratio_slope", "order", "trend", "mean_difference"})
    EXPECT_EQ(neutral_of(kind), 0) << kind;
  EXPECT_EQ(neutral_of("ratio"), 1);
  for (const char* kind : {"value", "greatest", "share"})
    EXPECT_FALSE(neutral_of(kind).has_value()) << kind;
}

}  // namespace
}  // namespace isoline::reports
