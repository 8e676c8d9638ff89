// Several runs in one folder share the work, and what vanishes under them is missed.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>

#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/store.h"
#include "core/files.h"
#include "tests/benchmarks/hostile.h"
#include "tests/deadline.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// Leaves a line in the file that the environment names, so that one can count how often it ran.
struct Logging {
  struct State {};
  State init(Meter&, const Vector&) const {
    std::ofstream(std::getenv("ISOLINE_TEST_LOG"), std::ios::app) << "ran\n";
    return {};
  }
  Status step(Meter&, Vector&, State&) const {
    usleep(2000);
    return Status::running;
  }
};
void fields(Logging&, auto&) {}

std::size_t lines_in(const fs::path& file) {
  std::ifstream in(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  return lines;
}

class SharedFolder : public testing::Test {
 protected:
  SharedFolder() {
    catalog.optimizers.add(stepper_entry<Logging>(
        {.name = "logging", .title = "Counts its runs", .formula = "none", .source = "here"}));
    setenv("ISOLINE_TEST_LOG", log.c_str(), 1);
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      Request request = request_for(catalog, "rosenbrock", {}, "logging", {});
      request.seed = seed;
      request.budget.iterations = 5;
      requests.push_back(named(std::move(request)));
    }
  }
  pid_t run_elsewhere() {
    const pid_t child = fork();
    if (child == 0) {
      Store store(folder.path() / "out");
      run_all(catalog, requests, store, {.jobs = 2});
      _exit(0);
    }
    return child;
  }

  Catalog catalog = hostile_catalog();
  TemporaryFolder folder;
  fs::path log = folder.path() / "log";
  std::vector<Request> requests;
};

TEST_F(SharedFolder, ThreeRunsAtOnceDoEachCellOnce) {
  const pid_t others[] = {run_elsewhere(), run_elsewhere()};
  Store store(folder.path() / "out");
  const Outcome outcome = run_all(catalog, requests, store, {.jobs = 2});
  for (const pid_t other : others) waitpid(other, nullptr, 0);
  EXPECT_EQ(lines_in(log), requests.size());
  EXPECT_EQ(outcome.run + outcome.reused, static_cast<std::int64_t>(requests.size()));
  EXPECT_TRUE(outcome.missing.empty());
  EXPECT_EQ(outcome.statuses.at(Status::budget), static_cast<std::int64_t>(requests.size()));
}

TEST_F(SharedFolder, CellsOfARunThatWasKilledAreTakenOver) {
  const pid_t other = run_elsewhere();
  wait_until([&] { return lines_in(log) >= 3; });
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
  Store store(folder.path() / "out");
  const Outcome outcome = run_all(catalog, requests, store, {.jobs = 2});
  EXPECT_EQ(outcome.statuses.at(Status::budget), static_cast<std::int64_t>(requests.size()));
  EXPECT_LE(lines_in(log), requests.size() + 3);  // those that its three workers had in hand
}

TEST_F(SharedFolder, ACellThatAnotherProcessHoldsIsWaitedFor) {
  requests.resize(1);
  Store store(folder.path() / "out");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t other = fork();
  if (other == 0) {
    Holds holds(store.folder());
    const char is_held = holds.take(Store::name_of(requests[0])) ? 'y' : 'n';
    _exit(write(ends[1], &is_held, 1) == 1 ? (usleep(500'000), 0) : 1);
  }
  char is_held = 'n';
  ASSERT_EQ(read(ends[0], &is_held, 1), 1);
  ASSERT_EQ(is_held, 'y');
  EXPECT_FALSE(Holds(store.folder()).take(Store::name_of(requests[0])));
  const Outcome outcome = run_all(catalog, requests, store, {});
  EXPECT_EQ(waitpid(other, nullptr, WNOHANG), other) << "it ran before the other had let go";
  EXPECT_EQ(outcome.run, 1);
}

TEST_F(SharedFolder, RecordsThatVanishWhileItRunsAreMissed) {
  const fs::path out = folder.path() / "out";
  const pid_t remover = fork();
  if (remover == 0) {
    alarm(120);
    std::error_code error;
    while (std::distance(fs::directory_iterator(out / "runs", error), {}) < 5) usleep(200);
    // It ends at a file that is renamed meanwhile, and leaves the rest.
    while (fs::remove_all(out, error), error) usleep(200);
    _exit(0);
  }
  const Outcome outcome = run_plan(catalog, "test", requests, out, {.jobs = 2});
  waitpid(remover, nullptr, 0);
  EXPECT_GE(outcome.missing.size(), 4U);
  EXPECT_EQ(plan_from_text(read_text(out / "plan.json"), "plan").cells.size(), requests.size());
  const Outcome again = run_plan(catalog, "test", requests, out, {.jobs = 2});
  EXPECT_TRUE(again.missing.empty());
  EXPECT_EQ(again.run, static_cast<std::int64_t>(outcome.missing.size()));
}

}  // namespace
}  // namespace isoline::benchmarks
