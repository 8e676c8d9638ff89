// The stopwatch of a run: the processor's time-stamp counter if there is one, which is cheap enough
// for single evaluations, and the monotonic clock otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace isoline {

double seconds_per_tick();   // measured once, against the monotonic clock
double processor_seconds();  // of this process and the processes that compute for it
std::int64_t monotonic_nanoseconds();

inline std::uint64_t ticks() {  // inline: a call would cost as much as the reading
#if defined(__x86_64__)
  return __builtin_ia32_rdtsc();
#else
  return static_cast<std::uint64_t>(monotonic_nanoseconds());
#endif
}

// Runs while the method works, stands while the harness measures.
class Stopwatch {
 public:
  void resume();
  void pause();
  std::uint64_t elapsed() const { return is_running_ ? elapsed_ + ticks() - resumed_ : elapsed_; }
  double seconds() const;                                   // wall time so far
  double processor_seconds() const { return processor_; }   // up to the last pause
  void set(double wall_seconds, double processor_seconds);  // goes on from an earlier reading

 private:
  bool is_running_ = false;
  std::uint64_t resumed_ = 0, elapsed_ = 0;
  double resumed_processor_ = 0, processor_ = 0;
};

// Seconds since 1970 as records and component files contain them: "2026-01-31T12:00:00Z".
std::string instant_text(std::int64_t seconds);
std::optional<std::int64_t> instant_from(const std::string& text);  // none where it is no such text

std::int64_t seconds_now();

}  // namespace isoline
