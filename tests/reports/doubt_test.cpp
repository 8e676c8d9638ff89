// What a comparison must not take at its word: cells that a clock cut, records that contradict
// themselves or each other, times that are no numbers, differences that are rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "reports/compare/gate.h"
#include "tests/reports/changed_cell.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

GateResult compared(const std::function<void(Record&)>& change) {
  const ResultFolder before, after;
  fill(before, [](Record&) {});
  fill(after, change);
  return compare_results(before.path(), after.path(), {});
}

// Its loss may be anything: nobody can say that it is the same.
TEST(Doubt, ACellThatAClockCutIsNotComparableOrWorseByItsStatus) {
  const auto cut = [](Status status) {
    return compared([status](Record& record) {
      record.is_nondeterministic = true;
      record.status = status;
      record.summary.loss *= 1e18;
    });
  };
  const GateResult same = cut(Status::budget);
  EXPECT_EQ(same.exit_code, kNotComparable);
  EXPECT_EQ(same.equal, 11U);
  ASSERT_EQ(same.incomparable.size(), 1U);
  EXPECT_TRUE(has(same.incomparable[0].reason, "a clock or a kill ended it in NEW (budget)"));
  EXPECT_TRUE(has(same.verdict, "seed 5: a clock or a kill ended it")) << same.verdict;
  const GateResult killed = cut(Status::timeout);
  EXPECT_EQ(killed.exit_code, kWorse);
  EXPECT_TRUE(has(killed.verdict, "status budget → timeout")) << killed.verdict;
}

TEST(Doubt, ATimeoutIsCutWhateverItsRecordSaysBesides) {
  const ResultFolder before, after;
  for (const ResultFolder* folder : {&before, &after})
    fill(*folder, [](Record& record) { record.status = Status::timeout; });
  EXPECT_EQ(compare_results(before.path(), after.path(), {}).exit_code, kNotComparable);
}

TEST(Doubt, TwoRecordsOfOneCellAndBuildThatDifferAreNamedAndNotCompared) {
  const ResultFolder before, after;
  fill(before, [](Record&) {});
  fill(after, [](Record&) {});
  Record other = read_study({after.path()}).runs[5];
  other.repeat_wall_seconds = {0.3};
  after.add_file("runs/other.json", to_json(other).dump());
  EXPECT_EQ(compare_results(before.path(), after.path(), {}).exit_code, kGood)
      << "timings may differ";
  other.summary.loss *= 2;
  after.add_file("runs/other.json", to_json(other).dump());
  const GateResult result = compare_results(before.path(), after.path(), {});
  EXPECT_EQ(result.exit_code, kNotComparable);
  ASSERT_EQ(result.incomparable.size(), 1U);
  EXPECT_TRUE(result.incomparable[0].title.ends_with("seed 5"));
  EXPECT_TRUE(has(result.incomparable[0].reason, "two records of this cell and build differ"));
}

TEST(Doubt, ACellThatIsNotTheDigestOfItsRequestIsNotCompared) {
  const GateResult result = compared([](Record& record) { record.request.budget.work = 7; });
  EXPECT_EQ(result.exit_code, kNotComparable);
  ASSERT_EQ(result.incomparable.size(), 1U);
  EXPECT_TRUE(has(result.incomparable[0].reason, "its cell is not the digest of its request"));
}

// From 0 to 4.4e-15, twenty units in the last place of x = 1.
TEST(Doubt, RoundingOfAnErrorInXIsNoDifferenceWithinATolerance) {
  const auto with = [](Real before, Real after, Real scale, Real tolerance) {
    const ResultFolder old, now;
    for (const auto& [folder, x_error] : {std::pair(&old, before), {&now, after}})
      fill(*folder, [&](Record& record) {
        record.summary.x_error = x_error;
        record.x_scale = scale;
      });
    return compare_results(old.path(), now.path(), {.tolerance = tolerance}).exit_code;
  };
  EXPECT_EQ(with(0, 4.4e-15, 1, 1e-6), kGood);
  EXPECT_EQ(with(0, 4.4e-15, 1e-9, 1e-6), kWorse) << "not where x is that small";
  EXPECT_EQ(with(0, 4.4e-9, 1, 1e-6), kWorse) << "nor where it is no rounding";
  EXPECT_EQ(with(1e-3, 1.1e-3, 1, 1e-6), kWorse);
}

// A start of 1e107 explains no difference of 1e90: rounding goes by the scale of the problem.
TEST(Doubt, RoundingGoesByTheScaleOfTheProblemNotByTheStart) {
  const ResultFolder before, after;
  for (const auto& [folder, loss] : {std::pair(&before, 0.07), {&after, 1e90}})
    fill(*folder, [&](Record& record) {
      record.summary.start_loss = 1e107;
      record.scale = 10;
      record.summary.loss = loss;
    });
  EXPECT_EQ(compare_results(before.path(), after.path(), {.tolerance = 1e-6}).exit_code, kWorse);
}

TEST(Doubt, ATimeThatIsNotANumberIsLeftOut) {
  const ResultFolder before, after;
  for (const ResultFolder* folder : {&before, &after})
    fill(*folder, [](Record& record) {
      record.repeat_wall_seconds = std::vector<Real>(10, 0.1);
      record.repeat_wall_seconds.back() = std::nan("");
    });
  const GateResult result = compare_results(before.path(), after.path(), {});
  EXPECT_EQ(result.exit_code, kGood);
  ASSERT_EQ(result.times.size(), 1U);
  EXPECT_EQ(result.times[0].n_before, 9U);
  EXPECT_TRUE(has(gate_terminal(result), "2 timings left out")) << gate_terminal(result);
}

}  // namespace
}  // namespace isoline::reports
