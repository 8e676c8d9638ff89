// The tables of statistics: hand-computed cases, and the same figure in every format.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string at(const Table& table, const std::string& row, const std::string& column) {
  const auto i = std::ranges::find(table.columns, column) - table.columns.begin();
  for (const auto& cells : table.rows)
    if (cells[0].text == row) return cells.at(static_cast<std::size_t>(i)).text;
  return "no such row";
}

// Work 30, 300 and never: a third within 100, two thirds within 1000.
TEST(Tables, DataProfileCountsForwardSolvesAndKeepsFailures) {
  const Study study = study_of({{"p", "a", 1}, {"q", "a", 10}, {"r", "a", 0}});
  const Table table = data_profile_table(compare_optimizers(study));
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
  Study study;
  study.runs = {record_of({.seed = 0, .work_per_hit = 2}),
                record_of({.seed = 1, .hits = 10, .work_per_hit = 2, .status = Status::budget})};
  const Table table = restart_table(compare_optimizers(study));
  EXPECT_TRUE(at(table, "gd", "square").starts_with("78 [60–")) << at(table, "gd", "square");
  EXPECT_TRUE(at(table, "gd", "square").ends_with("(1/2)")) << at(table, "gd", "square");
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

TEST(Tables, RestartsSayThatTheyDrawOtherInstances) {
  const Study study = study_of({{"p", "a", 1}});
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(has(restart_table(c).caption, "has another start"));
}

// Two sizes of one problem are two settings of it: a count of rows says so.
TEST(Tables, CountsOfSettingsAreNotCalledProblems) {
  const Study study = study_of({{"p[N=8]", "a", 1}, {"p[N=16]", "a", 1}});
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(data_profile_table(c), "a", "n settings"), "2");
  EXPECT_EQ(std::ranges::count(data_profile_table(c).columns, "n problems"), 0);
}

TEST(Tables, EveryFormatPrintsTheSameFigures) {
  const ResultFolder folder;
  write_sample_study(folder.path(), {.problems = 5, .optimizers = 6, .seeds = 3, .points = 30});
  const Study study = read_study({folder.path()});
  const Document document = document_of(compare_optimizers(study));
  const std::string html = html_report(document), markdown = markdown_report(document),
                    latex = latex_report(document);
  std::size_t count = 0;
  for (const Table& table : document.section("statistics").tables) {
    EXPECT_FALSE(table.reading.empty()) << table.id;
    EXPECT_TRUE(std::ranges::any_of(table.columns,
                                    [](const std::string& name) { return name == "failed"; }) ||
                table.id == "prices" || table.id == "choices")
        << table.id;
    for (const auto& row : table.rows) {
      ASSERT_EQ(row.size(), table.columns.size()) << table.id;
      for (const TableCell& each : row) {
        const std::string& cell = each.text;
        const bool is_figure = cell.find_first_not_of("0123456789.e-") == std::string::npos;
        if (!is_figure || cell.empty()) continue;
        for (const std::string* text : {&html, &markdown, &latex})
          EXPECT_TRUE(has(*text, cell)) << table.id << ": " << cell;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 40U);
}

}  // namespace
}  // namespace isoline::reports
