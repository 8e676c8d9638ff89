// Processor time of other processes, by the clock that each of them has.
#include "core/counted_process.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <vector>

namespace isoline {
namespace {

struct Counted {
  pid_t process;
  double seconds;  // at the last look: what has ended tells no more
};

struct Ledger {
  std::mutex mutex;
  std::vector<Counted> running;
  double ended_seconds = 0;
  // Who counts nobody pays nothing, and a fork of who counts does not count the same again.
  std::atomic<pid_t> owner = 0;
};

Ledger& ledger() {
  static Ledger only;
  return only;
}

void look(Counted& one) {
  clockid_t clock{};
  timespec now{};
  if (clock_getcpuclockid(one.process, &clock) == 0 && clock_gettime(clock, &now) == 0)
    one.seconds = std::max(
        one.seconds, static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec));
}

}  // namespace

CountedProcess::CountedProcess(pid_t process) : process_(process) {
  const std::lock_guard lock(ledger().mutex);
  if (ledger().owner != getpid()) {
    ledger().running.clear();
    ledger().ended_seconds = 0;
    ledger().owner = getpid();
  }
  ledger().running.push_back({process, 0});
}

CountedProcess::~CountedProcess() {
  const std::lock_guard lock(ledger().mutex);
  const auto mine = std::ranges::find(ledger().running, process_, &Counted::process);
  if (mine == ledger().running.end()) return;  // of a process that this one was forked from
  look(*mine);
  ledger().ended_seconds += mine->seconds;
  ledger().running.erase(mine);
}

double counted_processor_seconds() {
  if (ledger().owner == 0 || ledger().owner != getpid()) return 0;
  const std::lock_guard lock(ledger().mutex);
  double sum = ledger().ended_seconds;
  for (Counted& one : ledger().running) {
    look(one);
    sum += one.seconds;
  }
  return sum;
}

}  // namespace isoline
