// What is half made is removed before a program ends that was asked to.
#pragma once

#include <array>
#include <csignal>

namespace isoline::benchmarks {

// While it lives, Ctrl-C and a polite kill raise a flag and do no more.
class EndingGuard {
 public:
  EndingGuard();
  ~EndingGuard();
  EndingGuard(const EndingGuard&) = delete;
  EndingGuard& operator=(const EndingGuard&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> old_{};
};

struct EndingAsked {};
void go_on();  // throws EndingAsked where the flag is up

}  // namespace isoline::benchmarks
