// Rounding alone is not called worse, and a fault in a cell that hangs on rounding is still found.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "reports/compare/baseline.h"
#include "reports/compare/differences.h"
#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

constexpr Real kTolerance = 1e-6;  // of the gate of this repository
using Edit = std::function<void(Record&)>;

// Ten cells, all reaching 1e-1 and 1e-3 but not 1e-6; cell 5 is chaotic or what a test makes of it.
void fill(const ResultFolder& folder, const std::map<std::uint64_t, Edit>& changes) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20, .status = Status::budget});
    if (const auto change = changes.find(seed); change != changes.end()) change->second(record);
    folder.add(record);
  }
}

Study study_with(const std::map<std::uint64_t, Edit>& changes) {
  const ResultFolder folder;
  fill(folder, changes);
  return read_study({folder.path()});
}

void moves(Record& record) { record.summary.loss *= 1.02; }
void moves_more(Record& record) { record.summary.loss *= 0.9; }

Edit ends(Status status) {
  return [status](Record& record) { record.status = status; };
}

// Reaches the first `hits` of 51 targets.
Edit reaches(std::size_t hits) {
  return [hits](Record& record) {
    record.hits = record_of({.seed = record.request.seed, .hits = hits}).hits;
  };
}

// `changed` held to a baseline whose cell 5 did `once` and `twice` from perturbed starts.
GateResult compared(const std::map<std::uint64_t, Edit>& changed, const Edit& once = moves,
                    const Edit& twice = moves_more,
                    const GateOptions& options = {.tolerance = kTolerance}) {
  const ResultFolder before, after;
  fill(after, changed);
  before.add_file("baseline.json", baseline_json(study_with({}), {study_with({{5, once}}),
                                                                  study_with({{5, twice}})}));
  return compare_results(before.path() / "baseline.json", after.path(), options);
}

TEST(Chaos, WhatMovesWithTheLastBitIsJudgedByItsStatusAndCoarseTargets) {
  const GateResult result = compared({{5, [](Record& record) { record.summary.loss *= 1.3; }}});
  EXPECT_EQ(result.exit_code, 0) << gate_terminal(result);
  EXPECT_EQ(result.joined, 10U);
  EXPECT_EQ(result.equal, 9U);
  EXPECT_EQ(result.chaotic, 1U);
  EXPECT_NE(gate_terminal(result).find("1 chaotic"), std::string::npos) << gate_terminal(result);
}

TEST(Chaos, ACellThatHappensToAgreeIsEqual) {
  const GateResult result = compared({});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.equal, 10U);
  EXPECT_EQ(result.chaotic, 0U);
}

TEST(Chaos, AWorseStatusIsFound) {
  for (const Status status : {Status::diverged, Status::crashed, Status::failed}) {
    const GateResult result = compared({{5, ends(status)}});
    EXPECT_EQ(result.exit_code, 2) << name_of(status);
    EXPECT_EQ(result.differences.at(0).what, "status");
  }
  EXPECT_EQ(compared({{5, ends(Status::target)}}).exit_code, 3) << "and a better one is better";
}

TEST(Chaos, ALostTargetIsFoundAndAGainedOneIsBetter) {
  const GateResult lost = compared({{5, reaches(12)}});
  EXPECT_EQ(lost.exit_code, 2);
  ASSERT_EQ(lost.differences.size(), 1U);
  EXPECT_EQ(lost.differences[0].what, "target 1e-3");
  EXPECT_EQ(lost.differences[0].after, "missed");
  const GateResult gained = compared({{5, reaches(31)}});
  EXPECT_EQ(gained.exit_code, 3);
  ASSERT_EQ(gained.differences.size(), 1U);
  EXPECT_EQ(gained.differences[0].what, "target 1e-6");
}

TEST(Chaos, FivePercentInASteadyCellAreFoundBesideIt) {
  const GateResult result = compared({{4, [](Record& record) { record.summary.loss *= 1.05; }},
                                      {5, [](Record& record) { record.summary.loss *= 1.05; }}});
  EXPECT_EQ(result.exit_code, 2);
  ASSERT_EQ(result.differences.size(), 1U);
  EXPECT_TRUE(result.differences[0].title.ends_with("seed 4"));
  EXPECT_EQ(result.chaotic, 1U);
}

// Moves below the tolerance leave a cell as steady as it was.
TEST(Chaos, ACellThatMovesLessThanTheToleranceIsSteady) {
  const auto hardly = [](Record& record) { record.summary.loss *= 1 + 1e-8; };
  const auto change = [](Record& record) { record.summary.loss *= 1.05; };
  EXPECT_EQ(compared({{5, change}}, hardly, hardly).exit_code, 2);
  EXPECT_EQ(compared({{5, change}}, hardly, hardly, {.tolerance = 1e-9}).exit_code, 0);
}

// What moved by nearly the tolerance when its start was perturbed moves beyond it on another
// processor, which rounds in every operation.
TEST(Chaos, ACellThatMovesByATenthOfTheToleranceIsJudgedCoarselyToo) {
  const auto by = [](Real share) {
    return [share](Record& record) { record.summary.loss *= 1 + share; };
  };
  const auto elsewhere = by(3 * kTolerance);
  EXPECT_EQ(compared({{5, elsewhere}}, by(0.3 * kTolerance), by(0)).exit_code, 0);
  EXPECT_EQ(compared({{5, elsewhere}}, by(0.03 * kTolerance), by(0)).exit_code, 2);
}

// Of a problem whose user wants x, the coarse targets are those of x.
TEST(Chaos, TheCoarseTargetsAreThoseOfTheAim) {
  const auto found = [](std::size_t hits) {
    return [hits](Record& record) {
      const Record other = record_of({.seed = record.request.seed, .hits = hits});
      record.curve = other.curve;  // x to 1e-1 from 11 hits on, to 1e-3 from 31
      record.aim = Aim::x;
      record.x_scale = 1;
      record.summary.loss *= 1.02;
    };
  };
  const std::map<std::uint64_t, Edit> known = {{5, found(20)}};
  const auto verdict_on = [&](const Edit& edit) {
    const ResultFolder before, after;
    fill(after, {{5, edit}});
    before.add_file("baseline.json",
                    baseline_json(study_with(known), {study_with({{5, [&](Record& record) {
                                                                     found(20)(record);
                                                                     record.summary.loss *= 2;
                                                                   }}})}));
    return compare_results(before.path() / "baseline.json", after.path(),
                           {.tolerance = kTolerance});
  };
  const auto then = [&](std::size_t hits) {
    return [&, hits](Record& record) {
      found(hits)(record);
      record.summary.loss *= 1.5;
    };
  };
  EXPECT_EQ(verdict_on(then(20)).exit_code, kGood);
  EXPECT_EQ(verdict_on(then(9)).exit_code, kWorse);
  EXPECT_EQ(verdict_on(then(9)).differences.at(0).what, "target 1e-1");
  EXPECT_EQ(verdict_on(then(40)).exit_code, kBetterOnly);
}

TEST(Chaos, WhatSomePerturbedRunsDidIsNoDifference) {
  EXPECT_EQ(compared({{5, reaches(31)}}, reaches(31)).exit_code, 0) << "one of them got there";
  EXPECT_EQ(compared({{5, reaches(12)}}, reaches(12)).exit_code, 0) << "one of them did not";
  EXPECT_EQ(compared({{5, reaches(4)}}, reaches(12)).exit_code, 2) << "all of them reached 1e-1";
  EXPECT_EQ(compared({{5, ends(Status::diverged)}}, ends(Status::diverged)).exit_code, 0);
  EXPECT_EQ(compared({{5, ends(Status::failed)}}, ends(Status::diverged)).exit_code, 2);
  EXPECT_EQ(compared({{5, ends(Status::stalled)}}).exit_code, 0) << "changed, and no worse";
}

TEST(Chaos, WithoutAToleranceTheBitsDecide) {
  const GateResult result = compared({{5, moves}}, moves, moves_more, {});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.chaotic, 0U);
}

TEST(Chaos, MovementIsTheLeastToleranceThatLetsFiguresPass) {
  Subject before{.state = "budget", .quantities = {loss_quantity("loss", 0.5, 1)}};
  Subject after = before;
  EXPECT_EQ(movement(before, after), 0);
  after.quantities[0].value = 0.5 + 0x1p-52;  // rounding: above 1e-16 of the start by little
  EXPECT_LT(movement(before, after), 1e-15);
  after.quantities[0].value = 0.55;
  EXPECT_NEAR(movement(before, after), 0.1, 1e-12);
  EXPECT_TRUE(quantity_differences(before, after, movement(before, after)).empty());
  EXPECT_FALSE(quantity_differences(before, after, 0.99 * movement(before, after)).empty());
  after.quantities[0].value = kNever;
  EXPECT_EQ(movement(before, after), kNever);
  after = before;
  after.state = "diverged";
  EXPECT_EQ(movement(before, after), kNever);
}

}  // namespace
}  // namespace isoline::reports
