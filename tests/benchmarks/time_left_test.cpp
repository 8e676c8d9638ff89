// How long a run still takes: what cells were predicted to take weighs them.
#include <gtest/gtest.h>

#include <vector>

#include "benchmarks/run/progress.h"

namespace isoline::benchmarks {
namespace {

constexpr double kShare = 0.25;  // of its prediction that a cell takes

// Cells in order, one at a time: what was told to be left after each.
std::vector<double> told(const std::vector<double>& predicted) {
  TimeLeft left;
  for (const double seconds : predicted) left.expect(seconds);
  std::vector<double> all;
  double now = 0;
  for (const double seconds : predicted) {
    now += kShare * seconds;
    left.finish(seconds, now);
    all.push_back(left.at(now).value_or(-1));
  }
  return all;
}

TEST(TimeLeft, NeverRisesWhenSlowCellsComeAfterFastOnes) {
  std::vector<double> cells(1000, 0.01);
  cells.insert(cells.end(), 10, 20);
  const std::vector<double> all = told(cells);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i], all[i - 1]) << i;
  EXPECT_GE(all[900], kShare * 200) << "the slow cells are known to come";
  EXPECT_EQ(all.back(), 0);
}

TEST(TimeLeft, IsRightWithinAFifthOnceTwoFifthsOfTheRunAreOver) {
  const std::vector<double> cells(100, 3);
  const std::vector<double> all = told(cells);
  for (std::size_t i = 40; i < all.size(); ++i) {
    const double real = kShare * 3 * static_cast<double>(cells.size() - i - 1);
    EXPECT_NEAR(all[i], real, 0.2 * real + 1e-9) << i;
  }
}

TEST(TimeLeft, CountsDownBetweenTwoEndsAndSaysZeroWhereItTakesLonger) {
  TimeLeft left;
  left.expect(10);
  left.expect(10);
  EXPECT_FALSE(left.at(0).has_value()) << "nothing has ended yet";
  left.finish(10, 5);
  const double then = left.at(5).value_or(0);
  EXPECT_NEAR(left.at(6).value_or(0), then - 1, 1e-12);
  EXPECT_EQ(left.at(1000).value_or(-1), 0);
}

TEST(TimeLeft, CountsCellsWithoutAPredictionAsTheMeanOfTheOthers) {
  TimeLeft left;
  for (const std::optional<double> predicted : {std::optional(1.0), std::optional(3.0)})
    left.expect(predicted);
  for (int i = 0; i < 2; ++i) left.expect({});
  left.finish(3, 6);  // twice as long as predicted, and so is the rest
  EXPECT_EQ(left.at(6).value_or(0), 2 * (1 + 2 + 2));
  TimeLeft unknown;
  for (int i = 0; i < 4; ++i) unknown.expect({});
  EXPECT_FALSE(unknown.at(1).has_value()) << "nothing has ended yet";
  unknown.finish({}, 5);
  EXPECT_EQ(unknown.at(5).value_or(0), 15);
  EXPECT_FALSE(TimeLeft().at(1).has_value()) << "nothing is expected";
}

}  // namespace
}  // namespace isoline::benchmarks
