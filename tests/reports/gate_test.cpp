// The gate: what is worse is caught, what is the same passes, what cannot be compared says so.
#include "reports/compare/gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "reports/report.h"
#include "tests/reports/changed_cell.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

GateResult compared(const std::function<void(Record&)>& change, const GateOptions& options = {}) {
  const ResultFolder before, after;
  fill(before, [](Record&) {});
  fill(after, change);
  return compare_results(before.path(), after.path(), options);
}

TEST(Gate, TwoRunsOfOneBuildAreEqual) {
  const GateResult result = compared([](Record& record) {
    record.summary.wall_seconds = 99;  // times and provenance of a run may differ
    record.curve.wall_seconds[3] = 99;
    record.hits->wall_seconds[3] = 99;
    record.provenance.run.started = "2026-07-01T00:00:00Z";
  });
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.joined, 12U);
  EXPECT_EQ(result.equal, 12U);
  EXPECT_TRUE(result.differences.empty());
  EXPECT_EQ(result.verdict, "equal");
}

TEST(Gate, CatchesFivePercentOfQualityInOneCell) {
  const GateResult loss = compared([](Record& record) { record.summary.loss *= 1.05; });
  EXPECT_EQ(loss.exit_code, 2);
  ASSERT_EQ(loss.differences.size(), 1U);
  EXPECT_EQ(loss.differences[0].what, "loss");
  EXPECT_NEAR(loss.differences[0].relative, 0.05, 1e-12);
  EXPECT_EQ(loss.equal, 11U);
  const GateResult error =
      compared([](Record& record) { record.summary.x_error *= 1.05; }, {.tolerance = 0.01});
  EXPECT_EQ(error.exit_code, 2);
  EXPECT_EQ(error.differences.at(0).what, "error in x");
  const GateResult work = compared([](Record& record) {
    for (std::int64_t& some : record.hits->work) some += some / 20;
  });
  EXPECT_EQ(work.exit_code, 2);
  EXPECT_TRUE(has(work.differences.at(0).what, "work to ")) << work.differences.at(0).what;
  EXPECT_TRUE(has(work.differences.at(0).note, "more of its kind"));
}

TEST(Gate, AToleranceLetsSmallDifferencesPass) {
  const auto change = [](Record& record) { record.summary.loss *= 1 + 1e-9; };
  EXPECT_EQ(compared(change).exit_code, 2);
  EXPECT_EQ(compared(change, {.tolerance = 1e-6}).exit_code, 0);
  // Below 1e-16 of the start there is rounding alone; not-a-number is no better than infinite.
  const auto rounding = [](Record& record) { record.summary.loss += 5e-17; };
  EXPECT_EQ(compared(rounding, {.tolerance = 0}).exit_code, 0);
  const auto lost = [](Record& record) { record.summary.loss = std::nan(""); };
  EXPECT_EQ(compared(lost, {.tolerance = 1}).exit_code, 2);
}

TEST(Gate, AWorseStatusIsWorseAndABetterOneBetter) {
  const auto with = [](Status status) {
    return compared([status](Record& record) { record.status = status; }).exit_code;
  };
  EXPECT_EQ(with(Status::crashed), 2);
  EXPECT_EQ(with(Status::diverged), 2);
  EXPECT_EQ(with(Status::target), 3);
  EXPECT_EQ(with(Status::stalled), 0);  // changed, and said so
  EXPECT_EQ(compared([](Record& record) { record.summary.loss /= 2; }).exit_code, 3);
}

TEST(Gate, ListsWhatIsWorstFirst) {
  const ResultFolder before, after;
  for (const auto& [seed, factor] : {std::pair{0, 1.1}, {1, 3.0}, {2, 0.5}, {3, 1.0}, {4, 1.2}}) {
    Record record = record_of({.seed = static_cast<std::uint64_t>(seed)});
    before.add(record);
    record.summary.loss *= factor;
    if (seed == 3) record.status = Status::failed;
    after.add(record);
  }
  const GateResult result = compare_results(before.path(), after.path(), {});
  std::vector<std::string> order;
  for (const Difference& difference : result.differences)
    order.push_back(difference.title.substr(difference.title.size() - 1) + " " + difference.what);
  EXPECT_EQ(order, (std::vector<std::string>{"3 status", "1 loss", "4 loss", "0 loss", "2 loss"}));
}

TEST(Gate, ADifferenceOfThePathAloneIsAChange) {
  const GateResult result = compared([](Record& record) { record.curve.step_norm[2] *= 2; });
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.equal, 11U);
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_EQ(result.differences[0].change, Change::changed);
  EXPECT_TRUE(has(result.differences[0].note, "the path differs"));
}

TEST(Gate, WhatDiffersBesideThePathIsCalledByItsName) {
  const GateResult result = compared([](Record& record) { record.message = "as it likes"; });
  EXPECT_EQ(result.exit_code, 0);
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_EQ(result.differences[0].what, "message");
  EXPECT_FALSE(has(gate_terminal(result), "the path differs")) << gate_terminal(result);
}

TEST(Gate, AnotherBuildIsNotComparableWithoutATolerance) {
  const auto rebuilt = [](Record& record) { record.build = "b1"; };
  const GateResult strict = compared(rebuilt);
  EXPECT_EQ(strict.exit_code, 4);
  EXPECT_EQ(strict.incomparable.size(), 1U);
  EXPECT_EQ(compared(rebuilt, {.tolerance = 0.01}).exit_code, 0);
  const auto broken = [](Record& record) {
    record.build = "b1";
    record.status = Status::failed;  // worse under any build
  };
  EXPECT_EQ(compared(broken).exit_code, 2);
}

TEST(Gate, CellsOfOneSideAreListedAndThoseThatNewLacksAreWorse) {
  const ResultFolder all, some;
  fill(all, [](Record&) {});
  some.add(read_study({all.path()}).runs[0]);
  const GateResult lacking = compare_results(all.path(), some.path(), {});
  EXPECT_EQ(lacking.exit_code, kWorse);
  EXPECT_EQ(lacking.only_before.size(), 11U);
  EXPECT_EQ(compare_results(all.path(), some.path(), {.is_common_only = true}).exit_code, 0);
  const GateResult grown = compare_results(some.path(), all.path(), {});
  EXPECT_EQ(grown.exit_code, 0);
  EXPECT_EQ(grown.only_after.size(), 11U);
  const ResultFolder empty;
  EXPECT_EQ(compare_results(all.path(), empty.path(), {.is_common_only = true}).exit_code, 4);
  EXPECT_THROW(compare_results(all.path(), "/no/such/folder", {}), UsageError);
}

TEST(Gate, SaysWhereRepetitionsAreTooFew) {
  EXPECT_TRUE(has(gate_terminal(compared([](Record&) {})), "too few repetitions"));
}

// b's best loss is the reference for both: with f_L = 1e-2 of BASE the goal stays where it was.
TEST(Gate, AnUndeclaredMinimumIsTheBestOfTheFirst) {
  const ResultFolder before, after;
  for (const ResultFolder* folder : {&before, &after}) {
    Record record = record_of({.hits = folder == &before ? 11U : 16U});
    record.hits.reset();
    record.minimum.reset();
    folder->add(record);
  }
  const GateResult result = compare_results(before.path(), after.path(), {});
  EXPECT_EQ(result.exit_code, 3);
  for (const Difference& difference : result.differences)
    EXPECT_NE(difference.change, Change::worse) << difference.what;
}

TEST(Gate, AReportIsNoSide) {
  const ResultFolder folder;
  fill(folder, [](Record&) {});
  folder.add_file("report.json", "{\"schema\": \"isoline.report/1\"}");
  EXPECT_THROW(compare_results(folder.path() / "report.json", folder.path(), {}), UsageError);
  EXPECT_THROW(compare_results(folder.path(), folder.path() / "report.json", {}), UsageError);
}

TEST(Gate, AllFormatsTellTheSame) {
  const GateResult result = compared([](Record& record) { record.summary.loss *= 1.05; });
  for (const std::string& text : {gate_terminal(result), gate_markdown(result)})
    for (const char* part : {"worse", "square × gd, seed 5", "loss", "+5 %"})
      EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/comparison.json");
  const Json json = parse_json(gate_json(result), "comparison");
  EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>());
  EXPECT_EQ(json["differences"][0]["figure"], "loss");
}

}  // namespace
}  // namespace isoline::reports
