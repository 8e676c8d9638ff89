// Signals of one thread that wait.
#pragma once

#include <csignal>

namespace isoline {

// They wait while it lives; threads that are started then never see one.
class WithoutSignals {
 public:
  explicit WithoutSignals(const sigset_t& held) { pthread_sigmask(SIG_BLOCK, &held, &before_); }
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  sigset_t before_;
};

inline sigset_t all_signals() {
  sigset_t all;
  sigfillset(&all);
  return all;
}

}  // namespace isoline
