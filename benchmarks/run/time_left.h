// How long a run still takes, from what its cells were predicted to take and what they took.
#pragma once

#include <optional>

namespace isoline::benchmarks {

// Predictions are of whole budgets, which most cells do not use up: those that have ended say which
// share of a prediction a second of the run is worth. Cells are weighed by what they were
// predicted to take, so that cheap ones promise nothing for dear ones.
class TimeLeft {
 public:
  explicit TimeLeft(int jobs = 1) : jobs_(jobs) {}

  void expect(double predicted_seconds) { expected_ += predicted_seconds; }
  // `now`: seconds since the run began.
  void finish(double predicted_seconds, double now);
  // None before the first cell has ended, and without predictions; 0 where it takes longer than
  // predicted.
  std::optional<double> at(double now) const;

 private:
  int jobs_;
  double expected_ = 0, done_ = 0;  // predicted seconds
  double last_ = 0;                 // when the last of them ended
};

}  // namespace isoline::benchmarks
