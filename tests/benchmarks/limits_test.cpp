// When a cell is ended: what it used counts, what others used does not.
#include "benchmarks/run/run_plan.h"
#include "tests/benchmarks/hostile.h"

namespace isoline::benchmarks {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// Looks at a process so often a second, that uses so much of a core, until it is ended or so many
// seconds have gone; the message, or nothing.
std::string watched(LimitWatch watch, double share_of_core, double seconds, bool has_begun = true,
                    std::size_t processes = 1) {
  constexpr int kLooks = 10;
  for (int i = 1; i <= kLooks * seconds; ++i) {
    const auto breach =
        watch.check({.processes = processes, .processor_seconds = share_of_core * i / kLooks},
                    has_begun, i * kSecond / kLooks);
    if (breach) return breach->message;
  }
  return "";
}

bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

TEST(Limits, AreOfProcessorTimePerThreadSoThatABusyMachineKillsNoHealthyCell) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_EQ(watched(watch, 0.25, 200), "") << "it had 50 s of a core in 200";
  EXPECT_TRUE(names(watched(watch, 1, 61), "60 s of processor time"));
  EXPECT_TRUE(names(watched(watch, 0.15, 301), "300 s of wall time")) << "there is an end to it";
  EXPECT_EQ(watched(LimitWatch({}, 4, 0), 4, 59), "");
  EXPECT_TRUE(names(watched(watch, 4, 16), "60 s of processor time"));
  // They name the option that raises them.
  EXPECT_TRUE(names(watched(watch, 1, 61), "--time"));
  EXPECT_TRUE(names(watched(watch, 0.15, 301), "--time"));
  EXPECT_TRUE(names(watched(watch, 1, 31, false), "without an oracle call; a longer --time"));
  LimitWatch full({.memory_bytes = 1 << 20}, 1, 0);
  const auto breach = full.check({.processes = 1, .resident_bytes = 2 << 20}, true, kSecond);
  EXPECT_EQ(breach->status, Status::memory);
  EXPECT_TRUE(names(breach->message, "--memory"));
}

TEST(Limits, EndWhoIsIdleButNotWhoWaitsForAnotherProcess) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_TRUE(names(watched(watch, 0.005, 61), "less than 1 % of a core for 60 s"));
  EXPECT_EQ(watched(watch, 0.005, 61, true, 2), "");
  EXPECT_TRUE(names(watched(LimitWatch({.waits_for_others = false}, 1, 0), 0.005, 61, true, 2),
                    "less than 1 %"))
      << "what is examined waits for nobody";
  EXPECT_EQ(watched(watch, 0.02, 100), "");
  LimitWatch seldom({.idle_seconds = 1000}, 1, 0);
  for (int i = 1; i < 100; ++i)  // stopped for an hour between any two looks
    EXPECT_FALSE(
        seldom.check({.processes = 1, .processor_seconds = 0.5 * i}, true, i * 3600 * kSecond));
}

TEST(Limits, FollowTheBudgetTheSuiteAndThePrediction) {
  Request request;
  const Limits standard;
  EXPECT_EQ(limits_of(request, standard).hard_seconds, 60);
  EXPECT_EQ(limits_of(request, standard, 2).hard_seconds, 60);
  EXPECT_EQ(limits_of(request, standard, 20).hard_seconds, 200);
  request.hard_seconds = 7200;
  EXPECT_EQ(limits_of(request, standard, 2).hard_seconds, 7200);
  request.budget.seconds = 50;
  EXPECT_EQ(limits_of(request, standard, 2).hard_seconds, 100);
  EXPECT_EQ(limits_of(request, standard, 2).startup_seconds, 100) << "so that there is a way out";
}

// A cell of a problem whose forward solve takes long may take ten times as long as its work does.
TEST(Limits, OfACellGrowWithItsDeclaredWork) {
  const Catalog catalog = builtin_catalog();
  const TemporaryFolder folder;
  Store store(folder.path());
  const Request request = request_for(catalog, "square", {}, "gd", {});
  DeclaredTimes without(catalog, folder.path());
  EXPECT_EQ(without.of(request), 0);
  Sheet sheet{.kind = "problem",
              .name = "square",
              .spec = request.problem.spec,
              .options_text = "[]",
              .unknowns = 2};
  sheet.prices = MeasuredPrices{.forward_seconds = 2};
  store.write(sheet);
  DeclaredTimes with(catalog, folder.path());
  EXPECT_GE(with.of(request), 2 * 50) << "50 iterations, each a forward solve at least";
}

// Three seconds of wall time, of which it computes in none, as on a machine with much else to do.
TEST(Limits, LeaveWhoWaitsForAProcessorAlone) {
  const auto worker = ended_worker(
      [](Trace& trace) {
        trace.first_oracle_nanoseconds = 1;
        usleep(3'000'000);
        trace.status = Status::budget;
      },
      {.hard_seconds = 2});
  EXPECT_EQ(worker->trace().status, Status::budget) << worker->trace().message;
}

class Parents : public HostileCells {
 protected:
  Parents() { options.limits.hard_seconds = 30; }
};

TEST_F(Parents, AreNotEndedByACellAndGoOnWhenContinuedWhereTheyWereStopped) {
  for (const char* misdeed : {"stop-parent", "end-parent"}) {
    options.jobs = options.jobs == 1 ? 2 : 1;
    options.force = true;
    const std::vector<Request> requests = {hostile(misdeed),
                                           request_for(catalog, "square", {}, "gd", {})};
    const pid_t runner = run_apart(requests);
    int status = status_of(runner);
    if (misdeed == std::string("stop-parent")) {
      ASSERT_TRUE(WIFSTOPPED(status));
      usleep(300'000);
      kill(runner, SIGCONT);
      status = status_of(runner);
    }
    EXPECT_TRUE(WIFEXITED(status)) << misdeed;
    for (const Request& request : requests)
      EXPECT_EQ(record_of(request).status, Status::budget) << misdeed;
  }
}

TEST_F(Parents, AreNotEndedByAProblemThatAsksThemToWhileItsSheetIsMade) {
  const Request broken = request_for(catalog, "broken", {{"misdeed", "end-parent"}}, "gd", {});
  const int status = status_of(forked([&] {
    if (run_plan(catalog, "broken", {broken}, folder.path(), options).is_interrupted) _exit(1);
  }));
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(record_of(broken).status, Status::failed);
}

// --- What a cell starts is part of the cell: it counts, and it ends with it.

class Descendants : public HostileCells {
 protected:
  Descendants() {  // what runs that other tests killed left to this process is dead by now
    wait_until([] {
      while (waitpid(-1, nullptr, WNOHANG) > 0) {
      }
      return children_of(getpid()).empty();
    });
  }
  static void expect_good_end(const std::function<void(Trace&)>& work, const Limits& limits = {}) {
    const auto worker = ended_worker(work, limits);
    EXPECT_EQ(worker->trace().status, Status::budget) << worker->trace().message;
    EXPECT_TRUE(children_of(getpid()).empty());
  }
};

TEST_F(Descendants, ThatWentToASessionOfTheirOwnEndWithTheirCell) {
  options.limits.hard_seconds = 30;
  const Record record = record_after("daemon");
  EXPECT_EQ(record.status, Status::budget) << record.message;
  ASSERT_GT(told(), 0) << "no daemon was started";
  EXPECT_FALSE(lives(told()));
}

TEST_F(Descendants, OfAnotherCellAreLeftAlone) {
  Worker first, second;
  const auto spin = [](Trace& trace) {
    trace.first_oracle_nanoseconds = 1;
    leave_a_daemon_behind();
    for (;;) pause();
  };
  first.start(spin, {}, 1);
  wait_until([] { return told() != 0; });
  second.start([](Trace& trace) { trace.status = Status::budget; }, {}, 1);
  wait_until([&] { return second.poll(); });
  EXPECT_TRUE(lives(told())) << "it belongs to the first, which runs";
  first.interrupt();
  EXPECT_FALSE(lives(told()));
}

TEST_F(Descendants, CountForTheMemoryOfTheirCell) {
  options.limits.hard_seconds = 30;
  const Record record = record_after("crowd");  // three of 300 MiB, each below 512
  EXPECT_EQ(record.status, Status::memory) << record.message;
  EXPECT_TRUE(children_of(getpid()).empty());
}

// A page that many share is one page.
TEST_F(Descendants, DoNotCountWhatTheyShareTwice) {
  constexpr std::size_t kSize = std::size_t{200} << 20;
  expect_good_end(
      [](Trace& trace) {
        const std::vector<char> shared(kSize, 1);
        for (int i = 0; i < 3; ++i)
          if (fork() == 0)
            for (;;) pause();
        trace.first_oracle_nanoseconds = 1;
        trace.status = Status::budget;
        usleep(500'000);
      },
      {.memory_bytes = std::int64_t{512} << 20});
}

// Four processes in a row, each the child of the one before and in a session of its own.
TEST_F(Descendants, OfDescendantsEndToo) {
  expect_good_end([](Trace& trace) {
    for (int i = 0; i < 4; ++i) {
      if (fork() == 0) {
        setsid();
        ++told();
        continue;
      }
      if (i > 0)
        for (;;) pause();
      wait_until([] { return told() >= 4; });
      trace.status = Status::budget;
      return;
    }
    for (;;) pause();
  });
}

// A comet: every process starts the next in a session of its own, and ends.
TEST_F(Descendants, ThatNeverStandStillEndToo) {
  expect_good_end([](Trace& trace) {
    if (fork() == 0) {
      setsid();
      for (;;) {
        if (fork() != 0) _exit(0);
        setsid();
        ++told();
      }
    }
    wait_until([] { return told() >= 100; });
    trace.status = Status::budget;
  });
  const int last = told();
  usleep(100'000);
  EXPECT_EQ(told(), last) << "it flies on";
}

TEST_F(Descendants, SpendTheProcessorTimeOfTheirCell) {
  const auto worker = ended_worker(
      [](Trace& trace) {
        trace.first_oracle_nanoseconds = 1;
        if (fork() == 0)
          for (volatile bool go_on = true; go_on;) {
          }
        for (;;) pause();
      },
      {.hard_seconds = 0.3});
  EXPECT_EQ(worker->trace().status, Status::timeout) << worker->trace().message;
  EXPECT_TRUE(names(worker->trace().message, "processor time")) << worker->trace().message;
}

}  // namespace
}  // namespace isoline::benchmarks
