// What a repository keeps of results holds later results to the same standard as the records do.
#include "reports/gate/baseline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "reports/gate/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Eight cells on one problem with a minimum, four on one without, and one pair that makes no sense.
void fill(const ResultFolder& folder, const std::function<void(Record&)>& change) {
  for (std::uint64_t seed = 0; seed < 13; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20 + seed, .status = Status::budget});
    if (seed >= 8) record.minimum.reset(), record.hits.reset();
    if (seed == 12) record.status = Status::inapplicable;
    if (seed == 5) change(record);
    folder.add(record);
  }
}

GateResult held_to_baseline(const std::function<void(Record&)>& change,
                            const GateOptions& options = {}) {
  const ResultFolder before, after;
  fill(before, [](Record&) {});
  fill(after, change);
  before.add_file("baseline.json", baseline_json(read_study({before.path()})));
  return compare_results(before.path() / "baseline.json", after.path(), options);
}

TEST(Baseline, FindsTheSameResultsEqual) {
  const GateResult result = held_to_baseline([](Record&) {});
  EXPECT_EQ(result.exit_code, 0) << gate_terminal(result);
  EXPECT_EQ(result.joined, 13U);
  EXPECT_EQ(result.equal, 13U);
}

TEST(Baseline, CatchesFivePercentOfQualityInOneCell) {
  for (const GateOptions& options : {GateOptions{}, GateOptions{.tolerance = 1e-3}}) {
    const GateResult loss =
        held_to_baseline([](Record& record) { record.summary.loss *= 1.05; }, options);
    EXPECT_EQ(loss.exit_code, 2);
    ASSERT_EQ(loss.differences.size(), 1U);
    EXPECT_EQ(loss.differences[0].what, "loss");
    EXPECT_NEAR(loss.differences[0].relative, 0.05, 1e-12);
    const GateResult work = held_to_baseline(
        [](Record& record) {
          for (std::int64_t& some : record.hits->work) some += some / 20;
        },
        options);
    EXPECT_EQ(work.exit_code, 2);
  }
  EXPECT_EQ(held_to_baseline([](Record& record) { record.status = Status::crashed; }).exit_code, 2);
}

TEST(Baseline, KeepsEveryDigit) {
  const auto nudge = [](Record& record) {
    record.summary.loss = std::nextafter(record.summary.loss, 1e9);
  };
  EXPECT_EQ(held_to_baseline(nudge).exit_code, 2);
  EXPECT_EQ(held_to_baseline(nudge, {.tolerance = 1e-12}).exit_code, 0);
}

TEST(Baseline, TellsAnotherPathFromTheSame) {
  const GateResult result =
      held_to_baseline([](Record& record) { record.curve.step_norm[2] *= 2; });
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_EQ(result.differences[0].what, "trace");
}

TEST(Baseline, IsALineACellAndKeepsToItsSchema) {
  const ResultFolder folder;
  fill(folder, [](Record&) {});
  const std::string text = baseline_json(read_study({folder.path()}));
  EXPECT_EQ(std::ranges::count(text, '\n'), 3 + 13 + 2);
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/baseline.json");
  EXPECT_EQ(schema_violations(parse_json(text, "baseline"), schema), std::vector<std::string>());
}

TEST(Baseline, StandsOnTheLeftOfAResultFolder) {
  const ResultFolder folder;
  fill(folder, [](Record&) {});
  const auto file = folder.path() / "baseline.json";
  folder.add_file("baseline.json", baseline_json(read_study({folder.path()})));
  EXPECT_THROW(compare_results(folder.path(), file, {}), UsageError);
  EXPECT_THROW(compare_results(file, file, {}), UsageError);
  EXPECT_THROW(baseline_from_json(Json{{"schema", kBaselineSchema}}), UsageError);
}

}  // namespace
}  // namespace isoline::reports
