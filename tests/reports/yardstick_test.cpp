// By what a report measures: the scale of a loss, the two kinds of success, other tolerances.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/json_view.h"
#include "core/results/ranking.h"
#include "core/results/study.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// From 1e107 down to 1e91, sixteen decades: a start that was drawn badly makes nothing solved.
TEST(Yardstick, AHugeStartMakesNoLossSmall) {
  Record record = record_of({.hits = 2, .status = Status::budget});
  record.hits.reset();
  record.minimum = 0.062;
  record.scale = 1;
  record.curve.loss = {1.6e107, 1.6e91};
  record.summary.start_loss = 1.6e107;
  record.summary.loss = record.summary.best_loss = 1.6e91;
  const Compared c({record});
  EXPECT_EQ(c.taken(c.runs[0], Measure::work, 0), kNever);
  EXPECT_EQ(c.optimizers[0].standings[0].solved, 0U);
}

// The loss falls ten decades, the error in x to a third at most.
Record lost_in_x() {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  for (Real& error : record.curve.x_error) error = std::max(error, 0.35);
  record.summary.x_error = 0.35;
  return record;
}

TEST(Yardstick, AProblemThatWantsXIsNotSolvedByASmallLoss) {
  const Compared c({lost_in_x()});
  const reports::Run& run = c.runs[0];
  EXPECT_EQ(run.loss_met, 51U);
  EXPECT_EQ(run.x_met, 3U);  // 0.4 is met, 0.35 is the floor
  EXPECT_EQ(c.taken(run, Measure::work, 0), kNever);
  EXPECT_EQ(c.problems[0].aim, Aim::x);
  EXPECT_EQ(c.optimizers[0].standings[0].solved, 0U);
  EXPECT_FALSE(c.decision.has_value());
}

// The curve 10^(−j/10) meets 1e-1 at its tenth point, after 20 forwards.
TEST(Yardstick, XIsFoundWhereItsErrorIsATenthOfTheSolution) {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  const Compared c({record});
  EXPECT_EQ(c.taken(c.runs[0], Measure::work, 0), 20);
  EXPECT_EQ(c.taken(c.runs[0], Measure::iterations, 0), 10);
  EXPECT_FALSE(c.cell(0, 0).is_bound[0]) << "no point was skipped";
}

TEST(Yardstick, NoDataGiveMoreThanTheirFloor) {
  Record record = lost_in_x();
  record.x_floor = 0.32;  // 1.1 times that is 0.352
  Study study;
  study.runs = {record};
  EXPECT_GT(compare_optimizers(study).runs[0].targets.size(), kTolerances[kTightest].rung);
}

TEST(Yardstick, BetweenKeptPointsAFigureIsABound) {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  for (std::size_t i = 10; i < record.curve.iteration.size(); ++i) record.curve.iteration[i] += 5;
  const Compared c({record});
  EXPECT_TRUE(c.runs[0].targets[kTolerances[0].rung].is_bound);
  EXPECT_TRUE(c.cell(0, 0).is_bound[0]);
}

TEST(Yardstick, BetweenRungsTheNextStricterHolds) {
  EXPECT_EQ(tolerance_at(1e-4).name, "1e-4");
  EXPECT_EQ(tolerance_at(1e-4).rung, 20U);
  EXPECT_EQ(tolerance_at(2e-4).rung, 19U);
  EXPECT_LE(tolerance_at(2e-4).tau, 2e-4);
  EXPECT_EQ(tolerance_at(2e-4).name, "1.6e-4");
}

TEST(Yardstick, AnotherHeadlineKeepsTheLooserTolerancesLooser) {
  const Yardstick usual = yardstick_at(Measure::work, 1e-4),
                  loose = yardstick_at(Measure::work, 0.1);
  EXPECT_EQ(usual.tolerances[1].name, "1e-3");
  EXPECT_EQ(usual.tightest().name, "1e-4");
  for (const Yardstick& each : {usual, loose, yardstick_at(Measure::time, 1e-10)})
    for (std::size_t t = 1; t < kTolerances.size(); ++t)
      EXPECT_LT(each.tolerances[t - 1].rung, each.tolerances[t].rung);
}

// `a` takes fewer forwards, `b` fewer iterations to 1e-4: 40 and 100 forwards, 20 and 10 steps.
TEST(Yardstick, WhatIsCountedDecidesWhoIsBest) {
  Record a = record_of({.optimizer = "a"}), b = record_of({.optimizer = "b", .work_per_hit = 5});
  for (auto* steps : {&b.hits->iteration, &b.curve.iteration})
    for (std::int64_t& step : *steps) step /= 2;
  const Compared by_work({a, b}, yardstick_at(Measure::work, 1e-4)),
      by_steps({a, b}, yardstick_at(Measure::iterations, 1e-4));
  EXPECT_EQ(by_work.optimizers[0].label, "a");
  EXPECT_EQ(by_work.cell(0, 0).headline[kTightest].median, 40);
  EXPECT_EQ(by_steps.optimizers[0].label, "b");
  EXPECT_EQ(by_steps.cell(0, 0).headline[kTightest].median, 10);
  EXPECT_EQ(median_costs(by_steps, kTightest, Measure::work)[0][0], 100);
}

// a takes fewer forward solves, b fewer iterations and less time, on each of five problems.
Study crossed() {
  Study study;
  for (const char* problem : {"p", "q", "r", "s", "t"}) {
    Record a = record_of({.problem = problem, .optimizer = "a", .work_per_hit = 1});
    Record b = record_of({.problem = problem, .optimizer = "b", .work_per_hit = 8});
    for (auto& seconds : a.hits->wall_seconds) seconds *= 100;
    for (auto& iteration : a.hits->iteration) iteration *= 3;
    for (Record* record : {&a, &b}) {
      record->provenance.run.is_exclusive = true;
      record->provenance.run.concurrent_jobs = 1;
      study.runs.push_back(*record);
    }
  }
  return study;
}

// To 1e-4, the 20th target, b takes 8 · 20 = 160 forward solves and 1.6 ms.
TEST(OtherYardsticks, EveryFormatTellsItsMeasureAndItsTolerance) {
  const Study study = crossed();
  const Document work = document_of(compare_optimizers(study, yardstick_at(Measure::work, 1e-4)));
  const Document time = document_of(compare_optimizers(study, yardstick_at(Measure::time, 1e-4)));
  for (const auto text : {html_report, markdown_report, latex_report, terminal_table}) {
    EXPECT_TRUE(has(text(work), "1e-4"));
    EXPECT_TRUE(has(text(work), "160"));
    EXPECT_FALSE(has(text(work), "wall time to"));
    EXPECT_TRUE(has(text(time), "wall time"));
    EXPECT_TRUE(has(text(time), "1.6"));
  }
  EXPECT_TRUE(has(csv_report(work), ",work_to_1e-4"));
  const Json json = parse_json(json_report(time), "report");
  EXPECT_EQ(json["yardstick"]["by"], "time");
  EXPECT_EQ(json["yardstick"]["tolerances"][2]["name"], "1e-4");
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/report.json");
  EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>());
}

TEST(OtherYardsticks, ThePageStartsAtTheTolerancesOfTheReport) {
  const Study study = crossed();
  const std::string page =
      html_report(document_of(compare_optimizers(study, yardstick_at(Measure::iterations, 1e-4))));
  EXPECT_TRUE(has(page, "\"by\":\"iterations\"")) << "what its scripts count";
  EXPECT_TRUE(has(page, "\"rungs\":[5,15,20]"));
  EXPECT_TRUE(has(page, "<output id=\"tau\">1e-4</output>"));
}

TEST(OtherYardsticks, TimesTakenBesideOtherRunsAreMarked) {
  Study study = crossed();
  for (Record& record : study.runs) record.provenance.run.concurrent_jobs = 2;
  for (Record& record : study.runs) record.provenance.run.is_exclusive = false;
  const Document document =
      document_of(compare_optimizers(study, yardstick_at(Measure::time, 1e-6)));
  EXPECT_TRUE(has(markdown_report(document), "2.4≈"));
  EXPECT_TRUE(has(terminal_table(document), "≈"));
}

}  // namespace
}  // namespace isoline::reports
