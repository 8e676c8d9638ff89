// Judges: what is asked of them goes by a socket, the points themselves lie in shared memory.
#include "benchmarks/run/judge.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>

#include "benchmarks/run/process_group.h"
#include "core/clock.h"
#include "core/threads.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace {

// As near as two evaluations of one point by one build can be told to be; `size` is what numbers of
// this kind are measured against.
bool agree(double a, double b, double size) {
  constexpr double kRelative = 1e-9, kOfSize = 1e-12;
  if (!std::isfinite(a) || !std::isfinite(b)) return std::isfinite(a) == std::isfinite(b);
  const double floor = std::isfinite(size) ? kOfSize * std::abs(size) : 0;
  return std::abs(a - b) <= kRelative * std::max(std::abs(a), std::abs(b)) + floor;
}

}  // namespace

Judged told_by(const Trace& trace) {
  return {trace.last.loss, trace.last.x_error, trace.minimum,
          trace.scale,     trace.x_scale,      trace.x_floor};
}

std::string contradiction(const Judged& told, const Judged& judged) {
  const struct {
    const char* name;
    double told, judged, size;
  } numbers[] = {{"its loss", told.loss, judged.loss, judged.scale},
                 {"its error in x", told.x_error, judged.x_error, judged.x_scale},
                 {"the least loss f_L", told.minimum, judged.minimum, judged.scale},
                 {"the scale of the loss", told.scale, judged.scale, 0},
                 {"the scale of x", told.x_scale, judged.x_scale, 0},
                 {"the floor of the error in x", told.x_floor, judged.x_floor, judged.x_scale}};
  for (const auto& one : numbers)
    if (!agree(one.told, one.judged, one.size))
      return fmt::format("{} is {:.6g} on a fresh problem, and was {:.6g} in its own process",
                         one.name, one.judged, one.told);
  return "";
}

Judges::Judges(const Catalog& catalog, const std::vector<Worker>& workers, double patience_seconds)
    : catalog_(catalog), workers_(workers), patience_seconds_(patience_seconds) {}

Judges::~Judges() {
  for (Judge& judge : judges_) end(judge);
}

void Judges::ask(std::size_t slot, const Request& request) {
  send(judge_of(request.problem), {slot, &request, monotonic_nanoseconds()});
}

Judges::Judge& Judges::judge_of(const Component& problem) {
  const auto known = std::ranges::find(judges_, problem.spec, &Judge::problem);
  if (known != judges_.end()) {
    judges_.splice(judges_.begin(), judges_, known);
    return judges_.front();
  }
  if (judges_.size() > workers_.size() && judges_.back().open.empty()) {
    end(judges_.back());  // the one that was not asked for longest
    judges_.pop_back();
  }
  start(judges_.emplace_front(problem.spec), problem);
  return judges_.front();
}

void Judges::start(Judge& judge, const Component& problem) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(fmt::format("no socket to a judge: {}", std::strerror(errno)));
  judge.group.start([&] {
    close(ends[0]);
    judge_points(catalog_, problem, workers_, ends[1]);
  });
  close(ends[1]);
  judge.socket = ends[0];
}

void Judges::send(Judge& judge, const Question& question) {
  const Request& request = *question.request;
  const PointToJudge asked{question.slot, request.seed, request.threads};
  judge.open.push_back(question);
  ::send(judge.socket, &asked, sizeof asked, MSG_NOSIGNAL);  // a dead judge is met when collected
}

// A judge holds nothing that could be lost.
std::string Judges::end(Judge& judge) {
  const ProcessGroup::End ended = judge.group.end();
  close(judge.socket);
  return end_of_process(ended.wait_status);
}

// All that it was asked goes to a new judge; but a point that two have died of, or that was waited
// for too long, is answered so.
void Judges::lose(Judge& judge, const std::string& reason, std::vector<Verdict>& verdicts) {
  const std::string ended = end(judge);
  std::deque<Question> open;
  open.swap(judge.open);
  start(judge, open.front().request->problem);
  if (open.front().is_asked_again || !reason.empty()) {
    verdicts.push_back({open.front().slot, {}, reason.empty() ? ended : reason});
    open.pop_front();
  } else {
    open.front().is_asked_again = true;
  }
  for (Question& question : open) {
    question.asked = monotonic_nanoseconds();
    send(judge, question);
  }
}

std::vector<Verdict> Judges::collect() {
  std::vector<Verdict> verdicts;
  for (Judge& judge : judges_) {
    collect(judge, verdicts);
    if (judge.open.empty()) continue;
    const std::int64_t waited = monotonic_nanoseconds() - judge.open.front().asked;
    if (1e-9 * static_cast<double>(waited) > patience_seconds_)
      lose(judge, fmt::format("it took more than {} s", patience_seconds_), verdicts);
  }
  return verdicts;
}

void Judges::collect(Judge& judge, std::vector<Verdict>& verdicts) {
  JudgesReply reply;
  while (!judge.open.empty()) {
    const ssize_t got = recv(judge.socket, &reply, sizeof reply, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got != sizeof reply || reply.slot != judge.open.front().slot) {
      lose(judge, "", verdicts);
      continue;
    }
    judge.open.pop_front();
    reply.failure[Trace::kText - 1] = '\0';
    verdicts.push_back(
        {reply.slot, reply.is_judged ? std::optional(reply.judged) : std::nullopt, reply.failure});
  }
}

void Judges::add_to(std::vector<pollfd>& waiting) const {
  for (const Judge& judge : judges_)
    if (!judge.open.empty()) waiting.push_back({judge.socket, POLLIN, 0});
}

// Problems made afresh, and points measured on them.

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
