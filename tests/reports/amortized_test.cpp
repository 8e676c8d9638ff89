// Training once, or solving each: a table of Table 1's kind from records made by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

Record asked(const std::string& problem, const std::string& optimizer, std::uint64_t seed,
             const OptionValues& options) {
  Record record = record_of({.problem = problem, .optimizer = optimizer, .seed = seed});
  record.request.problem.options = options;
  record.request.problem.is_learned = asks_to_learn(options);
  record.cell = cell_digest(record.request);
  return record;
}

constexpr const char* kLearned = "flow[mode=learn]";

// Ends at that error in x, after so many seconds.
Record trained(std::uint64_t seed, Real x_error, Real seconds, const std::string& by = "sip") {
  Record record =
      asked(kLearned, by, seed, {{"N", Index{8}}, {"mode", "learn"}, {"batch", Index{4}}});
  record.summary.x_error = x_error;
  record.summary.processor_seconds = seconds;
  return record;
}

// Errors 10, 1, 0.1 after 0, 1 and 2 times so many seconds.
Record single(const std::string& solver, std::uint64_t seed, Real seconds,
              const OptionValues& options = {{"N", Index{8}}, {"mode", "direct"}}) {
  Record record = asked(options.number("N", 0) == 8 ? "flow" : "flow[N=9]", solver, seed, options);
  record.curve = {};
  record.curve.iteration = {0, 1, 2};
  record.curve.x_error = {10, 1, 0.1};
  record.curve.processor_seconds = {0, seconds, 2 * seconds};
  return record;
}

// The network takes a sixteenth of a forward solve of 2⁻⁶ s: about a millisecond an example.
Sheet timed() {
  Sheet sheet{.kind = "problem", .name = "flow", .spec = kLearned, .options_text = "[]"};
  sheet.prices = MeasuredPrices{"b", "processor", 0x1p-6, {}};
  sheet.prices->oracles = {{"forward", 1, 1, 1, 1, 31, 620},
                           {kInference, 0, 0x1p-4, 0x1p-4, 0x1p-4, 3, 9}};
  return sheet;
}

struct Shown {
  Study study;
  Section section;

  explicit Shown(std::vector<Record> runs, std::vector<Sheet> sheets = {timed()}) {
    study.runs = std::move(runs);
    study.sheets = std::move(sheets);
    section = amortized_section(compare_optimizers(study));
  }
  const TableCell& cell(std::size_t row, const std::string& column) const {
    const Table& table = section.tables.at(0);
    const auto at = std::ranges::find(table.columns, column) - table.columns.begin();
    return table.rows.at(row).at(static_cast<std::size_t>(at));
  }
  std::string text(std::size_t row, const std::string& column) const {
    return cell(row, column).text;
  }
  Real number(std::size_t row, const std::string& column) const {
    const auto& numbers = cell(row, column).numbers;
    return numbers.empty() ? NAN : numbers[0].second;
  }
};

constexpr const char* kSolved = "solver to that error, ms";

// 300·2⁻⁶ s of training and 2⁻¹⁰ s each, against 2⁻⁶ s more than that.
TEST(Amortized, TrainingPaysFromSoManyInstancesAsItsTimeHoldsSavings) {
  const Shown shown({trained(0, 1, 300 * 0x1p-6), single("newton", 0, 0x1p-6 + 0x1p-10)});
  ASSERT_EQ(shown.section.tables.size(), 1U);
  EXPECT_EQ(shown.number(0, "training, s"), 300 * 0x1p-6);
  EXPECT_EQ(shown.number(0, "per example, ms"), 0x1p-10);
  EXPECT_EQ(shown.number(0, kSolved), 0x1p-6 + 0x1p-10);
  EXPECT_EQ(shown.number(0, "pays off from"), 300);
  EXPECT_TRUE(has(shown.section.tables[0].reading, "from 300 instances"));
}

TEST(Amortized, SolversAreTimedToTheErrorOfEachNetwork) {
  const Shown shown({trained(0, 1, 3), trained(0, 0.5, 3, "adam"), single("newton", 0, 2)});
  EXPECT_EQ(shown.text(0, "network of"), "adam") << "the nearer one first";
  EXPECT_EQ(shown.number(0, kSolved), 4) << "0.1 is the first kept error below 0.5";
  EXPECT_EQ(shown.number(1, kSolved), 2);
}

// Two of three instances get there, one of them late: the median is what it takes.
TEST(Amortized, InstancesThatNeverGetThereStayInTheMedian) {
  Record lost = single("gd", 2, 1), late = single("gd", 1, 50);
  lost.curve.x_error = {10, 9, 8};
  const Shown some({trained(0, 1, 3), single("gd", 0, 1), late, lost});
  EXPECT_EQ(some.number(0, kSolved), 50);
  EXPECT_EQ(some.text(0, "there"), "2/3");
  late.curve.x_error = lost.curve.x_error;
  const Shown none({trained(0, 1, 3), single("gd", 0, 1), late, lost});
  EXPECT_EQ(none.text(0, kSolved), "✗");
  EXPECT_EQ(none.text(0, "pays off from"), "the solver has not reached it");
  Record crashed = single("gd", 2, 1);
  crashed.status = Status::crashed;
  const Shown failed({trained(0, 1, 3), single("gd", 0, 1), single("gd", 1, 1), crashed});
  EXPECT_EQ(failed.text(0, "there"), "2/3");
  EXPECT_EQ(failed.text(0, "failed"), "0, 1");
}

TEST(Amortized, ANetworkNoNearerThanWhereSolversStartIsSaidToBe) {
  const Shown shown({trained(0, 11, 3), single("newton", 0, 2)});
  EXPECT_EQ(shown.number(0, kSolved), 0);
  EXPECT_EQ(shown.text(0, "pays off from"), "never");
  EXPECT_TRUE(has(shown.section.tables[0].reading, "newton starts with"))
      << shown.section.tables[0].reading;
}

TEST(Amortized, TimesThatWereNotMeasuredAreAbsent) {
  const Shown shown({trained(0, 1, 3), single("newton", 0, 0.011)}, {});
  EXPECT_EQ(shown.text(0, "per example, ms"), "");
  EXPECT_EQ(shown.text(0, "pays off from"), "");
  EXPECT_EQ(shown.number(0, "training, s"), 3);
}

// What is not the same physics is no instance of what was learned.
TEST(Amortized, InstancesHaveTheOptionsOfWhatWasLearned) {
  const OptionValues other{{"N", Index{9}}, {"mode", "direct"}};
  EXPECT_TRUE(Shown({trained(0, 1, 3), single("gd", 0, 1, other)}).section.is_empty());
  EXPECT_TRUE(Shown({trained(0, 1, 3)}).section.is_empty());
  EXPECT_TRUE(Shown({single("gd", 0, 1)}).section.is_empty());
}

}  // namespace
}  // namespace isoline::reports
