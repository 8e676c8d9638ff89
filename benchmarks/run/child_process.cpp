// Limits and leave of child processes.
#include "benchmarks/run/child_process.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

#include "benchmarks/run/processes.h"

namespace isoline::benchmarks {

void limit_memory([[maybe_unused]] std::int64_t bytes) {
#ifndef ISOLINE_SANITIZE  // the sanitizers' shadow memory does not fit under an address-space limit
  const auto figures = figures_of(getpid());
  const auto most = static_cast<rlim_t>(bytes + (figures ? figures->address_space_bytes : 0));
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(most, limit.rlim_max);  // the other one stays: a child may lift this
  setrlimit(RLIMIT_AS, &limit);
#endif
  std::set_new_handler([] { throw std::bad_alloc(); });
}

void leave() {
  std::fflush(stdout);
  _exit(0);
}

bool is_from_outside(int signal) {
  switch (signal) {
    case SIGKILL:
    case SIGTERM:
    case SIGINT:
    case SIGQUIT:
    case SIGHUP:
    case SIGXCPU:
    case SIGUSR1:
    case SIGUSR2:
      return true;
    default:
      return false;
  }
}

std::string signal_name(int signal) {
  return fmt::format("signal {} ({})", signal, strsignal(signal));
}

std::string end_of_answerer(int wait_status) {
  if (WIFSIGNALED(wait_status)) return "it was ended by " + signal_name(WTERMSIG(wait_status));
  const int code = WEXITSTATUS(wait_status);
  return code == 0 ? "it left without an answer" : fmt::format("it left with exit code {}", code);
}

}  // namespace isoline::benchmarks
