// The last steps and evaluations of a run: running means, and repetitions of one x.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/archive.h"
#include "core/array.h"
#include "core/failures.h"

namespace isoline::optimizers {

class RunningMean {
 public:
  static constexpr std::int64_t kMost = 256;

  void add(Real value) { values_[static_cast<std::size_t>(count_++ % kMost)] = value; }
  bool is_sound() const { return count_ >= 0; }  // what a file brought back need not be
  Real last() const { return count_ > 0 ? at(count_ - 1) : 0; }
  // Over the last `most` values, or all if there are fewer; NaN if there are none.
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

// Over the training batches of the last steps.
struct BatchMeans {
  RunningMean loss, x_error;
  bool has_this_step = false;  // among them

  bool is_sound() const { return loss.is_sound() && x_error.is_sound(); }
  void persist(Archive& archive) { archive(loss, x_error); }
};

// A method that asks for one x without end is stopped, and one whose evaluations all fail.
struct InARow {
  static constexpr int kMostRepeats = 1000;
  static constexpr const char* kOfOneX = "the method evaluated one x 1000 times in a row";

  Vector x;  // (n), the last one evaluated
  int repeats = 0;
  std::int64_t failed = 0, known = 0;  // of all failures, those before the last evaluation
  Vector origin;                       // (n), where the last step began in which none failed

  bool is_of_one_x() const { return repeats >= kMostRepeats; }
  void add(VectorRef theta) {
    const bool is_same = theta.size() == x.size() && theta == x;
    repeats = is_same ? repeats + 1 : 0;
    if (!is_same) x = theta;
  }
  void add_outcome(const FailedEvaluations& all);  // std::runtime_error where too many have failed
  void persist(Archive& archive) { archive(x, repeats, failed, known, origin); }
};

}  // namespace isoline::optimizers
