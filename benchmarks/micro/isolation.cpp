// What a process of its own costs each run, over a bare fork.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "benchmarks/micro/pairs.h"
#include "benchmarks/run/isolate.h"

namespace isoline::benchmarks::micro {
namespace {

Cost empty_run(Worker& worker) {
  return cost_of(1, [&] {
    worker.start([](Trace&) {}, {}, 1);
    while (!worker.poll()) {
      pollfd ended{worker.descriptor(), POLLIN, 0};
      ::poll(&ended, 1, -1);
    }
  });
}

Cost bare_fork() {
  return cost_of(1, [] {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    waitpid(child, nullptr, 0);
  });
}

}  // namespace

void register_isolation() {
  register_pair("isolation/empty-run", 301, {}, [] {
    const auto worker = std::make_shared<Worker>();
    return Pair{[=] { return empty_run(*worker); }, bare_fork};
  });
}

}  // namespace isoline::benchmarks::micro
