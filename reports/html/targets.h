// What each of 51 targets τ = 10^(−j/5) took, over seeds: what the page's slider of tolerance
// reads.
#pragma once

#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

inline constexpr std::size_t kTargets = 51;

struct TargetMedians {
  std::vector<Real> work, seconds;   // of the targets whose median work is finite
  std::vector<std::size_t> reached;  // how many targets each run reached, by seed
};

// Exact from the hits of the records, otherwise read off their kept curves, as the tables are.
TargetMedians target_medians(const Comparison& comparison, const Cell& cell);

}  // namespace isoline::reports
