// Differences of two subjects in status, figures and times, and of results that hang on the last
// bit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/compare/subject.h"
#include "reports/statistics/tests.h"

namespace isoline::reports {

enum class Change { worse, better, changed };

struct Difference {
  Change change = Change::changed;
  std::string key, title, problem, optimizer, what;
  std::string before, after;  // as shown
  Real relative = 0;          // (after − before) / |before|; infinite where that says nothing
  std::string note;
  std::string cause;         // why the two may differ
  bool is_rounding = false;  // so small that another order of summation explains it
};

Difference state_difference(const Subject& before, const Subject& after);

// The least tolerance within which the figures of the two agree; infinite where one is finite and
// the other is not, or where their status differs.
Real movement(const Subject& before, const Subject& after);

// The largest difference of each group of quantities and direction. Without a tolerance figures
// agree if they are the same number; with one if they differ by no more than rounding, 1e-16 of
// the problem's scale, and that share of the first, or of 1e-6 of the scale where that is more:
// what is smaller solves the problem to the strictest target of the tables.
std::vector<Difference> quantity_differences(const Subject& before, const Subject& after,
                                             const std::optional<Real>& tolerance);

// Results that hang on the last bit of their start: rounding, and so another processor or library,
// moves them as it likes. What of them can still be judged is how they end and what they reach.

// What the runs from perturbed starts did that are held to one from the given start.
Perturbed perturbed_of(const Subject& unperturbed, const std::vector<Subject>& perturbed);

// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const Subject& subject, const std::optional<Real>& tolerance);

// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
std::vector<Difference> coarse_differences(const Subject& before, const Subject& after);

// Did the time of a cell change by more than it varies by itself?

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

}  // namespace isoline::reports
