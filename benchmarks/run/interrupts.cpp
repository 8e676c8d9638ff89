// Handlers call only safe functions: a flag, a table of numbers and plain system calls.
#include "benchmarks/run/interrupts.h"

#include <unistd.h>

#include "benchmarks/run/process_group.h"
#include "core/status.h"

namespace isoline::benchmarks {
namespace {

constexpr std::sig_atomic_t kFinish = 1, kStop = 2;

volatile std::sig_atomic_t heard = 0;
bool is_guarded = false;

void hear(int signal, siginfo_t* sent, void*) {
  if (sent->si_code <= 0 && is_of_a_group(sent->si_pid))
    return;  // from a process of one of our groups
  if (heard == kStop) {
    signal_all_groups(SIGKILL);
    _exit(kInterrupted);
  }
  heard = signal == SIGINT && heard < kFinish ? kFinish : kStop;
}

void stop_with_cells(int) {
  signal_all_groups(SIGSTOP);
  raise(SIGSTOP);
  signal_all_groups(SIGCONT);
}

// An ignored signal stays ignored: nohup and background shells set this.
void handle(int signal, const struct sigaction& action, struct sigaction& old) {
  sigaction(signal, nullptr, &old);
  if (old.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() : is_outermost_(!is_guarded) {
  if (!is_outermost_) return;
  is_guarded = true;
  heard = 0;
  struct sigaction hearing {};
  hearing.sa_sigaction = hear;
  hearing.sa_flags = SA_SIGINFO;
  handle(SIGINT, hearing, old_int_);
  handle(SIGTERM, hearing, old_term_);
  handle(SIGHUP, hearing, old_hup_);
  struct sigaction stopping {};
  stopping.sa_handler = stop_with_cells;
  stopping.sa_flags = SA_RESTART;
  handle(SIGTSTP, stopping, old_stop_);
}

InterruptGuard::~InterruptGuard() {
  if (!is_outermost_) return;
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
  sigaction(SIGHUP, &old_hup_, nullptr);
  sigaction(SIGTSTP, &old_stop_, nullptr);
  is_guarded = false;
  heard = 0;
}

Asked asked_to_end() {
  if (heard == kStop) return Asked::stop;
  return heard == kFinish ? Asked::finish : Asked::nothing;
}

}  // namespace isoline::benchmarks
