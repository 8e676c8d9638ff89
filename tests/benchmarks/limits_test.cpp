// When a cell is ended: what it used counts, what others used does not.
#include "benchmarks/run/limits.h"

#include <sys/wait.h>

#include "tests/benchmarks/hostile_cells.h"
#include "tests/deadline.h"

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

TEST(Limits, AreOfProcessorTimeSoThatABusyMachineKillsNoHealthyCell) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_EQ(watched(watch, 0.25, 200), "") << "it had 50 s of a core in 200";
  EXPECT_TRUE(names(watched(watch, 1, 61), "60 s of processor time"));
  EXPECT_TRUE(names(watched(watch, 0.15, 301), "300 s of wall time")) << "there is an end to it";
}

TEST(Limits, AreDividedByTheThreadsThatWereAskedFor) {
  EXPECT_EQ(watched(LimitWatch({}, 4, 0), 4, 59), "");
  EXPECT_TRUE(names(watched(LimitWatch({}, 1, 0), 4, 16), "60 s of processor time"));
}

TEST(Limits, NameTheOptionThatRaisesThem) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_TRUE(names(watched(watch, 1, 61), "--time"));
  EXPECT_TRUE(names(watched(watch, 0.15, 301), "--time"));
  EXPECT_TRUE(names(watched(watch, 1, 31, false), "no oracle call; a longer --time"));
  LimitWatch full({.memory_bytes = 1 << 20}, 1, 0);
  const auto breach = full.check({.processes = 1, .resident_bytes = 2 << 20}, true, kSecond);
  EXPECT_EQ(breach->status, Status::memory);
  EXPECT_TRUE(names(breach->message, "--memory"));
}

TEST(Limits, EndWhoIsIdleButNotWhoWaitsForAnotherProcess) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_TRUE(names(watched(watch, 0.005, 61), "less than 1 % of a core for 60 s"));
  EXPECT_EQ(watched(watch, 0.005, 61, true, 2), "");
  EXPECT_EQ(watched(watch, 0.02, 100), "");
}

TEST(Limits, DoNotCountTheTimeInWhichNobodyLooked) {
  LimitWatch watch({.idle_seconds = 1000}, 1, 0);
  for (int i = 1; i < 100; ++i)  // stopped for an hour between any two looks
    EXPECT_FALSE(
        watch.check({.processes = 1, .processor_seconds = 0.5 * i}, true, i * 3600 * kSecond));
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

class LimitsOfCells : public HostileCells {};

TEST_F(LimitsOfCells, EndWhoSleepsAsIdle) {
  const Record record = record_after("sleep");
  EXPECT_EQ(record.status, Status::timeout);
  EXPECT_TRUE(names(record.message, "less than 1 %")) << record.message;
  EXPECT_EQ(record.curve.iteration.size(), 3U);
}

TEST_F(LimitsOfCells, EndWhoSpinsByItsProcessorTime) {
  const Record record = record_after("spin");
  EXPECT_EQ(record.status, Status::timeout);
  EXPECT_TRUE(names(record.message, "0.5 s of processor time")) << record.message;
}

// Three seconds of wall time, of which it computes in none, as on a machine with much else to do.
TEST_F(LimitsOfCells, LeaveWhoWaitsForAProcessorAlone) {
  Worker worker;
  worker.start(
      [](Trace& trace) {
        trace.first_oracle_nanoseconds = 1;
        usleep(3'000'000);
        trace.status = Status::budget;
      },
      {.hard_seconds = 2}, 1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.trace().status, Status::budget) << worker.trace().message;
}

class Parents : public HostileCells {};

TEST_F(Parents, ThatAreStoppedByACellGoOnWhenContinued) {
  options.jobs = 2;
  options.limits.hard_seconds = 30;
  const std::vector<Request> requests = {hostile("stop-parent"),
                                         request_for(catalog, "square", {}, "gd", {})};
  const pid_t runner = run_apart(requests);
  int status = 0;
  ASSERT_EQ(waitpid(runner, &status, WUNTRACED), runner);
  ASSERT_TRUE(WIFSTOPPED(status));
  usleep(300'000);
  kill(runner, SIGCONT);
  ASSERT_EQ(waitpid(runner, &status, 0), runner);
  EXPECT_TRUE(WIFEXITED(status));
  for (const Request& request : requests) EXPECT_EQ(record_of(request).status, Status::budget);
}

TEST_F(Parents, AreNotEndedByACellThatAsksThemTo) {
  options.limits.hard_seconds = 30;
  const std::vector<Request> requests = {hostile("end-parent"),
                                         request_for(catalog, "square", {}, "gd", {})};
  const pid_t runner = run_apart(requests);
  int status = 0;
  ASSERT_EQ(waitpid(runner, &status, 0), runner);
  EXPECT_TRUE(WIFEXITED(status));
  for (const Request& request : requests) EXPECT_EQ(record_of(request).status, Status::budget);
}

}  // namespace
}  // namespace isoline::benchmarks
