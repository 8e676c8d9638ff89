// What a repository keeps of results holds later results to the same standard as the records do.
#include "reports/compare/baseline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

using Changes = std::map<std::uint64_t, std::function<void(Record&)>>;  // by seed

// Eight cells on one problem with a minimum, four on one without, and one pair that makes no sense.
void fill(const ResultFolder& folder, const Changes& changes = {}) {
  for (std::uint64_t seed = 0; seed < 13; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20 + seed, .status = Status::budget});
    if (seed >= 8) {
      record.minimum.reset();
      record.hits.reset();
    }
    if (seed == 12) record.status = Status::inapplicable;
    if (const auto change = changes.find(seed); change != changes.end()) change->second(record);
    folder.add(record);
  }
}

Study study_with(const Changes& changes) {
  const ResultFolder folder;
  fill(folder, changes);
  return read_study({folder.path()});
}

GateResult held_to_baseline(const std::function<void(Record&)>& change,
                            const GateOptions& options = {}) {
  const ResultFolder before, after;
  fill(after, {{5, change}});
  before.add_file("baseline.json", baseline_json(study_with({})));
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
  const Changes moved = {{5, [](Record& record) { record.summary.loss *= 1.5; }},
                         {6, [](Record& record) { record.status = Status::diverged; }}};
  const std::string text = baseline_json(study_with({}), {study_with(moved)});
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/baseline.json");
  const Json json = parse_json(text, "baseline");
  EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>());
  EXPECT_EQ(json["cells"].size(), 13U);
  for (const Json& cell : json["cells"])
    EXPECT_NE(text.find("\n" + cell.dump()), std::string::npos) << cell.dump();
  EXPECT_EQ(json["perturbations"], 1);
  EXPECT_EQ(json["cells"][5]["perturbed"],
            (Json{{"moved", 0.5}, {"statuses", {"budget"}}, {"reached", {1, 1, 0}}}));
  EXPECT_EQ(json["cells"][6]["perturbed"]["moved"], "inf");
  EXPECT_FALSE(json["cells"][7].contains("perturbed")) << "nothing moved";
}

TEST(Baseline, StandsOnTheLeftOfAResultFolder) {
  const ResultFolder folder;
  fill(folder);
  const auto file = folder.path() / "baseline.json";
  folder.add_file("baseline.json", baseline_json(read_study({folder.path()})));
  EXPECT_THROW(compare_results(folder.path(), file, {}), UsageError);
  EXPECT_THROW(compare_results(file, file, {}), UsageError);
  EXPECT_THROW(baseline_from_json(Json{{"schema", kBaselineSchema}}), UsageError);
}

}  // namespace
}  // namespace isoline::reports
