// A cell that fails affects that cell only, and its record describes the failure. Shared memory
// that it overwrote is checked before it is read.
#include <algorithm>
#include <cstring>
#include <random>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/keepers/keeper.h"
#include "benchmarks/run/run_plan.h"
#include "core/foreign/line.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"

namespace isoline::benchmarks {
namespace {

class Isolation : public HostileCells {};

TEST_F(Isolation, EachMisdeedEndsAsWhatItIsAndItsTraceIsKept) {
  const struct {
    const char* misdeed;
    Status status;
    std::string message;  // a part of it
    std::size_t points;   // of its curve; 0: any
  } ends[] = {{"throw", Status::failed, "thrown on purpose", 0},
              {"throw-int", Status::failed, "", 0},
              {"segfault", Status::crashed, "signal 11", 3},
              {"complain", Status::crashed, "", 3},  // and aborts
              {"exit", Status::crashed, "", 0},      // leaving without a verdict
              {"nan", Status::diverged, "", 0},
              {"overask", Status::failed, "jacobian", 0},               // an oracle not declared
              {"spin", Status::timeout, "0.5 s of processor time", 3},  // an endless loop
              {"sleep", Status::timeout, "less than 1 %", 3},
              {"resize", Status::failed, "from 2 to 1002", 0},  // would be read past its end
              {"hoard", Status::memory, "--memory", 0}};
  for (const auto& end : ends) {
    // Touching half a gigabyte may take a while on a busy machine.
    options.limits.hard_seconds = end.status == Status::memory ? 30 : 0.5;
    const Record record = record_after(end.misdeed);
    EXPECT_EQ(record.status, end.status) << end.misdeed << ": " << record.message;
    EXPECT_NE(record.message.find(end.message), std::string::npos) << record.message;
    EXPECT_NE(record.verified.at("1e-1"), std::optional(true)) << end.misdeed;
    EXPECT_EQ(record.is_nondeterministic,
              end.status == Status::timeout || end.status == Status::memory)
        << end.misdeed;
    EXPECT_EQ(std::isnan(record.summary.loss), end.status == Status::diverged) << end.misdeed;
    EXPECT_EQ(record.output, end.misdeed == std::string("complain") ? "the grid is too coarse" : "")
        << "the last words of a crash";
    if (end.points == 0) continue;
    EXPECT_EQ(record.curve.iteration, (std::vector<std::int64_t>{0, 1, 2})) << end.misdeed;
    EXPECT_LT(record.curve.loss[2], record.curve.loss[0]) << end.misdeed;
  }
}

TEST_F(Isolation, AProblemThatHangsBeforeItsFirstOracleIsKilled) {
  const Request request = request_for(catalog, "broken", {}, "gd", {});
  run_all(catalog, {request}, store, options);
  const Record record = record_of(request);
  EXPECT_EQ(record.status, Status::timeout);
  EXPECT_NE(record.message.find("without an oracle call"), std::string::npos);
}

TEST_F(Isolation, AProblemThatCrashesOrLeavesWhileItIsMadeCostsItsCellAlone) {
  const Request sound = request_for(catalog, "square", {}, "gd", {});
  options.force = true;
  for (const char* misdeed : {"segfault", "exit"}) {
    const Request broken = request_for(catalog, "broken", {{"misdeed", misdeed}}, "gd", {});
    const Outcome outcome = run_plan(catalog, "both", {broken, sound}, folder.path(), options);
    EXPECT_EQ(outcome.failures.size(), 1U) << misdeed;
    EXPECT_EQ(record_of(broken).status, Status::crashed) << misdeed;
    EXPECT_EQ(record_of(sound).status, Status::budget) << misdeed;
  }
}

TEST_F(Isolation, OtherCellsAreUntouchedByTheirNeighbours) {
  const Request sound = request_for(catalog, "square", {}, "gd", {});
  run_all(catalog, {sound}, store, options);
  const Json alone = without_timings(to_json(record_of(sound)));
  std::vector<Request> all;
  for (const char* misdeed : {"segfault", "throw", "nan", "abort"}) all.push_back(hostile(misdeed));
  all.push_back(sound);
  options.jobs = 2;
  options.force = true;
  EXPECT_EQ(run_all(catalog, all, store, options).run, 5);
  EXPECT_EQ(without_timings(to_json(record_of(sound))), alone);
}

// --- Cells of one problem share a process, as if each had one of its own.

class SharedProcess : public HostileCells {
 protected:
  SharedProcess() { options.limits.hard_seconds = 30; }
  // Without timings, and of a full memory without which of its two guards has seen it first.
  static Json result_of(const Record& record) {
    Json result = without_timings(to_json(record));
    if (record.status == Status::memory) result.erase("message");
    return result;
  }
  std::vector<Json> results_of(const std::vector<Request>& requests) {  // in order
    ran = run_all(catalog, requests, store, options);
    std::vector<Json> results;
    for (const Request& request : requests) results.push_back(result_of(record_of(request)));
    return results;
  }
  // Of fresh processes.
  std::vector<Json> isolated(const std::vector<Request>& requests) {
    TemporaryFolder other;
    Store apart(other.path());
    RunOptions alone = options;
    alone.isolates_cells = true;
    run_all(catalog, requests, apart, alone);
    std::vector<Json> results;
    for (const Request& request : requests)
      results.push_back(result_of(apart.find(request).value()));
    return results;
  }
  std::vector<Request> remembering() const {
    return {hostile("remember", 0), hostile("remember", 1), hostile("remember", 2)};
  }
};

TEST_F(SharedProcess, RunsTheCellsOfAProblemUnlessTheyAreIsolated) {
  const std::vector<Request> requests = remembering();
  const std::vector<Json> fresh = isolated(requests), shared = results_of(requests);
  EXPECT_EQ(shared[0], fresh[0]);
  EXPECT_NE(shared[1], fresh[1]) << "its process remembers the first";
  EXPECT_TRUE(ran.conflicts.empty());
}

TEST_F(SharedProcess, AfterAFaultAllThatItFinishedRunsAgainInFreshOnes) {
  for (const char* fault : {"segfault", "exit", "spin", "hoard"}) {
    options.limits.hard_seconds = fault == std::string("hoard") ? 30 : 0.5;
    options.force = true;
    std::vector<Request> requests = remembering();
    requests.push_back(hostile(fault));
    requests.push_back(hostile("none"));
    const std::vector<Json> fresh = isolated(requests);
    EXPECT_EQ(results_of(requests), fresh) << fault;
    EXPECT_EQ(ran.run, 5) << "each counts once";
    EXPECT_EQ(ran.conflicts, (std::vector{title_of(requests[1]), title_of(requests[2])}))
        << "the first results differed";
    EXPECT_EQ(ran.failures.size(), 1U) << fault;
    EXPECT_EQ(ran.statuses[Status::budget], 4) << fault;
  }
}

TEST_F(SharedProcess, CountsWhatARecordSaysOfItFromTheBeginningOfEachCell) {
  options.limits.hard_seconds = 0.5;
  options.keeps_output = true;
  const std::vector<Request> requests = {hostile("chatter"), hostile("swell"),   hostile("toil", 0),
                                         hostile("toil", 1), hostile("toil", 2), hostile("none")};
  results_of(requests);
  EXPECT_EQ(ran.statuses[Status::budget], 6) << "three of 0.3 s each have a limit of 0.5 s";
  constexpr std::int64_t kNearly = 60 << 20;
  const auto peak = [&](int i) { return record_of(requests[i]).summary.peak_memory_bytes; };
  EXPECT_GT(peak(1), peak(5) + kNearly);
  EXPECT_LT(peak(5), peak(0) + kNearly);
  EXPECT_FALSE(record_of(requests[0]).output.empty());
  EXPECT_EQ(record_of(requests[5]).output, "");
}

TEST_F(SharedProcess, EndsWithWhatACellLeavesRunning) {
  const std::vector<Request> requests = {hostile("remember", 0), hostile("daemon"),
                                         hostile("remember", 1)};
  const std::vector<Json> shared = results_of(requests);
  EXPECT_FALSE(lives(told()));
  EXPECT_EQ(shared, isolated(requests)) << "the third cell has a new one";
}

TEST_F(SharedProcess, HasRecordsOnDiskWhileItsNextCellRuns) {
  options.limits = {.hard_seconds = 600, .idle_seconds = 600};
  const std::vector<Request> requests = {hostile("none"), hostile("linger"), hostile("sleep")};
  const pid_t runner = run_apart(requests);
  wait_until([&] { return store.has(requests[0]) && store.has(requests[1]); });
  kill(runner, SIGKILL);
  status_of(runner);
  EXPECT_EQ(record_of(requests[1]).status, Status::budget);
}

// A cell that kept something for the next one would give it another result here. The whole suite
// takes minutes: this is a sample of it.
TEST_F(SharedProcess, GivesTheRecordsOfFreshOnesInAnyOrder) {
  constexpr std::uint64_t kSeed = 53;
  constexpr std::size_t kShare = 64;
  const bool is_whole = std::getenv("ISOLINE_LONG_TESTS") != nullptr;
  Suite suite = read_suite("quick");
  for (MatrixBlock& block : suite.blocks) {
    if (is_whole) break;
    block.seeds = {0};
    block.budget.iterations = std::min<std::int64_t>(block.budget.iterations, 3);
    block.budget.work = std::min<std::int64_t>(block.budget.work, 300);
  }
  std::vector<Request> requests = expand(catalog, suite, Rates::builtin());
  std::erase_if(requests, [](const Request& request) {  // and what ends by a limit of time
    return request.problem.is_learned || request.problem.name == "broken" ||
           request.optimizer.name == "hostile";
  });
  std::ranges::shuffle(requests, std::mt19937_64(kSeed));
  if (!is_whole) requests.resize(requests.size() / kShare);
  options = {.jobs = one_a_core()};
  const std::vector<Json> fresh = isolated(requests), shared = results_of(requests);
  EXPECT_TRUE(ran.conflicts.empty());
  for (std::size_t i = 0; i < requests.size(); ++i)
    EXPECT_EQ(shared[i], fresh[i]) << title_of(requests[i]);
}

// --- The output of a cell: captured, bounded, kept on request.

class Output : public HostileCells {
 protected:
  Output() { options.limits.hard_seconds = 30; }
};

TEST_F(Output, OfACellReachesNoTerminalAndItsRecordOnRequestUpToItsBound) {
  testing::internal::CaptureStdout();
  const Record quiet = record_after("chatter");  // 20,000 lines with escape sequences
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(quiet.status, Status::budget) << quiet.message;
  EXPECT_EQ(quiet.output, "");
  options.keeps_output = options.force = true;
  const Record record = record_after("chatter");
  EXPECT_TRUE(record.output.starts_with("\x1b[31munexpected output\n"));
  EXPECT_GE(record.output.size(), CapturedOutput::kMost);
  EXPECT_LT(record.output.size(), CapturedOutput::kMost + 100);
  EXPECT_NE(record.output.find("bytes more"), std::string::npos) << "it says what was left out";
  EXPECT_FALSE(without_timings(to_json(record)).contains("output")) << "it is no result";
}

// A process that writes more than a pipe holds is not blocked.
TEST_F(Output, WithoutEndHoldsNobodyUp) {
  const auto worker = ended_worker([](Trace& trace) {
    const std::string line(1000, 'x');
    for (int i = 0; i < 30'000; ++i) std::puts(line.c_str());
    trace.status = Status::budget;
  });
  EXPECT_EQ(worker->trace().status, Status::budget) << worker->trace().message;
  EXPECT_LT(worker->output().text().size(), CapturedOutput::kMost + 100);
}

TEST_F(Output, IsWhatWasWrittenInTheRightOrderAsText) {
  const auto worker = ended_worker([](Trace& trace) {
    std::printf("first\n");
    std::fprintf(stderr, "second\n");
    std::printf("third\xff, without an end");
    trace.status = getchar() == EOF ? Status::budget : Status::failed;
  });
  EXPECT_EQ(worker->output().text(), "first\nsecond\nthird\uFFFD, without an end");
  EXPECT_EQ(worker->trace().status, Status::budget) << "its input is empty";
}

// --- A text from another process: whole, or none and the reason.

TEST(IsolatedText, IsTheTextWholeAndNothingElseReachesTheTerminal) {
  testing::internal::CaptureStdout();
  for (const std::string& text : {std::string(), std::string("whole"), std::string(3 << 20, 'x')}) {
    const auto work = [&] {
      std::printf("\x1b[31m");
      std::fflush(stdout);
      return text;
    };
    const IsolatedText found = isolated_text(work, 10);
    EXPECT_EQ(found.text, text);
    EXPECT_EQ(found.failure, "");
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(IsolatedText, OfAProcessThatDoesNotEndWellIsNoneButAReason) {
  const struct {
    std::function<std::string()> work;
    double seconds;
    std::string reason;
  } ends[] = {
      {[]() -> std::string { throw std::runtime_error("for a reason"); }, 10, "for a reason"},
      {[]() -> std::string { throw 7; }, 10, "not a std::exception"},
      {[]() -> std::string { throw std::bad_alloc(); }, 10, "memory"},
      {[]() -> std::string { return std::raise(SIGKILL) == 0 ? "x" : "y"; }, 10, "signal 9"},
      {[]() -> std::string { throw KilledProgram("somebody killed it"); }, 10, "killed it"},
      {[]() -> std::string { _exit(3); }, 10, "exited with code 3"},
      {[]() -> std::string { _exit(0); }, 10, "without an answer"},
      {[]() -> std::string { std::exit(0); }, 10, "without an answer"},
      {[]() -> std::string {
         std::fprintf(stderr, "the grid is too coarse\n");
         std::abort();
       },
       10, ": the grid is too coarse"},
      {[]() -> std::string { throw std::runtime_error("no text: \xff"); }, 10, "no text: \uFFFD"},
      {[]() -> std::string {
         for (;;) pause();
       },
       0.2, "more than 0.2 s"},
      {[]() -> std::string {
         for (volatile bool go_on = true; go_on;) {
         }
         return "";
       },
       0.2, "took more than 0.2 s"},
      {[]() -> std::string {  // as a script that never answers
         fork();
         for (;;) pause();
       },
       0.2, "idle for more than"}};
  for (const auto& [work, seconds, reason] : ends) {
    const IsolatedText found = isolated_text(work, seconds);
    EXPECT_FALSE(found.text.has_value()) << reason;
    EXPECT_NE(found.failure.find(reason), std::string::npos) << found.failure;
    EXPECT_EQ(found.is_interrupted, reason == "signal 9" || reason == "killed it") << reason;
  }
}

TEST(IsolatedText, IsNotWaitedForOnADescendantThatLives) {
  told() = 0;
  const IsolatedText found = isolated_text(
      [] {
        leave_a_daemon_behind();
        return std::string("whole");
      },
      600);
  EXPECT_EQ(found.text, "whole");
  ASSERT_GT(told(), 0);
  EXPECT_NE(kill(told(), 0), 0) << "the daemon lives";
}

// --- traces that a cell has overwritten

// Of a cell that ran as it should, and then wrote to its trace.
Record record_after(const std::function<void(Trace&)>& wild_write, const Limits& limits = {}) {
  const Request request = cell_of("square", "gd", {.iterations = 20});
  const auto worker = ended_worker(
      [&](Trace& trace) {
        execute(benchmarks::catalog(), request, trace);
        wild_write(trace);
      },
      limits);
  return record_of(request, worker->trace());
}

// Whatever another process leaves in the data of a keeper that has sizes, it is noticed.
TEST(BadTrace, OfEachKeeperIsADefect) {
  for (const Keeper& keeper : keepers()) {
    constexpr std::size_t kSmall = 64;  // of a keeper whose data the trace has
    std::vector<std::max_align_t> room(keeper.bytes / sizeof(std::max_align_t) + 1);
    keeper.construct(room.data());
    EXPECT_EQ(keeper.defect(room.data()), "");
    for (const int byte : {0x5a, 0xff}) {
      std::memset(room.data(), byte, keeper.bytes);
      EXPECT_EQ(keeper.defect(room.data()).empty(), keeper.bytes <= kSmall) << keeper.bytes;
    }
  }
}

TEST(BadTrace, OfAnyKindIsACrashThatSaysSo) {
  const std::vector<std::function<void(Trace&)>> writes = {
      [](Trace& trace) { trace.points = 1'000'000'000; },
      [](Trace& trace) { trace.points = -1; },
      [](Trace& trace) { std::memset(trace.kept, 0x5a, sizeof trace.kept); },
      [](Trace& trace) { trace.unknowns = 1 << 30; },
      [](Trace& trace) { std::memset(&trace.has_best, 0x5a, 1); },
      [](Trace& trace) { std::memset(&trace.wants_spectra, 0x5a, 1); },
      [](Trace& trace) { trace.status = static_cast<Status>(77); },
      [](Trace& trace) { trace.aim = static_cast<Aim>(-1); },
      [](Trace& trace) { std::memset(trace.message, 'x', sizeof trace.message); },
      [](Trace& trace) { std::memset(trace.privileges, 'x', sizeof trace.privileges); },
      [](Trace& trace) { std::memset(trace.claimed, 'x', sizeof trace.claimed); },
      [](Trace& trace) { std::memset(trace.series_names, '\n', 900); },
      [](Trace& trace) { set_text(trace.series_names, "a\na"); },
      [](Trace& trace) { trace.point[3].iteration = 1; },
      [](Trace& trace) { trace.point[3].counts[0] = -4; },
      [](Trace& trace) { trace.point[3].wall_seconds = -1; },
      [](Trace& trace) {
        trace.hit[0].iteration = std::int64_t{1} << 40;
        trace.hit[1].iteration = 5;
      },
      [](Trace& trace) { trace.rejected_steps = -1; },
      [](Trace& trace) { std::memset(&trace.is_learned, 0x5a, 1); },
      [](Trace& trace) { std::memset(static_cast<void*>(&trace.point), 0x5a, sizeof trace.point); },
      [](Trace& trace) { std::memset(static_cast<void*>(&trace), 0xff, sizeof trace); }};
  const Record sound = record_after([](Trace&) {});
  EXPECT_EQ(sound.status, Status::budget) << sound.message;
  EXPECT_EQ(sound.curve.iteration.size(), 21U);
  for (std::size_t i = 0; i < writes.size(); ++i) {
    const Record record = record_after(writes[i]);
    EXPECT_EQ(record.status, Status::crashed) << i;
    EXPECT_NE(record.message.find("overwrote the trace"), std::string::npos) << record.message;
    EXPECT_TRUE(record.curve.iteration.empty()) << i;
  }
}

TEST(BadTrace, OfARunThatWasKilledIsNotReadEither) {
  const auto write_and_spin = [](Trace& trace) {
    trace.points = 1'000'000'000;
    for (volatile bool go_on = true; go_on;) {
    }
  };
  const Record record = record_after(write_and_spin, {.hard_seconds = 0.2});
  EXPECT_EQ(record.status, Status::timeout) << record.message;
  EXPECT_TRUE(record.curve.iteration.empty());
}

TEST(BadTrace, OfOneCellDoesNotReachTheMemoryOfAnother) {
  const auto first = ended_worker([](Trace& trace) { trace.status = Status::budget; });
  const Trace& other = first->trace();
  const auto second = ended_worker([&](Trace&) {
    std::memset(static_cast<void*>(const_cast<Trace*>(&other)), 0x5a, sizeof(Trace));
  });
  EXPECT_EQ(second->trace().status, Status::crashed) << second->trace().message;
  EXPECT_EQ(first->trace().status, Status::budget);
}

TEST(BadTrace, OfASizeThatCannotBeReturnsNothing) {
  Worker worker;
  const auto sizes_after = [&](std::int64_t size) {
    worker.start(
        [&](Trace& trace) {
          worker.keep_returned(std::vector<Real>(3, 7));
          const_cast<Returned*>(reinterpret_cast<const Returned*>(worker.returned() - 1))->size =
              size;
          trace.status = Status::budget;
        },
        {}, 1);
    wait_until([&] { return worker.poll(); });
    return worker.returned_size();
  };
  static_assert(offsetof(Returned, theta) == sizeof(double));
  EXPECT_EQ(sizes_after(3), 3);
  EXPECT_EQ(worker.returned()[2], 7);
  EXPECT_EQ(sizes_after(-3), 0);
  EXPECT_EQ(sizes_after(std::int64_t{1} << 40), 0);
}

// When a cell is ended: its own use of time and memory counts, the use by others does not.

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
  EXPECT_TRUE(names(watched(watch, 1, 31, false), "without an oracle call; --time"));
  LimitWatch full({.memory_bytes = 1 << 20}, 1, 0);
  const auto breach = full.check({.processes = 1, .resident_bytes = 2 << 20}, true, kSecond);
  EXPECT_EQ(breach->status, Status::memory);
  EXPECT_TRUE(names(breach->message, "--memory"));
}

TEST(Limits, EndWhoIsIdleButNotWhoWaitsForAnotherProcess) {
  const LimitWatch watch({}, 1, 0);
  EXPECT_TRUE(names(watched(watch, 0.005, 61), "less than 1 %"));
  EXPECT_EQ(watched(watch, 0.005, 61, true, 2), "");
  EXPECT_TRUE(names(watched(LimitWatch({.waits_for_others = false}, 1, 0), 0.005, 61, true, 2),
                    "less than 1 %"))
      << "an examined component waits for no other process";
  EXPECT_EQ(watched(watch, 0.02, 100), "");
  LimitWatch starved({}, 1, 0);
  for (int i = 1; i < 100; ++i)  // other programs have the processor
    EXPECT_FALSE(starved.check({.processes = 1, .waiting_seconds = 0.9 * i}, true, i * kSecond));
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
