// The θ that a cell returns, in memory shared with whoever judges it. Pages that are never written
// take no memory.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/array.h"

namespace isoline::benchmarks {

struct Returned {
  static constexpr std::int64_t kMost = std::int64_t{1} << 23;

  std::atomic<std::int64_t> size{0};  // 0: nothing was returned, or more than there is room for
  double theta[kMost];                // (n)

  void keep(VectorRef value) {
    if (value.size() > kMost) return;
    Eigen::Map<Vector>(theta, value.size()) = value;
    size = value.size();
  }
};

}  // namespace isoline::benchmarks
