// Counts of the calls to problems in other programs, in this process.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "core/text.h"

namespace isoline {

struct CallReport {
  std::int64_t made = 0, answered = 0;         // by the program; from the store of evaluations
  std::int64_t afresh = 0, afresh_failed = 0;  // made again to compare with known answers
};

inline CallReport& call_report() {
  static CallReport report;
  return report;
}

// A sentence for the user, once in a process. The line goes to the output of a cell, from
// where the process that runs the cells passes it on.
inline constexpr std::string_view kRemark = "isoline: ";
inline void remark_on_calls(const std::string& sentence) {
  static std::string before;
  if (before.empty()) say(stderr, std::string(kRemark) + sentence + "\n");
  before = sentence;
}

}  // namespace isoline
