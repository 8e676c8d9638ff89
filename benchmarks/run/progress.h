// What a person sees of long work: one live line on a terminal, a plain line every ten seconds in a
// pipe.
#pragma once

#include <cstdint>
#include <string>

#include "benchmarks/run/time_left.h"

namespace isoline::benchmarks {

class Progress {
 public:
  enum class Style { live, plain, silent };
  static Style style_of(int descriptor);  // live on a terminal

  // `already`: how many of `total` were done before; `jobs`: how many are done at a time.
  Progress(Style style, std::string what, std::int64_t total, std::int64_t already, int jobs = 1);
  ~Progress();

  void started(const std::string& name) { current_ = name; }
  // Of each that is to come, how long it may take; without it all count alike.
  void expect(double predicted_seconds) { time_left_.expect(predicted_seconds); }
  void finished(double predicted_seconds);
  void reached(std::int64_t done) { done_ = done; }
  void show(bool now = false);  // often called; prints seldom

 private:
  std::string line() const;
  std::string left_text(double elapsed, double rate) const;

  Style style_;
  std::string what_, current_;
  std::int64_t total_, already_, done_ = 0, begun_, shown_ = 0;
  TimeLeft time_left_;
  bool is_dirty_ = false;  // a live line stands on the terminal
};

std::string duration_text(double seconds);  // "1 h 05 min", "3 min 20 s", "12 s", "0.3 s"

}  // namespace isoline::benchmarks
