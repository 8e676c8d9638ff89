// Evaluations that failed in this process: of a simulator that broke off, or in a region where the
// feature fail= lets them fail. A process runs one cell, whose record states their number and the
// first.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "core/array.h"

namespace isoline {

struct FailedEvaluations {
  std::int64_t total = 0;
  Vector first_x = {};
  std::string first_reason = {};

  void add(VectorRef at, std::string reason) {
    if (total++ > 0) return;
    first_x = at;
    first_reason = std::move(reason);
  }
};

inline FailedEvaluations& failed_evaluations() {
  static FailedEvaluations all;
  return all;
}

}  // namespace isoline
