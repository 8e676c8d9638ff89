// Whether two runs of one cell gave the same, bit for bit, timings aside; and where they part.
#pragma once

#include <cstdint>
#include <string>

#include "core/records/record.h"

namespace isoline::benchmarks {

// All that two runs of one build must agree on.
bool same_result(const Record& a, const Record& b);

struct Comparison {
  std::string difference;       // the first, "loss at iteration 17: 0.25 against 0.26"; empty: none
  std::int64_t iterations = 0;  // up to here
  bool is_up_to_there = false;  // a clock or a kill ended one of them: only so far
};

// The curve first, iteration by iteration, then all else that the request and not the build
// decides.
Comparison compare_results(const Record& a, const Record& b);

}  // namespace isoline::benchmarks
