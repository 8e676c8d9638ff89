// Evaluations that failed in this process: of a simulator that broke off, or in a region where the
// feature fail= lets them fail. A process runs one cell, whose record states them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/array.h"

namespace isoline {

struct FailedEvaluations {
  static constexpr std::size_t kMost = 1000;  // that are listed
  std::int64_t total = 0;
  std::vector<Vector> x = {};
  std::vector<std::string> reasons = {};  // one for each x

  void add(VectorRef at, std::string reason) {
    ++total;
    if (reasons.size() == kMost) return;
    x.emplace_back(at);
    reasons.push_back(std::move(reason));
  }
};

inline FailedEvaluations& failed_evaluations() {
  static FailedEvaluations all;
  return all;
}

}  // namespace isoline
