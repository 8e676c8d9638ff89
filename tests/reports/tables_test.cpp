// The tables of statistics: hand-computed cases, and the same figure in every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/seeds.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {
namespace {

// Work 30, 300 and never: a third within 100, two thirds within 1000.
TEST(Tables, DataProfileCountsForwardSolvesAndKeepsFailures) {
  const Table table =
      data_profile_table(Compared(study_of({{"p", "a", 1}, {"q", "a", 10}, {"r", "a", 0}})));
  EXPECT_EQ(at(table, "a", "≤ 10"), "0 %");
  EXPECT_EQ(at(table, "a", "≤ 100"), "33 %");
  EXPECT_EQ(at(table, "a", "≤ 1000"), "67 %");
  EXPECT_EQ(at(table, "a", "n problems"), "3");
}

// A loss from −1 to −5 with f_L = −5, read off the curve, since no minimum is declared.
TEST(Tables, ProfilesAreRightForNegativeLosses) {
  Study study = study_of({{"p", "a", 2}});
  Record& record = study.runs[0];
  record.hits.reset();
  record.minimum.reset();
  for (Real& loss : record.curve.loss) loss = -5 + 4 * loss;  // 1 … 1e-10 before
  record.summary.start_loss = -1;
  record.summary.loss = record.summary.best_loss = -5;
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 100"), "100 %");
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 10"), "0 %");
}

// One of two seeds gets there, after 60 of 102 spent in all by each... the other spends its 20.
TEST(Tables, ExpectedRunningTimeCountsWhatFailedRunsSpent) {
  const Table table = restart_table(
      Compared({record_of({.seed = 0, .work_per_hit = 2}),
                record_of({.seed = 1, .hits = 10, .work_per_hit = 2, .status = Status::budget})}));
  EXPECT_EQ(at(table, "gd", "square"), "78 (1/2)") << "two runs have no interval";
}

// Work 60, 90 and so on: the range of five runs, of twelve the middle 80 % of simulations.
TEST(Tables, ExpectedRunningTimeHasTheRangeOfFewRunsAndAnIntervalOfSix) {
  const auto text_of = [](std::uint64_t runs) {
    std::vector<Record> records;
    for (std::uint64_t seed = 0; seed < runs; ++seed)
      records.push_back(record_of({.seed = seed, .work_per_hit = 2 + std::int64_t(seed)}));
    return at(restart_table(Compared(std::move(records))), "gd", "square");
  };
  EXPECT_EQ(text_of(5), "120 [60–180] (5/5)");
  EXPECT_EQ(text_of(12), "225 [90–360] (12/12)");
}

// log2 of work is a constant + 2 instance + start, of which a plain design has no table.
TEST(Tables, VariationIsDividedBetweenInstancesAndStarts) {
  std::vector<Record> records;
  for (const std::uint64_t instance : {0U, 1U})
    for (const std::uint64_t start : {0U, 1U}) {
      const std::int64_t work = std::int64_t{2} << (2 * instance + start);
      records.push_back(record_of({.seed = seed_of(instance, start), .work_per_hit = work}));
      records.push_back(record_of({.optimizer = "other",
                                   .seed = seed_of(instance, start),
                                   .hits = instance == start ? 51U : 10U}));
    }
  const Table table = variation_table(Compared(records));
  EXPECT_EQ(at(table, "gd", "instances"), "80 %");  // variances 2 and 1/2
  EXPECT_EQ(at(table, "gd", "starts"), "20 %");
  EXPECT_EQ(at(table, "gd", "deviation"), "1.581");
  EXPECT_EQ(at(table, "other", "left out"), "1");
  EXPECT_TRUE(
      variation_table(Compared({record_of({.seed = 0}), record_of({.seed = 1})})).id.empty());
}

TEST(Tables, NobodyHasTheLargestAreaWhereAllAreZero) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s"})
    for (const char* optimizer : {"a", "b"})
      study.runs.push_back(record_of(
          {.problem = problem, .optimizer = optimizer, .hits = 1, .status = Status::budget}));
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(has(profile_table(c).reading, "No method solves any")) << profile_table(c).reading;
  const Document document = document_of(compare_optimizers(study));
  for (const Plot& plot : document.section("statistics").plots)
    if (plot.id != "plot-runtime") {  // whose first target is the start, which all meet
      EXPECT_FALSE(has(plot.reading, "a and 1 more")) << plot.id << ": " << plot.reading;
    }
}

// Two sizes of one problem are two settings of it: a count of rows says so.
TEST(Tables, CountsOfSettingsAreNotCalledProblems) {
  const Compared c(study_of({{"p[N=8]", "a", 1}, {"p[N=16]", "a", 1}}));
  EXPECT_EQ(at(data_profile_table(c), "a", "n settings"), "2");
  EXPECT_EQ(std::ranges::count(data_profile_table(c).columns, "n problems"), 0);
}

// Loss 10^(−j/5) at the j-th point, 1 at the start; its error in x is that to the power, of a
// solution of norm 1.
Record run_of(const char* problem, const char* optimizer, Real power, std::size_t points = 51) {
  Record record = record_of({.problem = problem, .optimizer = optimizer, .hits = points});
  record.minimum = 0;
  record.scale = record.x_scale = 1;
  for (std::size_t j = 0; j < points; ++j)
    record.curve.x_error[j] = std::pow(record.curve.loss[j], power);
  record.summary.x_error = record.curve.x_error.back();
  return record;
}

Sheet sheet_of(const char* problem, Real condition) {
  Sheet sheet{.kind = "problem", .name = problem, .spec = problem, .options_text = "[]"};
  sheet.unknowns = 2;
  sheet.condition = condition;
  return sheet;
}

// On p all but x are found: its error falls as the loss to the power 1/20. On q both are.
Study both_kinds() {
  return {.runs = {run_of("p", "gd", 0.05), run_of("q", "gd", 1), run_of("p", "newton", 0.05, 11),
                   run_of("q", "newton", 0.5, 35)},
          .sheets = {sheet_of("p", 3e7), sheet_of("q", std::numeric_limits<Real>::infinity())}};
}

TEST(LossWithoutX, IsCountedByMethodWithTheConditionNumberBeside) {
  const Table table = loss_without_x_table(Compared(both_kinds()));
  EXPECT_EQ(at(table, "gd", "n settings"), "2");
  EXPECT_EQ(at(table, "gd", "loss"), "2");
  EXPECT_EQ(at(table, "gd", "x"), "1");
  EXPECT_EQ(at(table, "gd", "loss, not x"), "1");
  EXPECT_EQ(at(table, "gd", "nor near"), "1");
  EXPECT_EQ(at(table, "gd", "loss, not x, on"), "p (3e7)");
  // Its loss is not reached on p; on q its x is near, to 1e-3, and not found to 1e-6.
  EXPECT_EQ(at(table, "newton", "loss"), "1");
  EXPECT_EQ(at(table, "newton", "loss, not x"), "1");
  EXPECT_EQ(at(table, "newton", "nor near"), "0");
  EXPECT_EQ(at(table, "newton", "loss, not x, on"), "q (singular)");
  EXPECT_TRUE(has(table.reading, "3 reach the loss to 1e-6 and 1 find x")) << table.reading;
}

TEST(LossWithoutX, SaysWhereNeitherCanBeTold) {
  const Table table = loss_without_x_table(Compared({record_of({})}));  // no solution is known
  EXPECT_TRUE(table.rows.empty());
  EXPECT_TRUE(has(table.reading, "No result has both"));
}

}  // namespace
}  // namespace isoline::reports
