// A run that was stopped and gone on leaves the trace of one that was not, bit for bit.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/runner.h"
#include "core/files.h"
#include "core/json.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"
#include "tests/deadline.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

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

TEST(Checkpoint, OfAnotherCellOrDamagedIsLeftAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  for (const std::string text :
       {"", "isoline.checkpoint/2 other\n", "isoline.checkpoint/2 cell\nshort"}) {
    write_text(file, text);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << text;
  }
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

void write_state(const fs::path& file, const Kept& kept, const std::string& state) {
  write_text(file, kept.heading + digest(state) + state);
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
    write_state(file, kept, states[i]);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << i;
    EXPECT_FALSE(fs::exists(file)) << i;
    EXPECT_EQ(read_text(damaged).substr(kept.heading.size() + 16), states[i]) << i;
  }
}

TEST(Checkpoint, ThatCannotBeReadCostsNothing) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  fs::create_directory(file);
  EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 0)), trace_of(request, {}));
}

// --- Results do not depend on how the work was cut: jobs, kills and repetitions leave the same
// records.

std::vector<Request> matrix(const Catalog& catalog) {
  const Suite suite{.name = "test",
                    .title = "",
                    .blocks = {{.problems = {"square"},
                                .optimizers = {"*"},
                                .except_problems = {},
                                .except_optimizers = {},
                                .seeds = {0, 1, 2},
                                .budget = {.iterations = 200, .work = 2000}}}};
  return expand(catalog, suite, {});
}

// Every record of a folder, timings aside, by file name.
std::map<std::string, Json> results(const fs::path& folder) {
  std::map<std::string, Json> all;
  for (const auto& entry : fs::directory_iterator(folder / "runs")) {
    if (entry.path().extension() != ".json") continue;
    all[entry.path().filename()] = without_timings(read_json(entry.path()));
  }
  return all;
}

std::size_t count_runs(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code error;  // the folder may not be there yet
  for (const auto& entry : fs::directory_iterator(folder / "runs", error))
    count += entry.path().extension() == ".json";
  return count;
}

class Resume : public testing::Test {
 protected:
  Outcome run(const fs::path& folder, int jobs) {
    Store store(folder);
    return run_all(catalog, requests, store, {.jobs = jobs});
  }
  Catalog catalog = builtin_catalog();
  std::vector<Request> requests = matrix(catalog);
  TemporaryFolder first, second;
};

TEST_F(Resume, OneJobAndTwoJobsGiveTheSameRecords) {
  run(first.path(), 1);
  run(second.path(), 2);
  EXPECT_EQ(results(first.path()), results(second.path()));
}

TEST_F(Resume, DoneCellsAreNotRepeated) {
  const Outcome whole = run(first.path(), 2), again = run(first.path(), 2);
  EXPECT_EQ(whole.run, static_cast<std::int64_t>(requests.size()));
  EXPECT_EQ(again.run, 0);
  EXPECT_EQ(again.reused, whole.run);
  EXPECT_EQ(again.statuses, whole.statuses);
}

// Killed where so many records are there: the number makes a failure repeatable.
TEST_F(Resume, AKilledRunGoesOnToTheSameRecords) {
  run(first.path(), 2);
  for (const std::size_t kill_after : {std::size_t{1}, requests.size() / 4, requests.size() / 2}) {
    const TemporaryFolder killed;
    const pid_t child = fork();
    if (child == 0) {
      run(killed.path(), 2);
      _exit(0);
    }
    wait_until([&] {
      return count_runs(killed.path()) >= kill_after || waitpid(child, nullptr, WNOHANG) != 0;
    });
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::size_t kept = results(killed.path()).size();
    const Outcome rest = run(killed.path(), 2);
    EXPECT_GT(rest.reused, 0);
    EXPECT_LE(static_cast<std::size_t>(rest.reused), kept);
    EXPECT_EQ(results(first.path()), results(killed.path())) << "killed after " << kill_after;
  }
}

TEST_F(Resume, ADamagedRecordIsRunAgain) {
  run(first.path(), 2);
  const auto before = results(first.path());
  const fs::path victim = first.path() / "runs" / before.begin()->first;
  fs::resize_file(victim, fs::file_size(victim) / 2);
  EXPECT_EQ(run(first.path(), 1).run, 1);
  EXPECT_EQ(results(first.path()), before);
}

TEST_F(Resume, RepetitionsAppendTheirTimings) {
  Store store(first.path());
  requests.resize(1);
  run_all(catalog, requests, store, {.repeat = 2});
  const Outcome outcome = run_all(catalog, requests, store, {.repeat = 5});
  EXPECT_EQ(outcome.run, 3);
  EXPECT_TRUE(outcome.conflicts.empty());
  const auto record = store.find(requests[0]);
  EXPECT_EQ(record->repeat_wall_seconds.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(record->repeat_wall_seconds));
}

TEST_F(Resume, AnInterruptedRunKeepsWhatIsDoneAndGoesOn) {
  const pid_t child = fork();
  if (child == 0) {
    run(first.path(), 1);
    _exit(0);
  }
  wait_until(
      [&] { return count_runs(first.path()) >= 2 || waitpid(child, nullptr, WNOHANG) != 0; });
  kill(child, SIGINT);
  waitpid(child, nullptr, 0);
  run(first.path(), 2);
  run(second.path(), 2);
  EXPECT_EQ(results(first.path()), results(second.path()));
}

}  // namespace
}  // namespace isoline::benchmarks
