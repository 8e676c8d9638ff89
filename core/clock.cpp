// Clocks: monotonic, processor time, and the time-stamp counter with its calibration.
#include "core/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "core/shell.h"

namespace isoline {
namespace {

std::int64_t read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

double calibrate() {
  constexpr std::int64_t kSpan = 2'000'000;  // 2 ms: the clock's nanosecond is then 5e-7 of it
  const std::int64_t begin = monotonic_nanoseconds();
  const std::uint64_t first = ticks();
  while (monotonic_nanoseconds() - begin < kSpan) {
  }
  const std::uint64_t last = ticks();
  return 1e-9 * static_cast<double>(monotonic_nanoseconds() - begin) /
         static_cast<double>(last - first);
}

}  // namespace

std::int64_t monotonic_nanoseconds() { return read_clock(CLOCK_MONOTONIC); }

double seconds_per_tick() {
  static const double measured = calibrate();
  return measured;
}

// A reading is a system call, as long as an evaluation of a small problem. This thread is taken to
// run from one reading to the end of a short interval, unless it may have waited for a process that
// computes for it. A thread that loses the processor loses it for longer than that.
double processor_seconds() {
  constexpr double kShort = 1e-4;
  static thread_local double read = 0;
  static thread_local std::uint64_t read_at = 0;
  const std::uint64_t now = ticks();
  const double since = static_cast<double>(now - read_at) * seconds_per_tick();
  if (read_at != 0 && since < kShort && !counts_processes()) return read + since;
  read_at = now;
  return read = 1e-9 * static_cast<double>(read_clock(CLOCK_PROCESS_CPUTIME_ID)) +
                counted_processor_seconds();
}

void Stopwatch::resume() {
  resumed_processor_ = isoline::processor_seconds();
  resumed_ = ticks();
  is_running_ = true;
}

void Stopwatch::pause() {
  elapsed_ += ticks() - resumed_;
  processor_ += std::max(0.0, isoline::processor_seconds() - resumed_processor_);
  is_running_ = false;
}

void Stopwatch::set(double wall_seconds, double processor_seconds) {
  elapsed_ = static_cast<std::uint64_t>(wall_seconds / seconds_per_tick());
  processor_ = processor_seconds;
}

double Stopwatch::seconds() const { return static_cast<double>(elapsed()) * seconds_per_tick(); }

// Instants to text and back, whatever the time zone and the locale of the machine.

std::string instant_text(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm parts{};
  gmtime_r(&time, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
}

// A text in another form, or a 31st of February, is not valid: it would come back as another one.
std::optional<std::int64_t> instant_from(const std::string& text) {
  std::tm parts{};
  const char* end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  if (end == nullptr || end != text.data() + text.size()) return std::nullopt;
  const std::int64_t seconds = timegm(&parts);
  if (instant_text(seconds) != text) return std::nullopt;
  return seconds;
}

std::int64_t seconds_now() {
  return std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
}

}  // namespace isoline
