// How work grows with the number of unknowns, over settings that differ in their size.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// N² unknowns. Method a needs 30 · N² forward solves, b twice as many, but never solves N = 64; c
// solves the smallest two alone, whose number of unknowns is then no sweep.
Study grids() {
  Study study;
  for (const Index N : {8, 16, 32, 64}) {
    const std::string spec = fmt::format("grid[N={},viscosity=0.1]", N);
    study.sheets.push_back(
        {.kind = "problem", .name = "grid", .spec = spec, .unknowns = N * N, .residuals = N * N});
    for (const char* method : {"a", "b", "c"}) {
      const bool is_solved = *method == 'a' || N <= (*method == 'b' ? 32 : 16);
      Record record = record_of({.problem = spec,
                                 .optimizer = method,
                                 .hits = is_solved ? 51U : 20U,
                                 .work_per_hit = N * N * (*method == 'a' ? 1 : 2)});
      record.request.problem.options = {
          {"N", N}, {"viscosity", 0.1}, {"mode", std::string("direct")}};
      record.cell = cell_digest(record.request);
      study.runs.push_back(std::move(record));
    }
  }
  return study;
}

TEST(SizeTable, HasTheSlopeOverTheSizesThatAreSolved) {
  const Table table = size_table(Compared(grids()));
  const std::string sweep = "grid[viscosity=0.1] (N)";
  EXPECT_EQ(at(table, "a", sweep), "1.00 (1.00 to 1.00)");
  EXPECT_EQ(at(table, "b", sweep), "1.00, " + words("size.unsolved", 1, 4));
  EXPECT_EQ(at(table, "c", sweep), "–, " + words("size.unsolved", 2, 4));
  EXPECT_TRUE(has(table.reading, "4096")) << table.reading;
  EXPECT_TRUE(has(table.reading, std::to_string(30 * 4096))) << table.reading;
}

// Between 64, 256, 1024 and 4096 unknowns exponents of 1, 1 and 2: fitted 1.3.
TEST(SizeTable, HasTheRangeOfSlopesBetweenNeighbours) {
  Study study = grids();
  for (Record& record : study.runs)
    if (record.request.optimizer.name == "a" &&
        record.request.problem.options.at("N") == OptionValue(Index{64})) {
      record = record_of(
          {.problem = record.request.problem.spec, .optimizer = "a", .work_per_hit = 4 * 4096});
      record.request.problem.options = {
          {"N", Index{64}}, {"viscosity", 0.1}, {"mode", std::string("direct")}};
      record.cell = cell_digest(record.request);
    }
  EXPECT_EQ(at(size_table(Compared(study)), "a", "grid[viscosity=0.1] (N)"), "1.30 (1.00 to 2.00)");
}

TEST(SizePlots, HaveALinePerMethodOverItsSolvedSizes) {
  const Plots plots = size_plots(Compared(grids()));
  ASSERT_EQ(plots.size(), 1U);
  ASSERT_EQ(plots[0].series.size(), 3U);
  EXPECT_EQ(plots[0].series[0].name, "a");
  EXPECT_EQ(plots[0].series[0].x, (std::vector<Real>{64, 256, 1024, 4096}));
  EXPECT_EQ(plots[0].series[0].y, (std::vector<Real>{30 * 64, 30 * 256, 30 * 1024, 30 * 4096}));
  EXPECT_EQ(plots[0].series[1].x, (std::vector<Real>{64, 256, 1024}));
}

TEST(SizeTable, RequiresThreeSizesOfOneProblem) {
  Study study = grids();
  std::erase_if(study.runs, [](const Record& record) {
    return record.request.problem.options.number("N", 0) == 0 ||
           record.request.problem.options.at("N") == OptionValue(Index{8}) ||
           record.request.problem.options.at("N") == OptionValue(Index{16});
  });
  EXPECT_TRUE(size_table(Compared(study)).id.empty());
  EXPECT_TRUE(size_plots(Compared(std::move(study))).empty());
}

}  // namespace
}  // namespace isoline::reports
