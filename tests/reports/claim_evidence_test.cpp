// The evidence shown for a claim is the data of its verdict, in every format.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/asked_claim.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

const Study kNoRuns;

constexpr std::int64_t kEnd = 50;  // iterations of the fixture's runs

// Its error in x falls from 2 at iteration 0 to `end` at the last, in a straight line.
Record run_to(const std::string& optimizer, std::uint64_t seed, Real end) {
  Record record = record_of({.optimizer = optimizer, .seed = seed});
  record.cell = optimizer + std::to_string(seed);
  for (std::size_t i = 0; i < record.curve.x_error.size(); ++i)
    record.curve.x_error[i] = 2 + (end - 2) * Real(record.curve.iteration[i]) / Real(kEnd);
  return record;
}

std::vector<Record> falling_runs(Real adam = 0.2) {
  std::vector<Record> runs;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    runs.push_back(run_to("adam", seed, adam + 0.01 * Real(seed)));
    runs.push_back(run_to("sip", seed, 0.1 + 0.01 * Real(seed)));
  }
  return runs;
}

// Adam ends twice as far as SIP; of several, by the optimizers given.
Json twice(const std::string& kind = "ratio",
           const std::vector<std::string>& optimizers = {"adam", "sip"}) {
  Json claim = claim_of(
      {.kind = kind, .published = {{"value", 2}}, .optimizers = optimizers, .iterations = kEnd});
  claim["id"] = "twice";
  claim["sentence"] = "Adam ends twice as far.";
  return claim;
}

Judgement judged(const Json& claim, const std::vector<Record>& runs) {
  return judge(Json::array({claim}), runs).at(0);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(Evidence, OfAClaimIsWhatItsFigureIsMadeOf) {
  const Judgement judgement = judged(twice(), falling_runs());
  const auto& terms = judgement.evidence.terms;
  ASSERT_EQ(terms.size(), 2U);
  EXPECT_NEAR(terms[0].level, 0.21, 1e-15);  // rounding of the fixture's line
  EXPECT_EQ(judgement.measured->value, terms[0].level / terms[1].level);
  ASSERT_EQ(terms[1].runs.size(), 3U);
  EXPECT_EQ(terms[1].runs[2].cell, "sip2");
  EXPECT_EQ(terms[1].runs[2].seed, 2U);
  EXPECT_NEAR(terms[1].runs[2].figure, 0.12, 1e-15);
  EXPECT_EQ(terms[1].runs[2].file, "sip2-b0.json");
}

TEST(Evidence, CurvesPassThroughTheFiguresThatAreRead) {
  Json claim = twice();
  for (const bool is_early : {false, true}) {
    if (is_early) claim["quantity"]["iteration"] = 10;
    const EvidenceTerm term = judged(claim, falling_runs()).evidence.terms.at(0);
    const auto at = std::ranges::find(term.x, term.read_at);
    ASSERT_NE(at, term.x.end());
    EXPECT_EQ(term.read_at, is_early ? 10 : kEnd);
    const auto i = std::size_t(at - term.x.begin());
    EXPECT_EQ(term.y[i], term.level);
    EXPECT_EQ(term.low[i], term.runs[0].figure);
    EXPECT_EQ(term.high[i], term.runs[2].figure);
  }
}

TEST(Evidence, OfSeveralAlternativesIsThatOfTheOneThatCounts) {
  Json claim = twice();
  claim["quantity"]["terms"][1]["optimizer"] = {"adam", "sip"};
  claim["cells"][0]["terms"][1] = {asked_cells("adam")[0], asked_cells("sip")[0]};
  EXPECT_EQ(judged(claim, falling_runs()).evidence.terms.at(1).optimizer, "sip");
  claim["quantity"]["terms"][1]["of"] = "worst";
  EXPECT_EQ(judged(claim, falling_runs()).evidence.terms.at(1).optimizer, "adam");
}

// 2 ± 5 % of the second's 0.11: the bar follows the data, and the line of the first meets it or
// not.
TEST(Evidence, ARatioIsDrawnWhereTheFirstLineShouldBe) {
  for (const Real adam : {0.21, 0.9}) {
    const Judgement judgement = judged(twice(), falling_runs(adam));
    const auto plots = claim_plots(judgement.evidence, "twice");
    ASSERT_EQ(plots.size(), 1U);
    ASSERT_EQ(plots[0].series.size(), 2U);
    const PlotSeries& goal = plots[0].published.at(0);
    EXPECT_EQ(goal.x, std::vector<Real>{Real(kEnd)});
    EXPECT_NEAR(goal.y[0], 0.22, 1e-12);
    EXPECT_NEAR(goal.low[0], 0.95 * 0.22, 1e-12);
    EXPECT_NEAR(goal.high[0], 1.05 * 0.22, 1e-12);
    const Real end = plots[0].series[0].y.back();
    const bool is_within = end >= goal.low[0] && end <= goal.high[0];
    EXPECT_EQ(is_within, adam == 0.21);
    EXPECT_EQ(is_supported(judgement.verdict), is_within);
  }
}

TEST(Evidence, OfOneRunAtSeveralPlacesHasOneLine) {
  Json claim = twice("ratio", {"sip", "sip"});
  claim["quantity"]["terms"][0]["iteration"] = 0;
  const auto plots = claim_plots(judged(claim, falling_runs()).evidence, "twice");
  EXPECT_EQ(plots.at(0).series.size(), 1U);
  EXPECT_EQ(plots[0].published.at(0).x, std::vector<Real>{0});
}

// Figures 1, 10 and 100 at 1, 10 and 100: slope 1, and a published 0 through their middle, 10.
TEST(Evidence, ASlopeIsDrawnOverItsAbscissaThroughTheMiddle) {
  Evidence evidence{.kind = "slope", .column = "x_error", .band = {-0.5, 0.5}, .abscissa = "xi"};
  for (const Real at : {100.0, 1.0, 10.0})  // in any order
    evidence.terms.push_back({.optimizer = "sip", .at = at, .level = at, .runs = {{.figure = at}}});
  const Plot plot = claim_plots(evidence, "slope").at(0);
  EXPECT_EQ(plot.x_label, "xi");
  EXPECT_EQ(plot.series.at(0).y, (std::vector<Real>{1, 10, 100}));
  const PlotSeries& goal = plot.published.at(0);
  for (const Real y : goal.y) EXPECT_NEAR(y, 10, 1e-9);
  EXPECT_NEAR(goal.low.at(0), 10 / std::sqrt(10.0), 1e-9);  // 10 · (1/10)^0.5
  EXPECT_NEAR(goal.high.at(2), 10 * std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(goal.low.at(1), 10, 1e-9);
}

TEST(Evidence, PrintedFiguresStandBesideThoseReached) {
  Json claim = twice("equality", {"sip"});
  claim["quantity"]["column"] = "deviation";
  claim["published"] = {{"table", {{1.5, 2.5}, {3.5, 4.5}}}};
  claim["tolerance"] = {{"from", "digits"}, {"absolute", 0.25}};
  std::vector<Record> runs = falling_runs();
  for (Record& run : runs) {
    run.trajectory = Trajectory{};
    for (std::size_t i = 0; i < run.curve.iteration.size(); ++i)
      run.trajectory->x.push_back({1.5 + 2 * (Real(i) - 1), 2.5 + 2.125 * (Real(i) - 1)});
    run.trajectory->y = run.trajectory->x;
  }
  const Judgement judgement = judged(claim, runs);
  ASSERT_EQ(judgement.evidence.printed.size(), 2U);
  EXPECT_EQ(judgement.evidence.printed[1].iteration, 2);
  EXPECT_EQ(judgement.evidence.printed[1].reached, (std::vector<Real>{3.5, 4.625}));
  EXPECT_EQ(judgement.measured->value, 0.125);
  const std::string text = terminal_claim(claim_section(judgement));
  EXPECT_TRUE(has(text, "3.500000, 4.625000  0.125")) << text;
}

TEST(ClaimSection, TellsAllOfItInEveryFormat) {
  const Judgement judgement = judged(twice(), falling_runs());
  const Document document = document_of(compare_optimizers(kNoRuns), {judgement});
  for (const std::string& text :
       {terminal_claim(claim_section(judgement)), markdown_report(document), claims_html(document)})
    for (const char* part :
         {"Adam ends twice as far.", "agrees, n = 3", "Someone (2022), Figure 1", "±5 % from text",
          "1.9 to 2.1", "range of 3", "Drawn by hand.", "6 runs of 50 iterations",
          "isoline claims twice --out results/twice", "sip2-b0.json"})
      EXPECT_TRUE(has(text, part)) << part << " in " << text;
}

TEST(ClaimSection, NamesTheLengthsThatAreMissing) {
  Json claim = twice();
  Json longer = claim["cells"][0];
  longer["iterations"] = 5000;
  longer["long"] = true;
  longer["terms"][0][0]["cells"] = {"adam0", "adam1-long"};
  claim["cells"].insert(claim["cells"].begin(), longer);
  const Judgement judgement = judged(claim, falling_runs());
  ASSERT_EQ(judgement.sets.size(), 2U);
  EXPECT_EQ(judgement.sets[0].here, 4U);
  EXPECT_EQ(judgement.sets[0].planned, 5U);
  EXPECT_FALSE(judgement.sets[0].is_deciding);
  EXPECT_TRUE(judgement.sets[1].is_deciding);
  const std::string text = terminal_claim(claim_section(judgement));
  EXPECT_TRUE(has(text, "5 runs of 5000 iterations")) << text;
}

TEST(ClaimSection, IsRepeatedWithLongRunsWhereTheseDecideIt) {
  EXPECT_EQ(repeat_command("a", {{.is_long = true, .is_deciding = true}, {.is_long = false}}),
            "./isoline claims a --out results/a --long");
  EXPECT_EQ(repeat_command("a", {{.is_long = true}, {.is_long = false}}),
            "./isoline claims a --out results/a");
  EXPECT_EQ(repeat_command("a", {}), "") << "no runs can decide it";
}

TEST(ClaimSection, WithoutRunsSaysSoAndDrawsNothing) {
  const Section section = claim_section(judged(twice(), {}));
  EXPECT_TRUE(section.plots.empty());
  EXPECT_TRUE(section.tables.empty());
  EXPECT_TRUE(has(terminal_claim(section), "square × adam"));
}

TEST(ClaimsOfThePage, AreLedToByTheirRows) {
  const Judgement judgement = judged(twice(), falling_runs());
  const std::string html = claims_html(document_of(compare_optimizers(kNoRuns), {judgement}));
  EXPECT_EQ(count_of(html, "id=\"claim-twice\""), 1U);
  EXPECT_EQ(count_of(html, "href=\"#claim-twice\""), 1U);
  EXPECT_EQ(count_of(html, "<svg class=\"chart\""), 1U);
  EXPECT_EQ(count_of(html, "class=goal><path class=span"), 1U);
}

// An address cannot hold all that the name of a folder can.
TEST(ClaimsOfThePage, LeadToTheRecordsThatAreThere) {
  const ResultFolder folder;
  std::vector<Record> runs = falling_runs();
  std::filesystem::create_directories(folder.path() / "odd #1" / "runs");
  for (const Record& run : runs)
    if (run.cell != "sip2") folder.add_file("odd #1/runs/" + run.file_name(), to_json(run).dump());
  const Study study = read_study({(folder.path() / "odd #1").string()});
  Document document = document_of(compare_optimizers(study), {judged(twice(), runs)});
  EXPECT_EQ(count_of(claims_html(document), ".json\">"), 0U) << "where it goes is not known";
  document.out = (folder.path() / "report").string();
  EXPECT_EQ(count_of(claims_html(document), "href=\"../odd%20%231/runs/adam0-b0.json\""), 1U);
  EXPECT_EQ(count_of(claims_html(document), ".json\">"), 5U);
  document.out = (folder.path().parent_path() / "elsewhere").string();
  const std::string name = folder.path().filename().string();
  EXPECT_EQ(
      count_of(claims_html(document), "href=\"../" + name + "/odd%20%231/runs/adam0-b0.json\""),
      1U);
}

TEST(ClaimsOfTheJson, HoldTheEvidenceByTheSchema) {
  const Judgement judgement = judged(twice(), falling_runs());
  const Json json =
      parse_json(json_report(document_of(compare_optimizers(kNoRuns), {judgement})), "report");
  const std::filesystem::path tree = ISOLINE_SOURCE_DIR;
  EXPECT_EQ(schema_violations(json, read_json(tree / "benchmarks/schemas/report.json")),
            std::vector<std::string>());
  const Json& claim = json.at("claims").at(0);
  EXPECT_EQ(claim.at("evidence").at("terms").at(0).at("median"), judgement.evidence.terms[0].level);
  EXPECT_EQ(claim.at("evidence").at("terms").at(1).at("runs").at(2).at("record"), "sip2-b0.json");
  EXPECT_EQ(claim.at("evidence").at("band"), (Json{1.9, 2.1}));
  EXPECT_EQ(claim.at("sets").at(0).at("here"), 6);
  EXPECT_EQ(claim.at("command"), "./isoline claims twice --out results/twice");
}

}  // namespace
}  // namespace isoline::reports
