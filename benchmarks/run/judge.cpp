// Verifiers. Requests are sent over a socket; the points are in shared memory.
#include "benchmarks/run/judge.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <utility>

#include "core/clock.h"
#include "core/foreign/evaluations.h"
#include "core/foreign/line.h"
#include "core/threads.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace {

// The tolerance for two evaluations of one point by one build, relative to `size`, the scale of
// such values.
bool agree(double a, double b, double size) {
  constexpr double kRelative = 1e-9, kOfSize = 1e-12;
  if (!std::isfinite(a) || !std::isfinite(b)) return std::isfinite(a) == std::isfinite(b);
  const double floor = std::isfinite(size) ? kOfSize * std::abs(size) : 0;
  return std::abs(a - b) <= kRelative * std::max(std::abs(a), std::abs(b)) + floor;
}

// --- the work of a verifier, in its own process

// Messages of the socket between a run and its judge.
struct PointToJudge {
  std::size_t slot;
  std::uint64_t seed;
  int threads;
  char folder[PATH_MAX];  // whose store of evaluations answers; may be empty
};

struct JudgesReply {
  std::size_t slot;
  bool is_judged, is_interrupted;
  Judged judged;
  std::int64_t afresh, afresh_failed;  // calls for the point
  char failure[Trace::kText];
};

// A new instance of a problem, and the meter that measures it as in a run.
struct Instance {
  explicit Instance(Problem made) : problem(std::move(made)), meter(problem, {}, {}, trace) {
    meter.leave_gradients_out();
    meter.begin(problem.start());
  }
  Judged judged(VectorRef theta) {
    require(theta.size() == problem.unknowns(), [&] {
      return fmt::format("it returned {} numbers instead of {}", theta.size(), problem.unknowns());
    });
    const Afresh afresh;
    meter.finish(theta, Status::budget);
    return told_by(trace);
  }

  Problem problem;
  Trace trace;
  Meter meter;
};
using Instances = std::map<std::uint64_t, std::unique_ptr<Instance>>;  // by seed

// An instance that failed may hold anything and is thrown away.
template <class Make>
JudgesReply reply_to(const PointToJudge& asked, const Worker& worker, Instances& instances,
                     const Make& make) {
  constexpr std::size_t kMost = 8;  // seeds come in turn, method by method
  JudgesReply reply{.slot = asked.slot};
  call_report() = {};
  try {
    set_library_threads(asked.threads);
    if (instances.size() >= kMost && !instances.contains(asked.seed)) instances.clear();
    auto& instance = instances[asked.seed];
    if (!instance) instance = std::make_unique<Instance>(make(asked.seed));
    reply.judged =
        instance->judged(Eigen::Map<const Vector>(worker.returned(), worker.returned_size()));
    reply.is_judged = true;
    reply.afresh = call_report().afresh;
    reply.afresh_failed = call_report().afresh_failed;
    return reply;
  } catch (const KilledProgram& error) {
    reply.is_interrupted = true;
    set_text(reply.failure, error.what());
  } catch (const std::exception& error) {
    set_text(reply.failure, error.what());
  } catch (...) {
    set_text(reply.failure, "it threw an object that is not a std::exception");
  }
  instances.erase(asked.seed);
  return reply;
}

// Answers requests from the socket about points that the workers returned, until it closes.
[[noreturn]] void judge_points(const Catalog& catalog, const Component& problem,
                               const std::vector<Worker>& workers, int socket) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);  // what a problem prints here
  if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 || dup2(nowhere, STDERR_FILENO) < 0) _exit(1);
  const auto make = [&](std::uint64_t seed) { return make_for_methods(catalog, problem, seed); };
  Instances instances;
  PointToJudge asked;
  while (recv(socket, &asked, sizeof asked, 0) == sizeof asked) {
    const Worker& worker = workers[asked.slot];
    evaluations().begin({.folder = asked.folder});
    JudgesReply reply = reply_to(asked, worker, instances, make);
    constexpr int kMostAgain = 2;  // a call may fail by chance
    for (int again = 0; again < kMostAgain; ++again) {
      const auto before = std::pair(reply.afresh, reply.afresh_failed);
      if (reply.is_judged && (before.first == 0 || before.second < before.first)) break;
      instances.erase(asked.seed);
      reply = reply_to(asked, worker, instances, make);
      reply.afresh += before.first;
      reply.afresh_failed += before.second;
    }
    if (send(socket, &reply, sizeof reply, MSG_NOSIGNAL) != sizeof reply) break;
  }
  _exit(0);
}

}  // namespace

Judged told_by(const Trace& trace) {
  return {trace.last.loss, trace.last.x_error, trace.minimum,
          trace.scale,     trace.x_scale,      trace.x_floor};
}

std::string contradiction(const Judged& told, const Judged& judged) {
  const struct {
    const char* name;
    double Judged::*number;
    double size;
  } numbers[] = {{"its loss", &Judged::loss, judged.scale},
                 {"its error in x", &Judged::x_error, judged.x_scale},
                 {"the least loss f_L", &Judged::minimum, judged.scale},
                 {"the scale of the loss", &Judged::scale, 0},
                 {"the scale of x", &Judged::x_scale, 0},
                 {"the floor of the error in x", &Judged::x_floor, judged.x_scale}};
  for (const auto& [name, number, size] : numbers)
    if (!agree(told.*number, judged.*number, size))
      return fmt::format(
          "{} is {:.6g} on a new instance of the problem, but was {:.6g} in the cell", name,
          judged.*number, told.*number);
  return "";
}

// --- verifiers, as a run sees them

Judges::~Judges() {
  for (Judge& judge : judges_) end(judge);
}

// Creating the problem again may take its startup time.
void Judges::ask(std::size_t slot, const Request& request, const Limits& limits,
                 const std::filesystem::path& folder) {
  Question question{slot, &request, limits, folder};
  question.limits.hard_seconds = std::max(limits.hard_seconds, limits.startup_seconds);
  try {
    send(judge_of(request.problem), question);
  } catch (const std::runtime_error& error) {
    verdicts_.push_back({slot, {}, error.what(), true});
  }
}

Judges::Judge& Judges::judge_of(const Component& problem) {
  const auto known = std::ranges::find(judges_, problem.spec, &Judge::problem);
  if (known != judges_.end()) {
    judges_.splice(judges_.begin(), judges_, known);
  } else {
    if (judges_.size() > workers_.size() && judges_.back().open.empty()) {
      end(judges_.back());  // the one used longest ago
      judges_.pop_back();
    }
    judges_.emplace_front(problem.spec);
  }
  if (!judges_.front().group.is_running()) start(judges_.front(), problem);
  return judges_.front();
}

void Judges::start(Judge& judge, const Component& problem) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(
        fmt::format("cannot create a socket for verification: {}", std::strerror(errno)));
  judge.socket = ends[0];
  try {
    judge.group.start([&] {
      close(ends[0]);
      judge_points(catalog_, problem, workers_, ends[1]);
    });
  } catch (...) {
    close(ends[1]);
    close(std::exchange(judge.socket, -1));
    throw;
  }
  close(ends[1]);
}

void Judges::send(Judge& judge, const Question& question) {
  const Request& request = *question.request;
  PointToJudge asked{question.slot, request.seed, request.threads, {}};
  if (question.folder.native().size() < sizeof asked.folder)
    question.folder.native().copy(asked.folder, sizeof asked.folder - 1);
  judge.open.push_back(question);
  if (judge.open.size() == 1) watch_first(judge);
  ::send(judge.socket, &asked, sizeof asked, MSG_NOSIGNAL);  // a dead judge is met when collected
}

void Judges::watch_first(Judge& judge) {
  if (judge.open.empty()) return;
  const Question& first = judge.open.front();
  judge.watch = LimitWatch(first.limits, first.request->threads, monotonic_nanoseconds());
}

// A judge holds nothing that could be lost.
int Judges::end(Judge& judge) {
  const ProcessGroup::End ended = judge.group.end();
  if (judge.socket >= 0) close(std::exchange(judge.socket, -1));
  return ended.wait_status;
}

// All its open requests go to a new verifier. A point that ended two verifiers, or that exceeded
// the limits, gets this as its answer.
void Judges::lose(Judge& judge, const std::string& reason) {
  const int status = end(judge);
  std::deque<Question> open = std::exchange(judge.open, {});
  if (open.front().is_asked_again || !reason.empty()) {
    const bool is_killed =
        reason.empty() && WIFSIGNALED(status) && is_from_outside(WTERMSIG(status));
    const std::string why = reason.empty() ? end_of_process(status) : reason;
    verdicts_.push_back({open.front().slot, {}, why, is_killed});
    open.pop_front();
  } else {
    open.front().is_asked_again = true;
  }
  if (open.empty()) return;  // the next question starts another one
  try {
    start(judge, open.front().request->problem);
    for (const Question& question : open) send(judge, question);
  } catch (const std::runtime_error& error) {
    for (const Question& question : open)
      verdicts_.push_back({question.slot, {}, error.what(), true});
  }
}

std::vector<Verdict> Judges::collect() {
  for (Judge& judge : judges_) {
    collect(judge);
    if (!judge.open.empty()) enforce(judge);
  }
  return std::exchange(verdicts_, {});
}

void Judges::enforce(Judge& judge) {
  const std::int64_t now = monotonic_nanoseconds();
  if (!judge.watch.is_due(now)) return;
  const Limits& limits = judge.watch.limits();
  const auto breach = judge.watch.check(judge.group.usage(limits.memory_bytes), true, now);
  if (!breach) return;
  lose(judge, breach->status == Status::memory
                  ? "it ran out of memory"
                  : fmt::format("it took more than {} s", limits.hard_seconds));
}

void Judges::collect(Judge& judge) {
  JudgesReply reply;
  while (!judge.open.empty()) {
    const ssize_t got = recv(judge.socket, &reply, sizeof reply, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got != sizeof reply || reply.slot != judge.open.front().slot) {
      lose(judge, "");
      continue;
    }
    judge.open.pop_front();
    watch_first(judge);
    reply.failure[Trace::kText - 1] = '\0';
    verdicts_.push_back({reply.slot, reply.is_judged ? std::optional(reply.judged) : std::nullopt,
                         reply.failure, reply.is_interrupted, reply.afresh, reply.afresh_failed});
  }
}

void Judges::add_to(std::vector<pollfd>& waiting) const {
  for (const Judge& judge : judges_)
    if (!judge.open.empty()) waiting.push_back({judge.socket, POLLIN, 0});
}

}  // namespace isoline::benchmarks
