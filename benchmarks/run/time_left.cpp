// The pace of what has ended, over what is to come.
#include "benchmarks/run/time_left.h"

#include <algorithm>

namespace isoline::benchmarks {

void TimeLeft::finish(double predicted_seconds, double now) {
  done_ += predicted_seconds;
  last_ = now;
}

// Between two ends it counts down. The first few cells say little of the pace: predictions count as
// much as a fiftieth of the run would.
std::optional<double> TimeLeft::at(double now) const {
  constexpr double kPrior = 0.02;
  if (done_ <= 0 || expected_ <= 0) return std::nullopt;
  const double prior = kPrior * expected_;
  const double pace = (last_ + prior / jobs_) / (done_ + prior);
  const double left = std::max(0.0, expected_ - done_) * pace;
  return std::max(0.0, left - (now - last_));
}

}  // namespace isoline::benchmarks
