// Optimizers and problems that misbehave, each in its own way after two good steps, and their
// cells, run into a folder of their own under limits that are soon reached.
#pragma once

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/process_group.h"
#include "benchmarks/run/runner.h"
#include "core/clock.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/deadline.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using optimizers::Linearization;
using optimizers::Meter;
using optimizers::stepper_entry;
using problems::Draw;
using problems::problem_entry;
using problems::ProblemParts;

// A number that a test shares with the cells it starts, whichever process writes it.
inline std::atomic<int>& told() {
  static auto* const number = new (mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE,
                                        MAP_SHARED | MAP_ANONYMOUS, -1, 0)) std::atomic<int>(0);
  return *number;
}

// A process that does this and ends.
inline pid_t forked(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child != 0) return child;
  work();
  _exit(0);
}

// How it ended, or that it was stopped.
inline int status_of(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, WUNTRACED), child);
  return status;
}

// The child of a child, in a session of its own, whose parent has ended: it tells its number, then
// holds whatever it inherited.
inline void leave_a_daemon_behind() {
  if (fork() != 0) {
    wait_until([] { return told() != 0; });
    return;
  }
  if (fork() != 0) _exit(0);
  setsid();
  prctl(PR_SET_PDEATHSIG, 0);
  told() = getpid();
  for (;;) pause();
}

// Children that fill so many MiB each, and stay.
inline void crowd(int children, int mebibytes) {
  for (int i = 0; i < children; ++i) {
    if (fork() != 0) continue;
    const std::size_t size = static_cast<std::size_t>(mebibytes) << 20;
    auto* const filled = new char[size];
    for (std::size_t at = 0; at < size; at += 4096) filled[at] = 1;
    told() += filled[size / 2];
    for (;;) pause();
  }
  while (true) pause();
}

// How many cells of this process have been here.
inline int& remembered() {
  static int cells = 0;
  return cells;
}

// Of processor time.
inline void burn(double seconds) {
  for (const double begin = processor_seconds(); processor_seconds() - begin < seconds;) {
  }
}

// Descends twice, then does `misdeed`.
struct Hostile {
  std::string misdeed = "throw";

  struct State {
    Linearization at;
    Vector gradient;
    int steps = 0;
    std::vector<std::unique_ptr<char[]>> hoard;
  };
  static void persist(State& s, Archive& archive) { archive(s.steps); }
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    constexpr int kGoodSteps = 2;
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    theta -= 1e-3 * s.gradient;
    if (++s.steps == kGoodSteps + 1) act_once(theta);
    if (s.steps > kGoodSteps) misbehave(theta, s);
    return Status::running;
  }

 private:
  // And goes on as if nothing had been.
  void act_once(Vector& theta) const {
    if (misdeed == "terminate") std::raise(SIGTERM);
    if (misdeed == "resize") theta = Vector::Constant(theta.size() + 1000, theta[0]);
    if (misdeed == "daemon") leave_a_daemon_behind();
    if (misdeed == "remember") theta[0] += 1e-3 * remembered()++;
    if (misdeed == "swell") told() = std::vector<char>(std::size_t{64} << 20, 1).back();
    if (misdeed == "toil") burn(0.3);
    if (misdeed == "stop-parent") kill(getppid(), SIGSTOP);
    if (misdeed == "end-parent") kill(getppid(), SIGTERM);
    if (misdeed == "chatter")
      for (int i = 0; i < 20000; ++i) std::printf("%s", "\x1b[31munexpected output\n");
  }
  void misbehave(Vector& theta, State& s) const {
    if (misdeed == "throw") throw std::runtime_error("thrown on purpose");
    if (misdeed == "throw-int") throw 7;
    if (misdeed == "segfault") std::raise(SIGSEGV);
    if (misdeed == "abort") std::abort();
    if (misdeed == "complain") {
      std::fprintf(stderr, "some line\nthe grid is too coarse\n");
      std::abort();
    }
    if (misdeed == "exit") std::_Exit(0);
    if (misdeed == "kill") std::raise(SIGKILL);
    if (misdeed == "nan") theta.setConstant(std::nan(""));
    if (misdeed == "count") ++told();
    if (misdeed == "overask") s.at.jacobian();
    if (misdeed == "crowd") crowd(3, 300);
    if (misdeed == "sleep") {
      told() = 1;
      for (;;) pause();
    }
    if (misdeed == "spin") {
      told() = 1;
      for (volatile bool go_on = true; go_on;) {
      }
    }
    if (misdeed == "linger") {
      told() = 1;
      usleep(20'000);
    }
    if (misdeed == "hoard")
      for (;;) {
        constexpr std::size_t kPiece = std::size_t{64} << 20;
        s.hoard.push_back(std::make_unique<char[]>(kPiece));  // value-initialized: really touched
      }
  }
};

inline void fields(Hostile& o, auto& field) {
  field("misdeed", o.misdeed,
        Choices{"throw",  "throw-int", "segfault",    "abort",      "complain",
                "exit",   "kill",      "nan",         "overask",    "crowd",
                "sleep",  "spin",      "hoard",       "terminate",  "resize",
                "daemon", "chatter",   "stop-parent", "end-parent", "linger",
                "count",  "remember",  "swell",       "toil",       "none"},
        "what it does after two good steps");
}

// A problem that cannot be made.
struct BrokenOptions {
  std::string misdeed = "hang";
};
inline void fields(BrokenOptions& o, auto& field) {
  field("misdeed", o.misdeed, Choices{"hang", "segfault", "exit", "end-parent"},
        "what its making does");
}
inline ProblemParts make_broken(const BrokenOptions& o, const Draw&) {
  if (o.misdeed == "segfault") std::raise(SIGSEGV);
  if (o.misdeed == "exit") std::exit(0);
  if (o.misdeed == "end-parent") {
    kill(getppid(), SIGTERM);
    throw std::runtime_error("not made");
  }
  for (volatile bool go_on = true; go_on;) {
  }
  return {};
}

inline Catalog hostile_catalog() {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(
      stepper_entry<Hostile>({.name = "hostile", .needs = {Oracle::forward, Oracle::pullback}}));
  catalog.problems.add(problem_entry({.name = "broken"}, make_broken));
  return catalog;
}

inline Request request_for(const Catalog& catalog, const std::string& problem,
                           const OptionValues& problem_options, const std::string& optimizer,
                           const OptionValues& options) {
  return named({.problem = complete_problem(catalog, problem, problem_options),
                .optimizer = complete_optimizer(catalog, optimizer, options),
                .budget = {.iterations = 50}});
}

// A process that has ended and is not yet reaped has no memory.
inline bool lives(pid_t process) {
  const auto figures = figures_of(process);
  return figures && figures->resident_bytes > 0;
}

// A worker that has done this, or was ended.
inline std::unique_ptr<Worker> ended_worker(const std::function<void(Trace&)>& work,
                                            const Limits& limits = {}) {
  auto worker = std::make_unique<Worker>();
  worker->start(work, limits, 1);
  wait_until([&] { return worker->poll(); });
  return worker;
}

class HostileCells : public testing::Test {
 protected:
  HostileCells() { told() = 0; }

  Request hostile(const std::string& misdeed, std::uint64_t seed = 0) const {
    Request request = request_for(catalog, "square", {}, "hostile", {{"misdeed", misdeed}});
    request.seed = seed;
    return named(std::move(request));
  }
  Record record_after(const std::string& misdeed) {
    const Request request = hostile(misdeed);
    ran = run_all(catalog, {request}, store, options);
    return record_of(request);
  }
  // In a process of its own, which a test may interrupt, or a cell stop.
  pid_t run_apart(const std::vector<Request>& requests) {
    return forked([&] { run_all(catalog, requests, store, options); });
  }
  // Also of a run that is to be run again.
  Record record_of(const Request& request) const {
    for (const std::string& name : names_in(folder.path() / "runs"))
      if (name.starts_with(request.cell) && name.ends_with(".json"))
        return read_record(folder.path() / "runs" / name);
    ADD_FAILURE() << request.optimizer.spec << " has no record";
    return {};
  }

  Catalog catalog = hostile_catalog();
  TemporaryFolder folder;
  Store store{folder.path()};
  RunOptions options{.limits = {.startup_seconds = 0.5,
                                .hard_seconds = 0.5,
                                .idle_seconds = 2,
                                .memory_bytes = std::int64_t{512} << 20}};
  Outcome ran;
};

}  // namespace isoline::benchmarks
