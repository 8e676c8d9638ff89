// A signal that this program did not send is an interruption: no result is lost, and the cell runs
// again.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/runner.h"
#include "core/files.h"
#include "core/json.h"
#include "core/status.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

class Kills : public HostileCells {
 protected:
  Kills() { options.limits.hard_seconds = 60; }
};

TEST_F(Kills, OfACellByOthersIsAnInterruptionAndItRunsAgain) {
  const Record record = record_after("kill");
  EXPECT_EQ(record.status, Status::interrupted) << record.message;
  EXPECT_NE(record.message.find("signal 9"), std::string::npos) << record.message;
  EXPECT_EQ(ran.interrupted, 1);
  EXPECT_TRUE(ran.failures.empty());
  EXPECT_FALSE(ran.is_interrupted) << "the run received no signal";
  EXPECT_EQ(run_all(catalog, {hostile("kill")}, store, options).run, 1) << "it runs again";
}

TEST_F(Kills, FromOutsideInterruptACellAndByAFaultOfItsOwnCrashIt) {
  for (const int signal : {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGXCPU}) {
    Worker worker;
    worker.start(
        [](Trace& trace) {
          std::signal(SIGINT, SIG_DFL);
          trace.first_oracle_nanoseconds = 1;
          for (;;) pause();
        },
        {}, 1);
    wait_until([&] { return worker.trace().first_oracle_nanoseconds != 0; });
    for (const pid_t child : children_of(getpid()))
      if (lives(child)) kill(child, signal);
    wait_until([&] { return worker.poll(); });
    EXPECT_EQ(worker.trace().status, Status::interrupted) << signal;
  }
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) {
    const auto worker = ended_worker([=](Trace&) { std::raise(signal); });
    EXPECT_EQ(worker->trace().status, Status::crashed) << signal;
  }
}

// It was written as `running`, its checkpoint deleted, and counted as done.
TEST_F(Kills, ThatAreTerminationsKeepTheCheckpointAndGoOnThere) {
  const Request request = hostile("terminate");
  const Record stopped = record_after("terminate");
  EXPECT_EQ(stopped.status, Status::interrupted) << stopped.message;
  EXPECT_TRUE(fs::exists(store.checkpoint_path(request)));
  const Record whole = record_after("terminate");
  EXPECT_EQ(whole.status, Status::budget) << whole.message;
  EXPECT_EQ(whole.curve.iteration.size(), 51U);
  EXPECT_FALSE(fs::exists(store.checkpoint_path(request)));
  const auto trace = std::make_unique<Trace>();
  ASSERT_EQ(trace->status, Status::running);  // of which there is no record
  EXPECT_EQ(benchmarks::record_of(request, *trace).status, Status::interrupted);
  EXPECT_EQ(whole.counts, record_after("none").counts) << "as without interruption";
}

// --- the program, killed

// Kills come where the folder holds so many files: the number is the moment, so that a failure can
// be repeated.
std::size_t count_files(const fs::path& folder) {
  std::size_t count = 0;
  for (const char* part : {"", "runs", "components", "checkpoints"})
    count += names_in(folder / part).size();
  return count;
}

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const std::string& name : names_in(folder / "runs"))
    if (name.ends_with(".json")) all[name] = read_text(folder / "runs" / name);
  return all;
}

class KilledRuns : public testing::Test {
 protected:
  KilledRuns() {
    const Suite suite{.name = "test",
                      .title = "",
                      .blocks = {{.problems = {"square", "rosenbrock"},
                                  .optimizers = {"gd", "adam", "momentum", "newton", "hig"},
                                  .seeds = {0, 1, 2, 3, 4, 5, 6},
                                  .budget = {.iterations = 20}}}};
    requests = expand(catalog, suite, {});
  }
  Outcome run(const fs::path& out) {  // slowly, so that there is something to interrupt
    return run_plan(catalog, "test", requests, out, {.jobs = 2, .isolates_cells = true});
  }
  pid_t run_apart() {
    return forked([&] { run(folder.path()); });
  }
  void wait_for(pid_t child, std::size_t files) {
    wait_until([&] {
      siginfo_t ended{};
      waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
      return ended.si_pid != 0 || count_files(folder.path()) >= files;
    });
  }
  static std::map<std::string, Json> results_of(const fs::path& folder) {
    std::map<std::string, Json> results;
    for (const auto& [name, text] : files_of(folder))
      results[name] = without_timings(parse_json(text, name));
    return results;
  }

  Catalog catalog = builtin_catalog();
  std::vector<Request> requests;
  TemporaryFolder undisturbed, folder;
};

TEST_F(KilledRuns, LeaveProcessesThatTheNextRunEnds) {
  told() = 0;
  const pid_t runner = forked([] {
    Worker worker;
    worker.start(
        [](Trace&) {
          leave_a_daemon_behind();
          for (;;) pause();
        },
        {}, 1);
    for (;;) pause();
  });
  wait_until([] { return told() != 0; });
  kill(runner, SIGKILL);
  status_of(runner);
  EXPECT_TRUE(lives(told())) << "its parent was killed";
  requests.resize(1);
  run(folder.path());
  wait_until([] { return !lives(told()); });
}

TEST_F(KilledRuns, AtFiftyMomentsLoseNothing) {
  constexpr int kKills = 50;
  constexpr std::size_t kFilesBetween = 2;
  run(undisturbed.path());
  std::size_t moment = 1;
  for (int i = 0; i < kKills; ++i) {
    const auto before = files_of(folder.path());
    const pid_t runner = run_apart();
    wait_for(runner, moment);
    kill(runner, SIGKILL);
    status_of(runner);
    const auto after = files_of(folder.path());
    for (const auto& [name, text] : before)
      EXPECT_EQ(after.contains(name) ? after.at(name) : "", text)
          << name << " was lost by the kill at " << moment << " files";
    moment = std::max(moment, count_files(folder.path())) + kFilesBetween;
  }
  EXPECT_FALSE(run(folder.path()).is_interrupted);
  EXPECT_EQ(results_of(folder.path()), results_of(undisturbed.path()));
}

// A scheduler signals all processes of a job half a minute before it kills them; and Ctrl-C.
TEST_F(KilledRuns, ByASchedulersTerminationOrAnInterruptGoOnWhereTheyWere) {
  run(undisturbed.path());
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t runner = run_apart();
    wait_for(runner, signal == SIGINT ? 8 : 40);
    const std::vector<pid_t> cells = children_of(runner);
    kill(runner, signal);
    for (const pid_t cell : cells) kill(cell, signal);
    EXPECT_TRUE(WIFEXITED(status_of(runner))) << "it ends in order";
    EXPECT_LT(files_of(folder.path()).size(), requests.size());
  }
  run(folder.path());
  EXPECT_EQ(results_of(folder.path()), results_of(undisturbed.path()));
}

// --- A run that is asked to end by its user, by a scheduler or by a closed terminal: in order, and
// once more at once.

class Interrupts : public HostileCells {
 protected:
  Interrupts() { options.limits = {.hard_seconds = 600, .idle_seconds = 600}; }
  // Of these cells, once the first has told that it runs.
  pid_t runner_of(const std::vector<Request>& requests) {
    const pid_t runner = run_apart(requests);
    wait_until([] { return told() != 0; });
    return runner;
  }
  // And waits until it is heard: of two that come together one is lost.
  static void press_ctrl_c(pid_t runner) {
    kill(runner, SIGINT);
    const auto is_pending = [=] {
      std::ifstream in(fmt::format("/proc/{}/status", runner));
      for (std::string word; in >> word;)
        if (word == "ShdPnd:") {
          in >> word;
          return (std::stoull(word, nullptr, 16) >> (SIGINT - 1)) % 2 == 1;
        }
      return false;
    };
    wait_until([&] { return !is_pending(); });
  }
};

TEST_F(Interrupts, ByOneCtrlCFinishWhatRunsAndStartNoMore) {
  const Request running = hostile("linger"), next = hostile("none");
  const pid_t runner = runner_of({running, next});
  press_ctrl_c(runner);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  EXPECT_EQ(record_of(running).status, Status::budget);
  EXPECT_FALSE(store.has(next));
}

TEST_F(Interrupts, ByTwoStopWhatRunsAndKeepItsState) {
  const Request running = hostile("sleep");
  const pid_t runner = runner_of({running});
  press_ctrl_c(runner);
  press_ctrl_c(runner);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  const Record record = record_of(running);
  EXPECT_EQ(record.status, Status::interrupted) << record.message;
  EXPECT_EQ(record.curve.iteration.size(), 3U) << "what it had come to";
}

TEST_F(Interrupts, ByThreeEndAllAtOnce) {
  const Request running = hostile("spin");  // hears nothing
  const pid_t runner = runner_of({running});
  const pid_t cell = children_of(runner).at(0);
  for (int i = 0; i < 3; ++i) press_ctrl_c(runner);
  const int status = status_of(runner);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kInterrupted);
  wait_until([=] { return !lives(cell); });  // it is dying
}

TEST_F(Interrupts, ByASchedulerStopWhatRunsAndItGoesOnThere) {
  for (const int signal : {SIGTERM, SIGHUP}) {
    told() = 0;
    const Request running = hostile("linger");
    fs::remove_all(folder.path() / "runs");
    fs::create_directory(folder.path() / "runs");
    const pid_t runner = runner_of({running});
    kill(runner, signal);
    EXPECT_TRUE(WIFEXITED(status_of(runner))) << signal;
    EXPECT_EQ(record_of(running).status, Status::interrupted) << signal;
    EXPECT_TRUE(fs::exists(store.checkpoint_path(running))) << signal;
    run_all(catalog, {running}, store, options);
    EXPECT_EQ(record_of(running).status, Status::budget) << signal;
  }
}

TEST_F(Interrupts, ByCtrlZStopTheCellsTooUntilAllGoOn) {
  const Request running = hostile("linger");
  const pid_t runner = runner_of({running});
  kill(runner, SIGTSTP);
  ASSERT_TRUE(WIFSTOPPED(status_of(runner)));
  const auto seconds_of_cell = [&] {
    return figures_of(children_of(runner).at(0))->processor_seconds;
  };
  const double before = seconds_of_cell();
  usleep(200'000);
  EXPECT_EQ(seconds_of_cell(), before);
  kill(runner, SIGCONT);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  EXPECT_EQ(record_of(running).status, Status::budget);
}

// A run that stopped and continued has the trace of an uninterrupted run, bit for bit.

Request request_of(const std::string& problem, const std::string& optimizer) {
  return cell_of(problem, optimizer, {.iterations = 30, .target = 0});
}

Json trace_of(const Record& run) {
  Json record = without_timings(to_json(run));
  record.erase("provenance");
  return record;
}

Json trace_of(const Request& request, Checkpoint checkpoint) {
  return trace_of(executed(catalog(), request, std::move(checkpoint)));
}

class Stopped : public testing::TestWithParam<const char*> {};

TEST_P(Stopped, AndGoneOnGivesTheSameTrace) {
  const Request request =
      request_of("sine[mode=learn,xi=4,batch=5,network=mlp[layers=6]]", GetParam());
  const Json whole = trace_of(request, {});
  ASSERT_EQ(whole.at("status"), "budget") << whole.at("message");
  EXPECT_EQ(trace_of(executed_in_pieces(catalog(), request)), whole);
}

INSTANTIATE_TEST_SUITE_P(Methods, Stopped,
                         testing::Values("adam", "adadelta", "momentum[rate=1e-6]", "gd[rate=1e-5]",
                                         "rmsprop", "sip[inverse=newton,proxy=l1]", "supervised",
                                         "adahessian", "hessian-free", "kfac", "hig",
                                         "levenberg-marquardt"));

// eki evaluates its members, and its iterate is another point: the budget ends after any of them.
TEST(StoppedRuns, ThatEndWithinTheNextStepPayForNoPointTwice) {
  for (int work = 40; work < 64; ++work) {
    const Request request =
        cell_of("rosenbrock", "eki", {.iterations = 30, .work = work, .target = 0});
    EXPECT_EQ(trace_of(executed_in_pieces(catalog(), request)), trace_of(request, {})) << work;
  }
}

TEST(Checkpoint, OfAnotherCellOrDamagedOrUnreadableIsLeftAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  for (const std::string text :
       {"", "isoline.checkpoint/2 other\n", "isoline.checkpoint/2 cell\nshort"}) {
    write_text(file, text);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << text;
  }
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 0)), whole);
}

// --- files with the right digest that hold something else

// The checkpoint of a run that was stopped after its first step; what stands before its state.
struct Kept {
  std::string heading, state;
};
Kept kept_checkpoint(const Request& request, const fs::path& file) {
  constexpr std::size_t kDigits = 16;
  Checkpoint checkpoint(file, "cell", 0);
  std::raise(SIGTERM);
  EXPECT_EQ(trace_of(request, std::move(checkpoint)).at("status"), "interrupted");
  const std::string text = read_text(file);
  const std::size_t end = text.find('\n') + 1;
  return {text.substr(0, end), text.substr(end + kDigits)};
}

template <class Number>
std::string with_number(std::string state, std::size_t at, Number number) {
  std::memcpy(state.data() + at, &number, sizeof number);
  return state;
}

TEST(Checkpoint, ThatCannotBeRestoredIsSetAsideAndTheRunStartsFromItsBeginning) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state", damaged = folder.path() / "state.damaged";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  const Kept kept = kept_checkpoint(request, file);
  const std::size_t size = kept.state.size(), trace = size - sizeof(Trace);
  const std::vector<std::string> states = {
      with_number(kept.state, 0, std::int64_t{1} << 40),  // rows of θ
      with_number(kept.state, 0, std::int64_t{-1}),       // the same
      with_number(kept.state, 8, std::int64_t{1} << 62),  // columns of θ
      with_number(kept.state, 0, std::int64_t{1}),        // another number of unknowns
      kept.state.substr(0, size / 2),                     // it ends too early
      kept.state + "more",                                // it goes on
      with_number(kept.state, trace + offsetof(Trace, points), 1'000'000'000)};
  for (std::size_t i = 0; i < states.size(); ++i) {
    write_text(file, kept.heading + digest(states[i]) + states[i]);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << i;
    EXPECT_FALSE(fs::exists(file)) << i;
    EXPECT_EQ(read_text(damaged).substr(kept.heading.size() + 16), states[i]) << i;
  }
}

// --- A run that its budget ended continues with a larger one, as if it had had that from the
// start.

class Continued : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Continued, WithALargerBudgetGivesTheRecordOfAnUninterruptedRun) {
  const TemporaryFolder owned, apart;
  Store store(owned.path()), whole(apart.path());
  const RunOptions options{.least_kept_seconds = 0};
  std::int64_t continued = 0;
  for (const Budget& budget :
       {Budget{.iterations = 7, .target = 0}, Budget{.iterations = 40, .target = 0},
        Budget{.iterations = 5000, .work = 9000, .target = 0},
        Budget{.iterations = 5000, .work = 13000, .target = 0}}) {
    const Request request = cell_of(GetParam().first, GetParam().second, budget);
    continued += run_all(catalog(), {request}, store, options).continued;
    run_all(catalog(), {request}, whole, {});
    const std::optional<Record> found = store.find(request), expected = whole.find(request);
    ASSERT_EQ(found->status, Status::budget) << found->message;
    EXPECT_EQ(trace_of(*found), trace_of(*expected));
  }
  EXPECT_EQ(continued, 3);
  EXPECT_EQ(names_in(owned.path() / "checkpoints").size(), 1U) << "the latest state";
  EXPECT_TRUE(names_in(apart.path() / "checkpoints").empty()) << "runs of less than a minute";
}

constexpr const char* kLearned = "sine[mode=learn,xi=4,batch=5,network=mlp[layers=6]]";
INSTANTIATE_TEST_SUITE_P(Methods, Continued,
                         testing::Values(std::pair{kLearned, "adam"}, std::pair{kLearned, "hig"},
                                         std::pair{kLearned, "hessian-free"},
                                         std::pair{kLearned, "sip[inverse=newton]"},
                                         std::pair{kLearned, "kfac"},
                                         std::pair{"rosenbrock", "gd[rate=1e-5]"},
                                         std::pair{"beale", "momentum[rate=1e-5]"}));

TEST(ContinuedRuns, AreThoseWhoseRecordIsThatOfAWholeRun) {
  const TemporaryFolder owned;
  Store store(owned.path());
  const auto request = [](std::int64_t iterations, const char* rate = "1e-5") {
    return cell_of("rosenbrock", fmt::format("gd[rate={}]", rate),
                   {.iterations = iterations, .target = 0});
  };
  const auto continued = [&](const Request& one, RunOptions options = {}) {
    options.least_kept_seconds = 0;
    return run_all(catalog(), {one}, store, options).continued;
  };
  EXPECT_EQ(continued(request(20)), 0);
  EXPECT_EQ(continued(request(10)), 0) << "a smaller budget";
  EXPECT_EQ(continued(request(30, "1e-6")), 0) << "another cell";
  EXPECT_EQ(continued(request(30), {.keeps_spectra = true}), 0) << "it has recorded less";
  EXPECT_EQ(continued(request(31), {.repeat = 2}), 0) << "its time counts";
  EXPECT_EQ(continued(request(32), {.exclusive = true}), 0) << "the same";
  EXPECT_EQ(continued(request(33), {.force = true}), 0);
  EXPECT_EQ(continued(request(34)), 1) << "from that of 33 iterations";
  for (const std::string& name : names_in(owned.path() / "checkpoints"))
    write_text(owned.path() / "checkpoints" / name, "damaged");
  run_all(catalog(), {request(60)}, store, {});
  EXPECT_EQ(store.find(request(60))->curve.iteration.size(), 61U) << "from the start";
}

TEST_F(HostileCells, ThatContinueDoNotRepeatTheirSteps) {
  options.least_kept_seconds = 0;
  Request request = hostile("count");
  request.budget.target = 0;
  for (const auto& [iterations, counted] : {std::pair{50, 48}, std::pair{60, 48 + 11}}) {
    request.budget.iterations = iterations;  // the last step of the first run is taken again
    run_all(catalog, {named(request)}, store, options);
    EXPECT_EQ(store.find(named(request))->summary.iterations, iterations);
    EXPECT_EQ(told(), counted);
  }
}

// --- Results do not depend on the division of the work: jobs and repetitions write the same
// records.

std::vector<Request> seeded_cells() {
  const Suite suite{.name = "test",
                    .title = "",
                    .blocks = {{.problems = {"square"},
                                .optimizers = {"*"},
                                .seeds = {0, 1, 2},
                                .budget = {.iterations = 200, .work = 2000}}}};
  return expand(catalog(), suite, {});
}

std::vector<std::string> records_in(const fs::path& folder) {
  std::vector<std::string> names = names_in(folder / "runs");  // none where it is not there yet
  std::erase_if(names, [](const std::string& name) { return !name.ends_with(".json"); });
  return names;
}

// Every record of a folder, timings aside, by file name.
std::map<std::string, Json> results(const fs::path& folder) {
  std::map<std::string, Json> all;
  for (const std::string& name : records_in(folder))
    all[name] = without_timings(read_json(folder / "runs" / name));
  return all;
}

class Resume : public testing::Test {
 protected:
  Outcome run(const fs::path& folder, int jobs) {
    Store store(folder);
    return run_all(catalog(), requests, store, {.jobs = jobs});
  }
  std::vector<Request> requests = seeded_cells();
  TemporaryFolder first, second;
};

TEST_F(Resume, OneJobAndTwoJobsGiveTheSameRecordsAndDoneCellsAreNotRepeated) {
  run(first.path(), 1);
  const Outcome whole = run(second.path(), 2), again = run(second.path(), 2);
  EXPECT_EQ(results(first.path()), results(second.path()));
  EXPECT_EQ(whole.run, static_cast<std::int64_t>(requests.size()));
  EXPECT_EQ(again.run, 0);
  EXPECT_EQ(again.reused, whole.run);
  EXPECT_EQ(again.statuses, whole.statuses);
}

TEST_F(Resume, RepetitionsAppendTheirTimings) {
  Store store(first.path());
  requests.resize(1);
  run_all(catalog(), requests, store, {.repeat = 2});
  const Outcome outcome = run_all(catalog(), requests, store, {.repeat = 5});
  EXPECT_EQ(outcome.run, 3);
  EXPECT_TRUE(outcome.conflicts.empty());
  const auto record = store.find(requests[0]);
  EXPECT_EQ(record->repeat_wall_seconds.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(record->repeat_wall_seconds));
}

}  // namespace
}  // namespace isoline::benchmarks
