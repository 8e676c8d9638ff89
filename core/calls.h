// Counts of the calls to problems in other programs, in this process.
#pragma once

#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "core/text.h"

namespace isoline {

struct CallReport {
  std::int64_t made = 0, answered = 0;         // by the program; from the store of evaluations
  std::int64_t afresh = 0, afresh_failed = 0;  // made again to compare with known answers
};

// Where this process counts: its own, or that in the trace of the cell that it runs.
inline CallReport*& call_sink() {
  static CallReport own;
  static CallReport* sink = &own;
  return sink;
}
inline CallReport& call_report() { return *call_sink(); }

class CallSink {
 public:
  explicit CallSink(CallReport& report) : before_(std::exchange(call_sink(), &report)) {}
  ~CallSink() { call_sink() = before_; }
  CallSink(const CallSink&) = delete;
  CallSink& operator=(const CallSink&) = delete;

 private:
  CallReport* before_;
};

// A sentence for the user, each once in a process. The line goes to the output of a cell, from
// where the process that runs the cells passes it on.
inline constexpr std::string_view kRemark = "isoline: ";
inline void remark_on_calls(const std::string& sentence) {
  static std::set<std::string> before;
  if (before.insert(sentence).second) say(stderr, std::string(kRemark) + sentence + "\n");
}

}  // namespace isoline
