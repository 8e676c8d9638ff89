// Judges times: exact ranks, an interval of the ratio, and the noise that the repetitions show.
#include "core/results/times.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/digest.h"
#include "core/draws.h"

namespace isoline::results {
namespace {

// Fisher and Yates.
void shuffle(std::vector<Real>& values, Draws& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[static_cast<std::size_t>(random.uniform(0, Real(i)))]);
}

// The median of all differences right − left.
Real shift(const std::vector<Real>& left, const std::vector<Real>& right,
           std::vector<Real>& differences) {
  differences.clear();
  for (const Real a : left)
    for (const Real b : right) differences.push_back(b - a);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

TimeVerdict measured(const TimedCell& cell, Real noise) {
  return {.key = cell.key,
          .title = cell.title,
          .n_before = cell.before.size(),
          .n_after = cell.after.size(),
          .ratio = ratio_estimate(cell.before, cell.after),
          .p = mann_whitney_p(cell.before, cell.after),
          .noise = noise};
}

// Adds |shift| between the halves of many splits, times √(the sides' variance over the halves').
void add_shifts(const std::vector<Real>& seconds, Real sides, const std::string& key,
                std::vector<Real>& shifts) {
  constexpr std::size_t kSplits = 200;
  constexpr std::size_t kMostUsed = 40;  // repetitions a split: pairs grow by the square
  std::vector<Real> logs, differences;
  for (const Real value : seconds) logs.push_back(std::log(value));
  const std::size_t used = std::min(logs.size(), kMostUsed), half = used / 2;
  if (half == 0) return;
  const Real halves = 1 / Real(half) + 1 / Real(used - half);
  for (std::size_t split = 0; split < kSplits; ++split) {
    Draws random(fnv1a(key), "report", "halves", split);
    shuffle(logs, random);
    const auto middle = logs.begin() + static_cast<std::ptrdiff_t>(half);
    const auto end = logs.begin() + static_cast<std::ptrdiff_t>(used);
    shifts.push_back(std::abs(shift({logs.begin(), middle}, {middle, end}, differences)) *
                     std::sqrt(sides / halves));
  }
}

}  // namespace

Real split_noise(const std::vector<TimedCell>& cells) {
  constexpr Real kWithin = 0.95;
  std::vector<Real> shifts;
  for (const TimedCell& cell : cells) {
    const Real sides = 1 / Real(cell.before.size()) + 1 / Real(cell.after.size());
    add_shifts(cell.before, sides, cell.key, shifts);
    add_shifts(cell.after, sides, cell.key, shifts);
  }
  if (shifts.empty()) return kNever;
  const auto at = shifts.begin() + static_cast<std::ptrdiff_t>(kWithin * Real(shifts.size()));
  std::nth_element(shifts.begin(), at, shifts.end());
  return std::expm1(*at);
}

std::vector<TimeVerdict> judge_times(const std::vector<TimedCell>& cells, Real least_noise) {
  std::vector<TimeVerdict> verdicts;
  std::vector<Real> p;
  const Real noise = std::max(least_noise, split_noise(cells));
  for (const TimedCell& cell : cells) {
    verdicts.push_back(measured(cell, noise));
    p.push_back(verdicts.back().p);
  }
  const std::vector<Real> adjusted = benjamini_hochberg(p);
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    TimeVerdict& verdict = verdicts[i];
    verdict.adjusted = adjusted[i];
    if (verdict.adjusted > kFalseDiscoveries) continue;
    if (verdict.ratio.low > 1 + verdict.noise) verdict.change = 1;
    if (verdict.ratio.high < 1 / (1 + verdict.noise)) verdict.change = -1;
  }
  std::ranges::stable_sort(verdicts, [](const TimeVerdict& a, const TimeVerdict& b) {
    return std::pair(-a.change, -a.ratio.ratio) < std::pair(-b.change, -b.ratio.ratio);
  });
  return verdicts;
}

}  // namespace isoline::results
