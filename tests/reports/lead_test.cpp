// Who is ahead and by how much, against counts by hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports/read/leaders.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// `gd` takes `factor` times the work of `newton` on each of five problems.
Study pair_study(std::int64_t factor, std::size_t hits_of_gd = 51) {
  Study study;
  for (const char* problem : {"a", "b", "c", "d", "e"}) {
    study.runs.push_back(record_of({.problem = problem, .optimizer = "newton"}));
    study.runs.push_back(record_of(
        {.problem = problem, .optimizer = "gd", .hits = hits_of_gd, .work_per_hit = 2 * factor}));
  }
  return study;
}

TEST(Lead, AConstantFactorIsCertain) {
  const Study study = pair_study(3);
  const Comparison comparison = compare_optimizers(study);
  const auto lead = lead_of(comparison, false);
  ASSERT_TRUE(lead.has_value());
  EXPECT_EQ(comparison.optimizers[lead->ranked[0].optimizer].label, "newton");
  EXPECT_EQ(lead->ranked[0].score, 1);
  EXPECT_EQ(lead->ranked[0].wins, 5U);
  EXPECT_EQ(lead->factor, 3);
  EXPECT_EQ(lead->interval.low, 3);
  EXPECT_EQ(lead->interval.high, 3);
  EXPECT_EQ(lead->compared, 5U);
  EXPECT_EQ(lead->stays_first, 1);
}

TEST(Lead, WhatTheSecondNeverSolvesIsAnInfiniteFactor) {
  const Study study = pair_study(1, 10);
  const Comparison comparison = compare_optimizers(study);
  const auto lead = lead_of(comparison, false);
  ASSERT_TRUE(lead.has_value());
  EXPECT_EQ(lead->factor, kNever);
  EXPECT_EQ(lead->ranked[1].solved, 0U);
}

TEST(Lead, ThePrivilegedAreLeftOutAmongTheOpen) {
  Study study = pair_study(3);
  for (Record& record : study.runs)
    if (record.request.optimizer.name == "newton") record.privileges = {"exact Hessian"};
  const Comparison comparison = compare_optimizers(study);
  const auto lead = lead_of(comparison, true);
  ASSERT_TRUE(lead.has_value());
  ASSERT_EQ(lead->ranked.size(), 1U);
  EXPECT_EQ(comparison.optimizers[lead->ranked[0].optimizer].label, "gd");
  EXPECT_EQ(lead->ranked[0].score, 1);  // measured by the best of themselves
}

TEST(Lead, NobodyLeadsWhereNothingIsSolved) {
  Study study;
  study.runs = {record_of({.hits = 3, .status = Status::budget})};
  EXPECT_FALSE(lead_of(compare_optimizers(study), false).has_value());
}

}  // namespace
}  // namespace isoline::reports
