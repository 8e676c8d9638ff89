// The two kinds of success held against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

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

std::string at(const Table& table, const std::string& row, const std::string& column) {
  const auto i = std::ranges::find(table.columns, column) - table.columns.begin();
  for (const auto& cells : table.rows)
    if (cells[0].text == row) return cells.at(static_cast<std::size_t>(i)).text;
  return "no such row";
}

// On p all but x are found: its error falls as the loss to the power 1/20. On q both are.
Study both_kinds() {
  Study study;
  study.runs = {run_of("p", "gd", 0.05), run_of("q", "gd", 1), run_of("p", "newton", 0.05, 11),
                run_of("q", "newton", 0.5, 35)};
  study.sheets = {sheet_of("p", 3e7), sheet_of("q", std::numeric_limits<Real>::infinity())};
  return study;
}

TEST(LossWithoutX, IsCountedByMethodWithTheConditionNumberBeside) {
  const Study study = both_kinds();
  const Table table = loss_without_x_table(compare_optimizers(study));
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
  EXPECT_NE(table.reading.find("3 reach the loss to 1e-6 and 1 find x"), std::string::npos)
      << table.reading;
}

TEST(LossWithoutX, SaysWhereNeitherCanBeTold) {
  Study study;
  study.runs = {record_of({})};  // no solution is known
  const Table table = loss_without_x_table(compare_optimizers(study));
  EXPECT_TRUE(table.rows.empty());
  EXPECT_NE(table.reading.find("No result has both"), std::string::npos);
}

}  // namespace
}  // namespace isoline::reports
