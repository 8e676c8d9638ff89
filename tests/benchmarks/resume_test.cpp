// Results do not depend on how the work was cut: jobs, kills and repetitions leave the same
// records.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/runner.h"
#include "core/json.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

namespace {

namespace fs = std::filesystem;

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
    while (count_runs(killed.path()) < kill_after && waitpid(child, nullptr, WNOHANG) == 0) {
    }
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
  while (count_runs(first.path()) < 2 && waitpid(child, nullptr, WNOHANG) == 0) {
  }
  kill(child, SIGINT);
  waitpid(child, nullptr, 0);
  run(first.path(), 2);
  run(second.path(), 2);
  EXPECT_EQ(results(first.path()), results(second.path()));
}

}  // namespace
}  // namespace isoline::benchmarks
