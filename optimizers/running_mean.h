// The mean over the last few values of a sequence.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/array.h"

namespace isoline::optimizers {

class RunningMean {
 public:
  static constexpr std::int64_t kMost = 256;

  void add(Real value) { values_[static_cast<std::size_t>(count_++ % kMost)] = value; }
  bool is_sound() const { return count_ >= 0; }  // what a file brought back need not be
  Real last() const { return count_ > 0 ? at(count_ - 1) : 0; }
  // Over the last `most` values, or as many as there are; nan where there is none.
  Real mean(std::int64_t most) const {
    const std::int64_t taken = std::min(most, count_);
    Real sum = 0;
    for (std::int64_t i = count_ - taken; i < count_; ++i) sum += at(i);
    return taken > 0 ? sum / static_cast<Real>(taken) : std::numeric_limits<Real>::quiet_NaN();
  }

 private:
  Real at(std::int64_t i) const { return values_[static_cast<std::size_t>(i % kMost)]; }

  std::array<Real, kMost> values_{};
  std::int64_t count_ = 0;
};

}  // namespace isoline::optimizers
