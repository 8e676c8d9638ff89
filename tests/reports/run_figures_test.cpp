// Figures of runs and the quantities made of them, against paths and curves worked out by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "core/results/statistics.h"
#include "reports/sections/claims.h"

namespace isoline::reports {
namespace {

// Two steps from (3, 4): to (3, 1), then to (1.5, −0.5). y is x, but for its last point.
Record path() {
  Record record;
  record.curve.iteration = {0, 1, 2};
  record.curve.loss = {10, 7, 6};
  record.curve.x_error = {5, 3, 1};
  record.curve.step_norm = {0, 3, 2};
  record.trajectory = Trajectory{.x = {{3, 4}, {3, 1}, {1.5, -0.5}}, .y = {{3, 4}, {3, 1}, {3, 4}}};
  return record;
}

Real figure(const std::string& column, std::optional<std::int64_t> iteration = {},
            std::vector<std::vector<Real>> table = {}) {
  return figure_of(path(),
                   {.column = column, .iteration = iteration, .seconds = {}, .table = table});
}

TEST(RunFigures, OfStepsAreThoseThatLedToTheIteration) {
  EXPECT_EQ(figure("step_norm", 1), 3);
  EXPECT_EQ(figure("step_2", 1), 3);
  EXPECT_EQ(figure("step_2", 2), 1.5);
  EXPECT_EQ(figure("relative_step_2", 1), 0.75);
  EXPECT_EQ(figure("loss_drop", 1), 3);
}

TEST(RunFigures, OfPathsGoUpToTheIteration) {
  EXPECT_EQ(figure("least_coordinate"), -0.5);
  EXPECT_EQ(figure("least_coordinate", 1), 1);
  EXPECT_EQ(figure("bend", 1), 0.75);
  EXPECT_EQ(figure("deviation", {}, {{3, 2}, {1, 0}}), 1);
  EXPECT_EQ(figure("mean_deviation", {}, {{3, 2}, {1, 0}}), 0.5);
  // From (3, 4) to (3, 1): straight down, and the way to the origin has a cosine of 4/5 with it.
  EXPECT_NEAR(figure("turn", 1), std::acos(0.8) * 180 / 3.14159265358979, 1e-9);  // rounding
}

// What claims must not be decided by: a run that made no step has none of these, and stays put.
TEST(RunFigures, OfWhatMadeNoStepAreAbsentOrThoseOfTheStart) {
  for (const char* column : {"step_2", "relative_step_2", "turn", "alignment", "slowdown"})
    EXPECT_TRUE(std::isnan(figure(column, 0))) << column;
  EXPECT_EQ(figure("bend", 0), 0);
  EXPECT_EQ(figure("loss_drop", 0), 0);
  EXPECT_EQ(figure("deviation", 0, {{3, 2}, {1, 0}}), 4);
}

// The error in x at every one of 90 iterations.
Record curve_of(Real (*error)(Real iteration)) {
  Record record;
  for (std::int64_t i = 0; i <= 90; ++i) {
    record.curve.iteration.push_back(i);
    record.curve.loss.push_back(1);
    record.curve.x_error.push_back(error(static_cast<Real>(i)));
  }
  return record;
}

Real slowdown_of(Real (*error)(Real iteration)) {
  return figure_of(curve_of(error),
                   {.column = "slowdown", .iteration = 90, .seconds = {}, .table = {}});
}

TEST(RunFigures, AnExponentialDoesNotSlowDownAndAHyperbolaDoes) {
  EXPECT_NEAR(slowdown_of([](Real i) { return std::exp(-i / 10); }), 1, 1e-9);  // rounding
  // ln 31 over the first third, ln (91/61) over the last.
  EXPECT_NEAR(slowdown_of([](Real i) { return 1 / (1 + i); }), std::log(31) / std::log(91. / 61),
              1e-9);
  EXPECT_EQ(slowdown_of([](Real i) { return i < 40 ? 50 - i : 10; }), kNever);
  EXPECT_TRUE(std::isnan(slowdown_of([](Real) { return 1.0; })));
}

TEST(Quantities, OfTwoHalvesAreMadeOfTheirRatios) {
  const std::vector<Real> at = {1, 10, 100, 1, 10, 100};
  EXPECT_NEAR(quantity_of("ratio_slope", {1, 10, 100, 1, 1, 1}, at), 1, 1e-12);  // rounding
  EXPECT_NEAR(quantity_of("ratio_slope", {1, 10, 100, 1, 10, 100}, at), 0, 1e-12);
  EXPECT_EQ(quantity_of("trend", {2, 3, 4, 1, 1, 1}, at), 1);
  EXPECT_EQ(quantity_of("trend", {2, 4, 3, 1, 1, 1}, at), 1.0 / 3);
  EXPECT_EQ(quantity_of("trend", {5, 5, 5, 5, 5, 5}, at), 0);
}

TEST(Quantities, AShareCountsSeedsOfTheAlternativeThatSpeaksForTheMethod) {
  const Term term{.figures = {{0, 1, 7, 0}, {7, 7, 7, 0}}, .at = 1};
  EXPECT_EQ(measure("share", {term}, "test").value, 0.5);
  Term worst = term;
  worst.is_worst = true;
  EXPECT_EQ(measure("share", {worst}, "test").value, 0.75);
}

TEST(Quantities, SignedOnesAreTiedAtZeroAndRatiosAtOne) {
  for (const char* kind : {"slope", "ratio_slope", "order", "trend"})
    EXPECT_EQ(neutral_of(kind), 0) << kind;
  EXPECT_EQ(neutral_of("ratio"), 1);
  for (const char* kind : {"value", "greatest", "share"})
    EXPECT_FALSE(neutral_of(kind).has_value()) << kind;
}

}  // namespace
}  // namespace isoline::reports
