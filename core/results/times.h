// Did the time of a cell change by more than it varies by itself?
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/real.h"
#include "core/results/tests.h"

namespace isoline::results {

inline constexpr std::size_t kLeastRepetitions = 9;  // of each side
inline constexpr std::size_t kMostTimed = 20;        // cells, of which each costs the others power
inline constexpr Real kFalseDiscoveries = 0.05;
// Repetitions within one job do not show how one job differs from the next, by frequency,
// neighbours and layout of memory: some percent on shared machines.
inline constexpr Real kLeastNoise = 0.1;

struct TimedCell {
  std::string key, title;
  std::vector<Real> before, after;  // seconds of each repetition
};

struct TimeVerdict {
  std::string key, title;
  std::size_t n_before = 0, n_after = 0;
  RatioEstimate ratio;       // after over before
  Real p = 1, adjusted = 1;  // Mann-Whitney; after Benjamini and Hochberg
  Real noise = kLeastNoise;  // [1 / (1 + noise), 1 + noise] is no change
  int change = 0;            // 1 slower, −1 faster, 0 neither
};

// Worst first. Slower or faster: the adjusted p is at most kFalseDiscoveries, and the whole
// interval of the ratio lies outside the band of noise.
std::vector<TimeVerdict> judge_times(const std::vector<TimedCell>& cells, Real least_noise);

// How far the estimate of a ratio strays where nothing has changed: the repetitions of each side of
// each cell are split into random halves, and 95 of 100 estimates between halves stay within
// 1 + noise. Halves have fewer repetitions than the sides, so their logarithm is scaled by the
// standard errors of both. One figure for all cells: nine repetitions tell little of their own
// noise, and the interval of a cell's ratio already widens with it.
Real split_noise(const std::vector<TimedCell>& cells);

}  // namespace isoline::results
