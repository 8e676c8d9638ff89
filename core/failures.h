// Evaluations that failed: of a simulator that broke off, that has no finite y, or where the
// feature fail= lets it fail. Plain data of fixed size, as a part of the trace of a run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/text.h"

namespace isoline {

struct FailedEvaluations {
  static constexpr int kMost = 1000, kNumbers = 8000, kReason = 256;
  std::int64_t total = 0, most_in_a_row = 0;  // 0: as the meter says
  int kept = 0, unknowns = 0;  // of the first ones; 0 unknowns: x has more numbers than fit
  double x[kNumbers];          // one after the other
  char reason[kMost][kReason];

  void add(std::span<const double> at, std::string_view why) {
    if (at.size() > kNumbers) at = {};
    const std::size_t room = kNumbers - static_cast<std::size_t>(kept * unknowns);
    ++total;
    const bool is_other = kept > 0 && std::ssize(at) != unknowns;
    if (kept == kMost || at.size() > room || is_other) return;
    unknowns = static_cast<int>(at.size());
    std::ranges::copy(at, x + std::ptrdiff_t{kept} * unknowns);
    const std::string_view text = cut(why, kReason - 1);
    reason[kept][text.copy(reason[kept], text.size())] = '\0';
    ++kept;  // last, since another process may end this one and read on
  }
  std::span<const double> point(int i) const {
    return {x + std::ptrdiff_t{i} * unknowns, static_cast<std::size_t>(unknowns)};
  }
};

// Where the problems of this process add theirs. A process runs one cell, which sets it.
inline FailedEvaluations*& failure_sink() {
  static FailedEvaluations* sink = nullptr;
  return sink;
}

class FailureSink {
 public:
  explicit FailureSink(FailedEvaluations& failures) { failure_sink() = &failures; }
  ~FailureSink() { failure_sink() = nullptr; }
  FailureSink(const FailureSink&) = delete;
  FailureSink& operator=(const FailureSink&) = delete;
};

inline void add_failure(std::span<const double> x, std::string_view why) {
  if (failure_sink() != nullptr) failure_sink()->add(x, why);
}

}  // namespace isoline
