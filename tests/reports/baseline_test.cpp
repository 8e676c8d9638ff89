// The baseline of a repository finds the same differences in later results as the records do;
// rounding alone is not called worse, and a fault in a cell that hangs on rounding is still found.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "tests/reports/gate_fixture.h"

namespace isoline::reports {
namespace {

// Eight cells on one problem with a minimum, four on one without, and one pair that makes no sense.
void fill_all(const ResultFolder& folder, Edits edits = {}) {
  for (std::uint64_t seed = 8; seed < 13; ++seed)
    edits[seed] = [seed](Record& record) {
      record.minimum.reset();
      record.hits.reset();
      if (seed == 12) record.status = Status::inapplicable;
    };
  fill(folder, edits, 13);
}

Study study_of_all(const Edits& edits = {}) {
  const ResultFolder folder;
  fill_all(folder, edits);
  return read_study({folder.path()});
}

GateResult held_to_baseline(const Edit& edit, const GateOptions& options = {}) {
  const TwoFolders two;
  fill_all(two.after, {{5, edit}});
  two.before.add_file("baseline.json", baseline_json(study_of_all()));
  return compare_results(two.before.path() / "baseline.json", two.after.path(), options);
}

TEST(Baseline, FindsTheSameResultsEqual) {
  const GateResult result = held_to_baseline(as_it_was);
  EXPECT_EQ(result.exit_code, 0) << gate_terminal(result);
  EXPECT_EQ(result.joined, 13U);
  EXPECT_EQ(result.equal, 13U);
}

TEST(Baseline, KeepsEveryDigit) {
  const auto nudge = [](Record& record) {
    end_at(record, std::nextafter(record.summary.loss, 1e9));
  };
  EXPECT_EQ(held_to_baseline(nudge).exit_code, 2);
  EXPECT_EQ(held_to_baseline(nudge, {.tolerance = 1e-12}).exit_code, 0);
  EXPECT_EQ(held_to_baseline(take_five_percent_more_work, {.tolerance = 1e-3}).exit_code, 2);
}

TEST(Baseline, TellsAnotherPathFromTheSame) {
  const GateResult result =
      held_to_baseline([](Record& record) { record.curve.step_norm[2] *= 2; });
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_EQ(result.differences[0].what, "trace");
}

TEST(Baseline, IsALineACellAndKeepsToItsSchema) {
  const Edits moved = {{5, loss_times(1.5)}, {6, ends_as(Status::diverged)}};
  const std::string text = baseline_json(study_of_all(), {study_of_all(moved)});
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
  fill_all(folder);
  const auto file = folder.path() / "baseline.json";
  folder.add_file("baseline.json", baseline_json(read_study({folder.path()})));
  EXPECT_THROW(compare_results(folder.path(), file, {}), UsageError);
  EXPECT_THROW(compare_results(file, file, {}), UsageError);
  EXPECT_THROW(baseline_from_json(Json{{"schema", kBaselineSchema}}, "base"), UsageError);
  folder.add_file("report.json", "{\"schema\": \"isoline.report/1\"}");
  EXPECT_THROW(compare_results(folder.path() / "report.json", folder.path(), {}), UsageError);
}

// Ten cells, all reaching 1e-1 and 1e-3 but not 1e-6; cell 5 is chaotic or what a test makes of it.
void fill_ten(const ResultFolder& folder, const Edits& edits) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20, .status = Status::budget});
    if (const auto edit = edits.find(seed); edit != edits.end()) edit->second(record);
    folder.add(record);
  }
}

Study study_of_ten(const Edits& edits) {
  const ResultFolder folder;
  fill_ten(folder, edits);
  return read_study({folder.path()});
}

const Edit moves = loss_times(1.02), moves_more = loss_times(0.9);

// Reaches the first `hits` of 51 targets.
Edit reaches(std::size_t hits) {
  return [hits](Record& record) {
    const Record other = record_of({.seed = record.request.seed, .hits = hits});
    record.hits = other.hits;
    record.curve = other.curve;
    record.summary = other.summary;
  };
}

// `changed` held to a baseline whose cell 5 did `once` and `twice` from perturbed starts.
GateResult compared_ten(const Edits& changed, const Edit& once = moves,
                        const Edit& twice = moves_more,
                        const GateOptions& options = {.tolerance = kTolerance}) {
  const TwoFolders two;
  fill_ten(two.after, changed);
  two.before.add_file(
      "baseline.json",
      baseline_json(study_of_ten({}), {study_of_ten({{5, once}}), study_of_ten({{5, twice}})}));
  return compare_results(two.before.path() / "baseline.json", two.after.path(), options);
}

// What moved by more than a tenth of the tolerance when its start was perturbed moves beyond it on
// another processor, which rounds in every operation: its status and coarse targets decide.
TEST(Chaos, CellsThatMoveWithTheLastBitAreJudgedByTheirStatusAndCoarseTargets) {
  const auto by = [](Real share) { return loss_times(1 + share * kTolerance); };
  const struct {
    const char* what;
    Edit now, once, twice;
    int exit_code;
    std::size_t equal, chaotic;
  } cases[] = {{"another loss", loss_times(1.3), moves, moves_more, kGood, 9, 1},
               {"the same loss", as_it_was, moves, moves_more, kGood, 10, 0},
               {"diverged", ends_as(Status::diverged), moves, moves_more, kWorse, 9, 1},
               {"failed", ends_as(Status::failed), moves, moves_more, kWorse, 9, 1},
               {"a better status", ends_as(Status::target), moves, moves_more, kBetterOnly, 9, 1},
               {"changed, and no worse", ends_as(Status::stalled), moves, moves_more, kGood, 9, 1},
               {"moved by less than a tenth", by(3), by(0.03), by(0), kWorse, 9, 0},
               {"moved by over a tenth", by(3), by(0.3), by(0), kGood, 9, 1},
               {"one of them got there", reaches(31), reaches(31), moves_more, kGood, 9, 1},
               {"one of them did not", reaches(12), reaches(12), moves_more, kGood, 9, 1},
               {"all of them reached 1e-1", reaches(4), reaches(12), moves_more, kWorse, 9, 1},
               {"one of them diverged", ends_as(Status::diverged), ends_as(Status::diverged),
                moves_more, kGood, 9, 1},
               {"failed where one diverged", ends_as(Status::failed), ends_as(Status::diverged),
                moves_more, kWorse, 9, 1}};
  for (const auto& each : cases) {
    const GateResult result = compared_ten({{5, each.now}}, each.once, each.twice);
    EXPECT_EQ(result.exit_code, each.exit_code) << each.what << "\n" << gate_terminal(result);
    EXPECT_EQ(result.equal, each.equal) << each.what;
    EXPECT_EQ(result.chaotic, each.chaotic) << each.what;
    if (each.chaotic > 0) {
      EXPECT_TRUE(has(gate_terminal(result), "1 chaotic")) << each.what;
    }
  }
  const GateResult exact = compared_ten({{5, moves}}, moves, moves_more, {});
  EXPECT_EQ(exact.exit_code, kWorse) << "without a tolerance the bits decide";
  EXPECT_EQ(exact.chaotic, 0U);
}

TEST(Chaos, ALostTargetIsFoundAndAGainedOneIsBetter) {
  const GateResult lost = compared_ten({{5, reaches(12)}});
  EXPECT_EQ(lost.exit_code, 2);
  ASSERT_EQ(lost.differences.size(), 1U);
  EXPECT_EQ(lost.differences[0].what, "target 1e-3");
  EXPECT_EQ(lost.differences[0].after, "missed");
  const GateResult gained = compared_ten({{5, reaches(31)}});
  EXPECT_EQ(gained.exit_code, 3);
  ASSERT_EQ(gained.differences.size(), 1U);
  EXPECT_EQ(gained.differences[0].what, "target 1e-6");
}

TEST(Chaos, FivePercentInASteadyCellAreFoundBesideIt) {
  const GateResult result = compared_ten({{4, loss_times(1.05)}, {5, loss_times(1.05)}});
  EXPECT_EQ(result.exit_code, 2);
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_TRUE(result.differences[0].title.ends_with("seed 4"));
  EXPECT_EQ(result.chaotic, 1U);
}

// Of a problem whose user wants x, the coarse targets are those of x.
TEST(Chaos, TheCoarseTargetsAreThoseOfTheAim) {
  const auto found = [](std::size_t hits) {
    return [hits](Record& record) {
      reaches(hits)(record);  // x to 1e-1 from 11 hits on, to 1e-3 from 31
      record.aim = Aim::x;
      record.x_scale = 1;
      loss_times(1.02)(record);
    };
  };
  const Edits known = {{5, found(20)}};
  const auto verdict_on = [&](const Edit& edit) {
    const Edit perturbed = [&](Record& record) {
      found(20)(record);
      loss_times(2)(record);
    };
    const TwoFolders two;
    fill_ten(two.after, {{5, edit}});
    two.before.add_file("baseline.json",
                        baseline_json(study_of_ten(known), {study_of_ten({{5, perturbed}})}));
    return compare_results(two.before.path() / "baseline.json", two.after.path(),
                           {.tolerance = kTolerance});
  };
  const auto then = [&](std::size_t hits) {
    return [&, hits](Record& record) {
      found(hits)(record);
      loss_times(1.5)(record);
    };
  };
  EXPECT_EQ(verdict_on(then(20)).exit_code, kGood);
  EXPECT_EQ(verdict_on(then(9)).exit_code, kWorse);
  EXPECT_EQ(verdict_on(then(9)).differences.at(0).what, "target 1e-1");
  EXPECT_EQ(verdict_on(then(40)).exit_code, kBetterOnly);
}

TEST(Chaos, MovementIsTheLeastToleranceThatLetsFiguresPass) {
  const auto component = std::make_shared<const Component>();
  ComparedCell before{.key = "",
                      .title = "",
                      .problem = component,
                      .optimizer = component,
                      .terms = "",
                      .status = Status::budget,
                      .build = "",
                      .parts = nullptr,
                      .figures = std::vector<Real>(kFigures, std::nan("")),
                      .scale = 1};
  before.figures[kLoss] = 0.5;
  ComparedCell after = before;
  EXPECT_EQ(movement(before, after), 0);
  after.figures[kLoss] = 0.5 + 0x1p-52;  // rounding: above 1e-16 of the start by little
  EXPECT_LT(movement(before, after), 1e-15);
  after.figures[kLoss] = 0.55;
  EXPECT_NEAR(movement(before, after), 0.1, 1e-12);
  EXPECT_TRUE(figure_differences(before, after, movement(before, after)).empty());
  EXPECT_FALSE(figure_differences(before, after, 0.99 * movement(before, after)).empty());
  after.figures[kLoss] = kNever;
  EXPECT_EQ(movement(before, after), kNever);
  after = before;
  after.status = Status::diverged;
  EXPECT_EQ(movement(before, after), kNever);
}

}  // namespace
}  // namespace isoline::reports
