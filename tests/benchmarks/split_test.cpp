// A plan in shards: the same division for whoever asks, of about the same times, by predictions
// that are written once; and how long a run still takes, for which cells are weighed by them.
#include "benchmarks/shard/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "benchmarks/run/progress.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/random.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::vector<Request> requests_of(std::size_t count) {
  std::vector<Request> requests(count);
  for (std::size_t i = 0; i < count; ++i) requests[i].cell = digest(std::to_string(i));
  return requests;
}

// Times over four decades, as cells have them: 10^U(−2, 2) seconds.
std::vector<double> times_of(std::size_t count) {
  RandomStream random(1, "split", "test");
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(std::pow(10, 4 * random.uniform() - 2));
  return times;
}

TEST(Split, GivesShardsOfTheSamePredictedTime) {
  for (const std::size_t count : {1, 3, 16, 64}) {
    const auto weights = times_of(5000);
    const auto shards = split(requests_of(5000), weights, count);
    std::vector<double> loads(count);
    for (std::size_t i = 0; i < shards.size(); ++i) loads.at(shards[i]) += weights[i];
    const auto [least, most] = std::ranges::minmax(loads);
    EXPECT_LE(most, 1.2 * least) << count;
    EXPECT_NEAR(std::accumulate(loads.begin(), loads.end(), 0.0),
                std::accumulate(weights.begin(), weights.end(), 0.0), 1e-6);
  }
}

TEST(Split, DoesNotDependOnTheOrderOfThePlan) {
  const auto requests = requests_of(300);
  auto weights = times_of(300);
  for (std::size_t i = 0; i < 100; ++i) weights[i] = 1;  // equal ones too
  std::vector<Request> reversed(requests.rbegin(), requests.rend());
  const std::vector<double> weights_reversed(weights.rbegin(), weights.rend());
  const auto forth = split(requests, weights, 7), back = split(reversed, weights_reversed, 7);
  for (std::size_t i = 0; i < requests.size(); ++i)
    EXPECT_EQ(forth[i], back[requests.size() - 1 - i]) << i;
}

TEST(Split, GivesEveryCellToOneShardAndLeavesSomeEmptyOfFewerCells) {
  const auto requests = requests_of(100);
  const auto shards = split(requests, std::vector<double>(100, 1), 8);
  std::map<std::string, int> seen;
  for (std::size_t index = 1; index <= 8; ++index)
    for (const Request& request : part_of(requests, shards, {index, 8})) ++seen[request.cell];
  ASSERT_EQ(seen.size(), 100U);
  for (const auto& [cell, times] : seen) EXPECT_EQ(times, 1) << cell;
  const auto few = split(requests_of(2), {1, 1}, 5);
  EXPECT_NE(few[0], few[1]);
}

// --- which shard is asked for

Environment environment_of(const std::map<std::string, std::string>& variables) {
  return [variables](const char* name) {
    const auto at = variables.find(name);
    return at == variables.end() ? "" : at->second;
  };
}

TEST(Shard, IsReadAsAFractionAndAsTheTaskOfAnArray) {
  EXPECT_EQ(shard_of("3/16").text(), "3/16");
  EXPECT_EQ(shard_of("3/16").folder("out"), fs::path("out/shards/3-of-16"));
  const auto slurm = [](const char* id, const char* least, const char* count, const char* step) {
    return shard_of("auto", environment_of({{"SLURM_ARRAY_TASK_ID", id},
                                            {"SLURM_ARRAY_TASK_MIN", least},
                                            {"SLURM_ARRAY_TASK_COUNT", count},
                                            {"SLURM_ARRAY_TASK_STEP", step}}))
        .text();
  };
  EXPECT_EQ(slurm("3", "1", "16", ""), "3/16");
  EXPECT_EQ(slurm("0", "0", "4", "1"), "1/4");
  EXPECT_EQ(slurm("14", "10", "3", "2"), "3/3");
  EXPECT_THROW(slurm("13", "10", "3", "2"), UsageError);
  EXPECT_THROW(slurm("9", "1", "3", "1"), UsageError) << "an array with gaps";
  EXPECT_EQ(
      shard_of("auto", environment_of({{"ISOLINE_SHARD", "2/5"}, {"SLURM_ARRAY_TASK_ID", "1"}}))
          .text(),
      "2/5");
}

TEST(Shard, ThatDoesNotExistIsRefused) {
  for (const char* text : {"", "3", "0/4", "5/4", "a/4", "1/", "/4", "1/0", "-1/4", "1/1000000",
                           "1/4 ", "99999999999/99999999999"})
    EXPECT_THROW(shard_of(text), UsageError) << text;
  EXPECT_THROW(shard_of("auto", environment_of({})), UsageError);
  EXPECT_THROW(shard_of("auto", environment_of({{"ISOLINE_SHARD", "7/3"}})), UsageError);
}

// --- predictions

Preview preview_of(const std::vector<Request>& requests, double seconds) {
  Preview shown;
  for (const Request& request : requests)
    shown.cells.push_back({.request = &request, .seconds = seconds});
  return shown;
}

TEST(Predictions, AreWrittenOnceAndTakeThePlaceOfLaterOnes) {
  const TemporaryFolder folder;
  const auto requests = requests_of(4);
  Preview shown = preview_of(requests, 2.5);
  EXPECT_EQ(keep_predictions(folder.path(), shown), Weights::written);
  const std::string text = read_text(predicted_file(folder.path()));
  Preview later = preview_of(requests, 7);
  EXPECT_EQ(keep_predictions(folder.path(), later), Weights::kept);
  EXPECT_EQ(read_text(predicted_file(folder.path())), text);
  EXPECT_EQ(later.cells[0].seconds, 2.5);
  EXPECT_EQ(weights_of(requests, folder.path()), std::vector<double>(4, 2.5));
}

TEST(Predictions, OfAnotherPlanAreRefused) {
  const TemporaryFolder folder;
  const auto few = requests_of(3), more = requests_of(5);
  Preview shown = preview_of(few, 1);
  keep_predictions(folder.path(), shown);
  EXPECT_THROW(weights_of(more, folder.path()), UsageError);
  EXPECT_EQ(weights_of({few.begin(), few.begin() + 2}, folder.path()).size(), 2U);
  write_text(predicted_file(folder.path()), R"({"schema": "isoline.predicted/1", "cells": [7]})");
  EXPECT_THROW(weights_of(few, folder.path()), UsageError);
}

// Shards that were run without predictions were divided by declared work: they stay so.
TEST(Predictions, AreNotWrittenWhereShardsWereRunWithout) {
  const TemporaryFolder folder;
  fs::create_directories(Shard{1, 2}.folder(folder.path()) / "runs");
  auto requests = requests_of(2);
  requests[0].budget.iterations = 10;
  requests[1].budget.work = 7;
  Preview shown = preview_of(requests, 1);
  EXPECT_EQ(keep_predictions(folder.path(), shown), Weights::declared);
  EXPECT_FALSE(is_there(predicted_file(folder.path())));
  EXPECT_EQ(weights_of(requests, folder.path()), (std::vector<double>{30, 7}));
}

TEST(Predictions, KeepEveryBit) {
  const std::vector<PredictedCell> cells = {{digest("a"), 0.1}, {digest("b"), 1.0 / 3e5}};
  const std::string text = file_text(cells);
  const auto read = predicted_from_text(text, "it");
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(read[i].seconds, cells[i].seconds);
  EXPECT_TRUE(predicted_from_text(file_text({}), "it").empty());
}

// --- the time that is left

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
  const std::vector<double> all = told(std::vector<double>(100, 3));
  for (std::size_t i = 40; i < all.size(); ++i) {
    const double real = kShare * 3 * static_cast<double>(all.size() - i - 1);
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
  for (const std::optional<double> predicted :
       {std::optional(1.0), std::optional(3.0), std::optional<double>(), std::optional<double>()})
    left.expect(predicted);
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
