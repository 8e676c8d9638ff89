// The progress of long work: one live line on a terminal, a plain line every ten seconds in a pipe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isoline::benchmarks {

// Cells are weighed by their predicted times, and finished cells correct the predictions of the
// rest. Where one has no prediction nothing is said: the slowest cells of a suite take as long as
// all others together.
class TimeLeft {
 public:
  void expect(std::optional<double> predicted_seconds);
  // `now`: seconds since the run began.
  void finish(std::optional<double> predicted_seconds, double now);
  // None before the first cell has ended; 0 where it takes longer than predicted.
  std::optional<double> at(double now) const;
  // Whether a tenth of the work is done, and the predicted end has moved by at most a fifth since
  // half of the time until now.
  bool is_steady() const;

 private:
  double expected_ = 0, done_ = 0;               // predicted seconds
  bool is_known_ = true;                         // all are predicted
  double last_ = 0;                              // when the last of them ended
  std::vector<std::pair<double, double>> ends_;  // when each ended, and the end predicted then
};

class Progress {
 public:
  enum class Style { live, plain, silent };
  static Style style_of(int descriptor);  // live on a terminal

  // `already`: how many of `total` were done before.
  Progress(Style style, std::string what, std::int64_t total, std::int64_t already);
  ~Progress();

  void started(const std::string& name) { current_ = name; }
  // The predicted time of each remaining item; without it all count equally.
  void expect(std::optional<double> predicted_seconds) { time_left_.expect(predicted_seconds); }
  void finished(std::optional<double> predicted_seconds);
  void reached(std::int64_t done) { done_ = done; }
  void show(bool now = false);  // often called; prints seldom

 private:
  std::string line() const;

  Style style_;
  std::string what_, current_;
  std::int64_t total_, already_, done_ = 0, begun_, shown_ = 0;
  TimeLeft time_left_;
  bool is_dirty_ = false;  // a live line stands on the terminal
};

// "██████░░░░" of 0.6, ten columns; in colour, the done part is green.
std::string progress_bar(double part, std::size_t columns, bool has_colour);

std::string duration_text(double seconds);  // "1 h 05 min", "3 min 20 s", "12 s", "0.3 s"

}  // namespace isoline::benchmarks
