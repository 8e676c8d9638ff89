// The progress of long work: one live line on a terminal, a plain line every ten seconds in a pipe.
#pragma once

#include <cstdint>
#include <string>

namespace isoline::benchmarks {

// It says how many cells have ended, but not how long the rest takes: where other programs share
// the machine, predictions from the times of earlier runs are wrong by a fifth and more.
class Progress {
 public:
  enum class Style { live, plain, silent };
  static Style style_of(int descriptor);  // live on a terminal

  // `already`: how many of `total` were done before.
  Progress(Style style, std::string what, std::int64_t total, std::int64_t already);
  ~Progress();

  void started(const std::string& name) { current_ = name; }
  void finished() { ++done_; }
  void reached(std::int64_t done) { done_ = done; }
  void show(bool now = false);  // often called; prints seldom

 private:
  std::string line() const;

  Style style_;
  std::string what_, current_;
  std::int64_t total_, already_, done_ = 0, begun_, shown_ = 0;
  bool is_dirty_ = false;  // a live line stands on the terminal
};

// "██████░░░░" of 0.6, ten columns; in colour, the done part is green.
std::string progress_bar(double part, std::size_t columns, bool has_colour);

std::string duration_text(double seconds);  // "1 h 05 min", "3 min 20 s", "12 s", "0.3 s"

}  // namespace isoline::benchmarks
