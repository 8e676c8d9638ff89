// By what a report measures: the scale of a loss, the two kinds of success, other tolerances.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/results/ranking.h"
#include "core/results/study.h"
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
  Study study;
  study.runs = {record};
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(c.taken(c.runs[0], Measure::work, 0), kNever);
  EXPECT_EQ(c.optimizers[0].standings[0].solved, 0U);
  EXPECT_DOUBLE_EQ(c.runs[0].goal(0.5), 0.562);
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
  Study study;
  study.runs = {lost_in_x()};
  const Comparison c = compare_optimizers(study);
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
  Study study;
  study.runs = {record};
  const Comparison c = compare_optimizers(study);
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
  Study study;
  study.runs = {record};
  const Comparison c = compare_optimizers(study);
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
  Study study;
  study.runs = {a, b};
  const Comparison by_work = compare_optimizers(study, yardstick_at(Measure::work, 1e-4)),
                   by_steps = compare_optimizers(study, yardstick_at(Measure::iterations, 1e-4));
  EXPECT_EQ(by_work.optimizers[0].label, "a");
  EXPECT_EQ(by_work.cell(0, 0).headline[kTightest].median, 40);
  EXPECT_EQ(by_steps.optimizers[0].label, "b");
  EXPECT_EQ(by_steps.cell(0, 0).headline[kTightest].median, 10);
  EXPECT_EQ(median_costs(by_steps, kTightest, Measure::work)[0][0], 100);
}

}  // namespace
}  // namespace isoline::reports
