// Verdicts on time, over simulated jobs whose noise is drawn from streams: no clock is read.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/results/times.h"

namespace isoline::results {
namespace {

constexpr std::size_t kPairs = 100;  // of jobs

// Noise as seen on shared machines: repetitions vary by some percent, one in ten is delayed by up
// to a quarter, and a whole job runs faster or slower than another, the more so a single cell of
// it.
struct Noise {
  Real repetition = 0.03, delayed = 0.1, job = 0.015, cell = 0.01;
};

std::vector<Real> repetitions(RandomStream& random, const Noise& noise, Real seconds) {
  seconds *= std::exp(noise.cell * random.normal());
  std::vector<Real> all;
  for (std::size_t i = 0; i < kLeastRepetitions; ++i) {
    const Real delay = random.uniform() < noise.delayed ? 0.25 * random.uniform() : 0;
    all.push_back(seconds * std::exp(noise.repetition * random.normal()) * (1 + delay));
  }
  return all;
}

// Two jobs of twenty cells; the first cell of the second takes `factor` times as long.
std::vector<TimedCell> two_jobs(std::uint64_t pair, const Noise& noise, Real factor) {
  RandomStream random(pair, "timing", "jobs");
  const Real before = std::exp(noise.job * random.normal());
  const Real after = std::exp(noise.job * random.normal());
  std::vector<TimedCell> cells;
  for (std::size_t i = 0; i < kMostTimed; ++i) {
    const Real seconds = std::pow(10.0, random.uniform(-4, 0));
    const std::string key = std::to_string(pair) + "/" + std::to_string(i);
    cells.push_back({.key = key,
                     .title = key,
                     .before = repetitions(random, noise, before * seconds),
                     .after = repetitions(random, noise, after * seconds * (i == 0 ? factor : 1))});
  }
  return cells;
}

struct Tally {
  std::size_t false_pairs = 0, found = 0;
};

Tally tally_of(const Noise& noise, Real factor) {
  Tally tally;
  for (std::uint64_t pair = 0; pair < kPairs; ++pair) {
    bool is_false = false;
    for (const TimeVerdict& verdict : judge_times(two_jobs(pair, noise, factor), kLeastNoise)) {
      const bool is_planted = factor != 1 && verdict.key.ends_with("/0");
      if (is_planted)
        tally.found += verdict.change == 1;
      else
        is_false = is_false || verdict.change != 0;
    }
    tally.false_pairs += is_false;
  }
  return tally;
}

TEST(Timing, AtMostFiveOfAHundredPairsOfEqualJobsAreCalledDifferent) {
  EXPECT_LE(tally_of({}, 1).false_pairs, 5U);
  EXPECT_LE(tally_of({.repetition = 0.1, .delayed = 0.2}, 1).false_pairs, 5U) << "a noisy machine";
  EXPECT_LE(tally_of({.repetition = 0.002, .delayed = 0}, 1).false_pairs, 5U) << "a quiet one";
}

TEST(Timing, ASlowdownOfThirtyPercentIsFoundInNinetyFiveOfAHundred) {
  const Tally usual = tally_of({}, 1.3);
  EXPECT_GE(usual.found, 95U);
  EXPECT_LE(usual.false_pairs, 5U);
  EXPECT_GE(tally_of({.repetition = 0.05}, 1.3).found, 95U);
}

TEST(Timing, ASpeedupIsFasterAndTheWorstComesFirst) {
  std::vector<TimedCell> cells = two_jobs(1, {.delayed = 0}, 1.5);
  for (Real& seconds : cells[1].after) seconds /= 2;
  const std::vector<TimeVerdict> verdicts = judge_times(cells, kLeastNoise);
  EXPECT_EQ(verdicts.front().key, "1/0");
  EXPECT_EQ(verdicts.front().change, 1);
  EXPECT_EQ(verdicts.back().key, "1/1");
  EXPECT_EQ(verdicts.back().change, -1);
}

// Halves of {1 … 1} agree; halves of a sample that spreads by a factor of ten do not.
TEST(Timing, NoiseIsWhatTheRepetitionsShow) {
  const std::vector<Real> still(9, 1.0), wild = {1, 2, 3, 4, 5, 6, 7, 8, 10};
  EXPECT_EQ(split_noise({{"a", "a", still, still}}), 0);
  EXPECT_GT(split_noise({{"a", "a", wild, wild}}), 0.3);
  EXPECT_EQ(split_noise({{"a", "a", {1}, {1}}}), kNever);
}

TEST(Timing, IsTheSameEachTime) {
  const std::vector<TimedCell> cells = two_jobs(3, {}, 1.1);
  const auto first = judge_times(cells, kLeastNoise), second = judge_times(cells, kLeastNoise);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].noise, second[i].noise);
}

// A rank that equals no other must end the search for its equals.
TEST(Timing, RanksOfWhatIsNotANumberEnd) {
  const std::vector<Real> with_nan = {0.1, std::nan(""), 0.2};
  EXPECT_EQ(mid_ranks(with_nan).size(), 3U);
  EXPECT_LE(mann_whitney_p(with_nan, {0.1, 0.3, 0.4}), 1);
}

}  // namespace
}  // namespace isoline::results
