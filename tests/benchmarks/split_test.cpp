// A plan in shards: the same division for whoever asks, of about the same times, by predictions
// that are written once.
#include "benchmarks/shard/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

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

std::vector<double> loads_of(const std::vector<std::size_t>& shards,
                             const std::vector<double>& weights, std::size_t count) {
  std::vector<double> loads(count);
  for (std::size_t i = 0; i < shards.size(); ++i) loads.at(shards[i]) += weights[i];
  return loads;
}

TEST(Split, GivesShardsOfTheSamePredictedTime) {
  for (const std::size_t count : {1, 3, 16, 64}) {
    const auto requests = requests_of(5000);
    const auto weights = times_of(5000);
    const auto loads = loads_of(split(requests, weights, count), weights, count);
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

TEST(Split, GivesEveryCellToOneShard) {
  const auto requests = requests_of(100);
  const auto shards = split(requests, std::vector<double>(100, 1), 8);
  std::map<std::string, int> seen;
  for (std::size_t index = 1; index <= 8; ++index)
    for (const Request& request : part_of(requests, shards, {index, 8})) ++seen[request.cell];
  ASSERT_EQ(seen.size(), 100U);
  for (const auto& [cell, times] : seen) EXPECT_EQ(times, 1) << cell;
}

TEST(Split, OfFewerCellsThanShardsLeavesSomeEmpty) {
  const auto shards = split(requests_of(2), {1, 1}, 5);
  EXPECT_NE(shards[0], shards[1]);
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
  Preview shown = preview_of(requests_of(0), 1);
  const auto few = requests_of(3), more = requests_of(5);
  shown = preview_of(few, 1);
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

}  // namespace
}  // namespace isoline::benchmarks
