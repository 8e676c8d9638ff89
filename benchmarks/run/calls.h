// Calls of runs and checks to problems in other programs: their limits, the store that answers
// them, and what they remark.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/run/runner.h"
#include "core/foreign/evaluations.h"
#include "core/foreign/workers.h"

namespace isoline::benchmarks {

// The limit of isolated work with a problem: `seconds` where it is computed here. Where no
// call-time limits a call, the work ends when it has been idle for ten minutes; else it may be
// idle.
inline double text_seconds_of(const Component& problem, double seconds) {
  if (!is_elsewhere(problem)) return seconds;
  return problem.options.number("call-time", 0) > 0 ? 2 * kForeignSeconds : kForeignSeconds;
}

// In the process of such work: no call lasts for ever, where --time is given.
inline void limit_calls(const Request& request) {
  constexpr double kLeastSeconds = 60, kTimes = 10;
  if (request.budget.seconds > 0)
    call_seconds_otherwise() = std::max(kLeastSeconds, kTimes * request.budget.seconds);
}

// Where the evaluations of a run are kept, in the folder of its results. A run whose time counts
// makes its calls, and one that is to be repeated makes those that failed.
Evaluations::Settings evaluations_of(const RunOptions& options, const Request& request,
                                     const std::filesystem::path& folder);

// The lines of a process's output that a user should know.
std::vector<std::string> remarks_in(const std::string& output);

}  // namespace isoline::benchmarks
