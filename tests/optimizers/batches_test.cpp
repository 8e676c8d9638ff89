// Calls that a method hands over together: they share rounds, and several copies of a program
// compute them at once, with the same results as one copy.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/failures.h"
#include "core/files.h"
#include "core/foreign/evaluations.h"
#include "problems/features.h"
#include "tests/clients/programs.h"
#include "tests/optimizers/run.h"
#include "tests/temporary_folder.h"

namespace isoline::optimizers {
namespace {

using problems::Draw;

std::int64_t rounded_up(std::int64_t calls, std::int64_t workers) {
  return (calls + workers - 1) / workers;
}

// Three generations of 20 points; what is beyond them are judged points, each alone.
TEST(Batches, OfAPopulationShareRounds) {
  constexpr std::int64_t kPoints = 20, kGenerations = 3;
  const Outcome outcome =
      run(make("brown-dennis"), "cma-es[population=20]", iterations(kGenerations));
  const TracePoint& last = outcome.trace->last;
  ASSERT_GE(last.work, kGenerations * kPoints);
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    EXPECT_EQ(last.rounds[i],
              kGenerations * rounded_up(kPoints, kWorkers[i]) + last.work - kGenerations * kPoints);
}

TEST(Batches, ThatTheBudgetCutsOffAreCountedAsFarAsTheyWent) {
  constexpr std::int64_t kPoints = 20, kWork = 30;  // one solve is left for the returned point
  const Outcome outcome = run(make("brown-dennis"), "cma-es[population=20]",
                              {.iterations = 100, .work = kWork, .target = 0});
  const TracePoint& last = outcome.trace->last;
  const std::int64_t judged = last.counts[0] - (kWork - 1);
  ASSERT_TRUE(judged == 0 || judged == 1) << last.counts[0];
  const std::int64_t alone = 1;  // after the first generation, or at the end
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    EXPECT_LE(last.rounds[i], rounded_up(kPoints, kWorkers[i]) +
                                  rounded_up(kWork - 1 - kPoints, kWorkers[i]) + judged + alone);
}

TEST(Batches, OfAJacobianByDifferencesShareRounds) {
  const Problem problem = problems::with_features(make("burgers[N=16]"),
                                                  {{"derivatives", "central"}}, Draw(0, "burgers"));
  const Outcome outcome = run(problem, "levenberg-marquardt", iterations(4));
  const TracePoint& last = outcome.trace->last;
  const std::int64_t calls = 2 * problem.unknowns();
  const std::int64_t jacobians = last.counts[static_cast<std::size_t>(Oracle::jacobian)];
  ASSERT_GT(jacobians, 0);
  for (std::size_t i = 0; i < kWorkers.size(); ++i)
    EXPECT_EQ(last.rounds[i], last.work - jacobians * (calls - rounded_up(calls, kWorkers[i])));
}

TEST(Batches, AreHandedOverByMethodsThatKnowSeveralPointsBefore) {
  const Budget budget{.iterations = 1000, .work = 200, .target = 0};
  for (const char* method :
       {"dfo-gn", "eki", "etki", "uki", "cma-es", "levenberg-marquardt[jacobian=differences]",
        "gauss-newton[jacobian=central]", "nlopt-neldermead"}) {
    const Outcome outcome = run(make("brown-dennis"), method, budget);
    const TracePoint& last = outcome.trace->last;
    EXPECT_TRUE(outcome.trace->counts_rounds) << method;
    for (std::size_t i = 0; i < kWorkers.size(); ++i) {
      EXPECT_GE(last.rounds[i], rounded_up(last.work, kWorkers[i])) << method;
      if (method == std::string("nlopt-neldermead")) {
        EXPECT_EQ(last.rounds[i], last.work);
      } else {
        EXPECT_LT(last.rounds[i], last.work) << method;
      }
    }
  }
  EXPECT_FALSE(run(make("brown-dennis"), "levenberg-marquardt", budget).trace->counts_rounds);
}

// A valley that fails above x₂ = 1.1. The first copy waits, for at most 20 s, until another one has
// made a call, so that none is left out because it started late; or each call takes 5 ms.
class Copies : public testing::Test {
 protected:
  void SetUp() override {
    write_text(
        script,
        "import os, sys, time, isoline\n"
        "how, copies, folder = sys.argv[1], int(sys.argv[2]), sys.argv[3]\n"
        "worker, start, end = os.environ['ISOLINE_WORKER'], [-1.2, 1.0], 20\n"
        "def forward(x):\n"
        "    if list(x) != start:\n"
        "        if worker != '0': open(folder + '/shared', 'a').close()\n"
        "        began = time.monotonic()\n"
        "        if how == 'naps': time.sleep(0.005)\n"
        "        while (how != 'naps' and copies > 1 and worker == '0' and time.monotonic() < began + end\n"
        "               and not os.path.exists(folder + '/shared')): time.sleep(0.001)\n"
        "        with open(folder + '/calls', 'a') as calls:\n"
        "            calls.write(f'{worker} {os.getpid()} {int(x[1] > 1.1)}\\n')\n"
        "    if x[1] > 1.1:\n"
        "        if how == 'exits': os._exit(7)\n"
        "        raise KeyError('mesh')\n"
        "    return [10 * (x[1] - x[0] * x[0]), 1 - x[0], 0.1 * x[1]]\n"
        "isoline.problem(forward, start)\n");
  }
  void TearDown() override { evaluations().begin({}); }

  struct Result {
    Outcome outcome;
    std::int64_t failed = 0;
    Vector first_failed;
  };
  Result result_of(const std::string& method, int copies, const std::string& how = "raises",
                   const OptionValues& features = {}, bool continues = false) const {
    for (const char* name : {"shared", "calls"}) std::filesystem::remove(folder.path() / name);
    if (!continues) std::filesystem::remove_all(folder.path() / "evaluations");
    const auto failures = std::make_unique<FailedEvaluations>();
    const FailureSink sink(*failures);
    evaluations().begin({.folder = folder.path(), .keeps_all = true});
    const std::string command = "python3 " + script.string() + " " + how + " " +
                                std::to_string(copies) + " " + folder.path().string();
    const Problem problem = problems::with_features(
        make(process_of(command, ",failures=1000,workers=" + std::to_string(copies))), features,
        Draw(0, "process"));
    Result result{.outcome = run(problem, method, {.iterations = 100, .work = 60, .target = 0})};
    evaluations().begin({});
    result.failed = failures->total;
    if (failures->kept > 0) {
      const std::span<const Real> x = failures->point(0);
      result.first_failed = Eigen::Map<const Vector>(x.data(), std::ssize(x));
    }
    if (copies > 1 && how != "naps" && !continues) {
      EXPECT_TRUE(std::filesystem::exists(folder.path() / "shared")) << method;
    }
    return result;
  }
  static void expect_same(const Result& one, const Result& other, const std::string& what) {
    EXPECT_EQ(one.outcome.theta, other.outcome.theta) << what;
    EXPECT_EQ(one.outcome.path, other.outcome.path) << what;
    EXPECT_EQ(one.outcome.status, other.outcome.status) << what;
    const TracePoint &a = one.outcome.trace->last, &b = other.outcome.trace->last;
    EXPECT_EQ(a.counts, b.counts) << what;
    EXPECT_EQ(a.rounds, b.rounds) << what;
    EXPECT_EQ(one.failed, other.failed) << what;
    EXPECT_EQ(one.first_failed, other.first_failed) << what;
  }

  TemporaryFolder folder;
  std::filesystem::path script = folder.path() / "valley.py";
};

TEST_F(Copies, OfAProgramGiveTheResultsOfOne) {
  for (const char* method :
       {"cma-es", "eki", "uki", "dfo-gn", "levenberg-marquardt[jacobian=differences]"}) {
    const Result one = result_of(method, 1);
    for (const int copies : {2, 3}) {
      expect_same(one, result_of(method, copies), method);
    }
  }
}

TEST_F(Copies, OfAProgramGiveTheResultsOfOneForAnyFeature) {
  const OptionValues features{
      {"jitter", 1e-2}, {"derivatives", "central"}, {"scale", 10.0}, {"rotate", true}};
  const Result one = result_of("levenberg-marquardt", 1, "naps", features);
  expect_same(one, result_of("levenberg-marquardt", 2, "naps", features), "differences");
}

// Each process of a copy but its last one has crashed.
TEST_F(Copies, ThatCrashAreStartedAgainAndNoOthers) {
  const Result one = result_of("cma-es[population=12]", 1, "exits");
  ASSERT_GT(one.failed, 0);
  const Result three = result_of("cma-es[population=12]", 3, "exits");
  std::map<int, std::set<int>> alive, crashed;  // processes, by copy
  std::ifstream calls(folder.path() / "calls");
  for (int copy = 0, process = 0, fails = 0; calls >> copy >> process >> fails;) {
    EXPECT_FALSE(crashed[copy].contains(process));
    alive[copy].insert(process);
    if (fails == 1) crashed[copy].insert(process);
  }
  for (const auto& [copy, processes] : alive)
    EXPECT_LE(processes.size(), crashed[copy].size() + 1) << copy;
  EXPECT_GT(alive.size(), 1U);
  expect_same(one, three, "exits");
}

// The copies of the second run answer no call: each one of the first run is in the store, slow as
// the calls were, although the answers of copies were there before they were asked for.
TEST_F(Copies, OfASlowProgramHaveTheirCallsKept) {
  write_text(script,
             "import os, time, isoline\n"
             "def forward(x):\n"
             "    time.sleep(0.12)\n"
             "    return [10 * (x[1] - x[0] * x[0]), 1 - x[0], 0.1 * x[1]]\n"
             "isoline.problem(forward, [-1.2, 1.0])\n");
  CallReport report;
  const CallSink sink(report);
  for (const bool is_again : {false, true}) {
    report = {};
    evaluations().begin({.folder = folder.path()});
    run(make(process_of("python3 " + script.string(), ",workers=3")), "eki",
        {.iterations = 100, .work = 20, .target = 0});
    if (is_again) {
      EXPECT_EQ(report.made, 0);
    } else {
      EXPECT_GE(report.made, 20);
    }
  }
}

// A store that ends in the middle of an entry.
TEST_F(Copies, ContinueAStoreThatWasCutOff) {
  const Result whole = result_of("cma-es", 2);
  for (const unsigned share : {3U, 2U}) {
    for (const auto& file : std::filesystem::directory_iterator(folder.path() / "evaluations"))
      std::filesystem::resize_file(file, std::filesystem::file_size(file) / share);
    expect_same(whole, result_of("cma-es", 2, "raises", {}, true), "continued");
  }
}

}  // namespace
}  // namespace isoline::optimizers
