// Problems made afresh, and points measured on them.
#include "benchmarks/run/chamber.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <map>
#include <memory>

#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

// One instance of a problem, made afresh, and the meter that measures on it as on any run.
struct Instance {
  explicit Instance(Problem made) : problem(std::move(made)), meter(problem, {}, {}, trace) {
    meter.begin(problem.start());
  }
  Judged judged(VectorRef theta) {
    require(theta.size() == problem.unknowns(), [&] {
      return fmt::format("it returned {} numbers, and the problem has {}", theta.size(),
                         problem.unknowns());
    });
    meter.finish(theta, Status::budget);
    return told_by(trace);
  }

  Problem problem;
  Trace trace;
  Meter meter;
};

// The work of a judge, in its own process, until nobody asks any more.
class Chamber {
 public:
  Chamber(const Catalog& catalog, const Component& problem, const std::vector<Worker>& workers)
      : catalog_(catalog), problem_(problem), workers_(workers) {}

  [[noreturn]] void serve(int socket) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);  // what a problem prints here
    if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 || dup2(nowhere, STDERR_FILENO) < 0)
      _exit(1);
    PointToJudge asked;
    while (recv(socket, &asked, sizeof asked, 0) == sizeof asked) {
      const JudgesReply reply = reply_to(asked);
      if (send(socket, &reply, sizeof reply, MSG_NOSIGNAL) != sizeof reply) break;
    }
    _exit(0);
  }

 private:
  JudgesReply reply_to(const PointToJudge& asked) {
    JudgesReply reply{.slot = asked.slot};
    try {
      set_library_threads(asked.threads);
      const Worker& worker = workers_[asked.slot];
      reply.judged =
          instance(asked.seed)
              .judged(Eigen::Map<const Vector>(worker.returned(), worker.returned_size()));
      reply.is_judged = true;
    } catch (const std::exception& error) {
      set_text(reply.failure, error.what());
    } catch (...) {
      set_text(reply.failure, "it threw something that is no std::exception");
    }
    return reply;
  }

  // Seeds come in turn, method by method: some instances are kept.
  Instance& instance(std::uint64_t seed) {
    constexpr std::size_t kMost = 8;
    if (const auto found = instances_.find(seed); found != instances_.end()) return *found->second;
    if (instances_.size() >= kMost) instances_.clear();
    return *(instances_[seed] = std::make_unique<Instance>(make_problem(catalog_, problem_, seed)));
  }

  const Catalog& catalog_;
  const Component& problem_;
  const std::vector<Worker>& workers_;
  std::map<std::uint64_t, std::unique_ptr<Instance>> instances_;
};

}  // namespace

void judge_points(const Catalog& catalog, const Component& problem,
                  const std::vector<Worker>& workers, int socket) {
  Chamber(catalog, problem, workers).serve(socket);
}

}  // namespace isoline::benchmarks
