// Cells that another program computes: its errors affect its own cell only, its identity is
// recorded, and its oracle calls are counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/process_group.h"
#include "benchmarks/run/run_plan.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "tests/benchmarks/builtin.h"
#include "tests/clients/programs.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

const std::string kValley = process_of(example("rosenbrock.py"));

class ForeignCells : public testing::Test {
 protected:
  static Request request_of(const std::string& problem, const std::string& optimizer,
                            const Budget& budget = {.iterations = 50}) {
    return cell_of(problem, optimizer, budget);
  }
  Record record_of(const Request& request) {
    run_all(catalog(), {request}, store, options);
    for (const std::string& name : names_in(folder.path() / "runs"))
      if (name.starts_with(request.cell) && name.ends_with(".json"))
        return read_record(folder.path() / "runs" / name);
    ADD_FAILURE() << "there is no record";
    return {};
  }
  Record record_after(const std::string& misdeed, const std::string& method = "gd") {
    return record_of(request_of(process_of(misbehaving("misbehaving.py " + misdeed)), method));
  }
  Record record_of_method(const std::string& word, const Budget& budget = {.iterations = 50}) {
    return record_of(
        request_of("rosenbrock", process_of(misbehaving("idle_optimizers.py " + word)), budget));
  }
  void expect_failed(const std::string& misdeed, const std::string& part) {
    const Record record = record_after(misdeed);
    EXPECT_EQ(record.status, Status::failed) << misdeed << ": " << record.message;
    EXPECT_NE(record.message.find(part), std::string::npos) << record.message;
  }

  TemporaryFolder folder;
  Store store{folder.path()};
  RunOptions options{.keeps_output = true};
};

TEST_F(ForeignCells, FailWithWhatTheOtherDid) {
  expect_failed("closes", "; it is still running");
  expect_failed("a-huge-frame", "9223372036854775808 bytes instead of 16");
  expect_failed("a-huge-complaint", "9223372036854775808 bytes; at most 65536");
  expect_failed("another-verb", "a frame of verb 99");
  expect_failed("two-answers", "sent data that was");
}

// One call of the run fails, which the record states.
TEST_F(ForeignCells, WhoseCallFailedSayWhereAndWhy) {
  for (const char* misdeed : {"raises", "raises-at-length"}) {
    const Record record = record_after(misdeed);
    EXPECT_FALSE(is_failure(record.status)) << misdeed << ": " << record.message;
    for (const char* part : {"the first at x = (1.2, 1)", "ValueError: the mesh"})
      EXPECT_NE(record.message.find(part), std::string::npos) << record.message;
    ASSERT_TRUE(record.failures);
    EXPECT_EQ(record.failures->total, 1);
    EXPECT_EQ(record.failures->x, (std::vector<std::vector<Real>>{{1.2, 1}}));
    EXPECT_NE(record.failures->reasons.at(0).find("ValueError: the mesh"), std::string::npos);
  }
}

// The store of calls answers for y, and the program fails when it is to remember that point for J.
TEST_F(ForeignCells, WhoseProgramFailsAtAKnownPointSayWhy) {
  const auto script = folder.path() / "later.py", mark = folder.path() / "mark";
  write_text(
      script,
      "import os, sys, isoline\n"
      "calls = []\n"
      "def forward(x):\n"
      "    calls.append(x)\n"  // the first tells how many numbers y has
      "    if calls[1:] and os.path.exists(sys.argv[1]): raise ValueError('the mesh is tangled')\n"
      "    return [10 * (x[1] - x[0] * x[0]), 1 - x[0]]\n"
      "isoline.problem(forward, [-1.2, 1], jacobian=lambda x: [[-20 * x[0], 10], [-1, 0]])\n");
  const std::string problem = process_of("python3 " + script.string() + " " + mark.string());
  record_of(request_of(problem, "nlopt-neldermead"));
  write_text(mark, "");
  const Record record = record_of(request_of(problem, "gd"));
  ASSERT_TRUE(record.failures) << record.message;
  EXPECT_NE(record.failures->reasons.at(0).find("ValueError: the mesh"), std::string::npos);
}

// The first program waits for the copy, which starts with the first points that are asked at once.
TEST_F(ForeignCells, WhoseCopyAloneHasNoNumberSaySo) {
  const auto script = folder.path() / "copies.py", mark = folder.path() / "mark";
  write_text(script,
             "import isoline, os, sys, time\n"
             "mark = sys.argv[1][5:]\n"
             "def forward(x):\n"
             "    if os.environ['ISOLINE_WORKER'] == '1':\n"
             "        open(mark, 'w').close()\n"
             "        return [x[0] - 1, float('nan'), 5 - x[1]]\n"
             "    for _ in range(100):\n"
             "        if os.path.exists(mark): break\n"
             "        time.sleep(0.01)\n"
             "    return [x[0] - 1, x[0] * x[1], 5 - x[1]]\n"
             "isoline.problem(forward, [3, 4], target=[0, 0, 0], name='copies')\n");
  const std::string problem =
      process_of("python3 " + script.string() + " mark=" + mark.string(), ",workers=2");
  const Record record = record_of(request_of(problem, "dfo-gn", {.iterations = 50, .work = 40}));
  EXPECT_NE(record.output.find("copy 1"), std::string::npos) << record.output;
}

// Rosenbrock's valley where x₂ > 1.2 fails: by an exception, by the end of the script, or by a call
// that takes too long.
TEST_F(ForeignCells, GoOnAfterAFailedCallHoweverItFailed) {
  const auto script = folder.path() / "fails.py";
  write_text(script,
             "import os, sys, time, isoline\n"
             "def fail():\n"
             "    if sys.argv[1] == 'raises': raise KeyError('mesh')\n"
             "    if sys.argv[1] == 'exits': os._exit(7)\n"
             "    time.sleep(600)\n"
             "def forward(x):\n"
             "    return fail() if x[1] > 1.2 else [10 * (x[1] - x[0] * x[0]), 1 - x[0]]\n"
             "isoline.problem(forward, [-1.2, 1], truth=[1, 1],\n"
             "                jacobian=lambda x: [[-20 * x[0], 10], [-1, 0]])\n");
  const auto record_with = [&](const std::string& how, const std::string& method) {
    const std::string command = "python3 " + script.string() + " " + how;
    return record_of(request_of(process_of(command, ",call-time=0.3"), method));
  };
  const std::map<std::string, std::string> reasons = {
      {"raises", "KeyError"}, {"exits", "code 7"}, {"hangs", "within 0.3 s"}};
  for (const char* method : {"nlopt-neldermead", "nlopt-bobyqa", "levenberg-marquardt"}) {
    std::vector<Real> losses;
    for (const auto& [how, reason] : reasons) {
      const Record record = record_with(how, method);
      EXPECT_FALSE(is_failure(record.status)) << method << " " << how << ": " << record.message;
      EXPECT_LT(record.summary.loss, 0.5 * record.summary.start_loss) << method << " " << how;
      if (!losses.empty()) {
        EXPECT_EQ(record.curve.loss, losses) << method << " " << how;
      }
      losses = record.curve.loss;
      if (!record.failures) continue;  // a method that went around the region
      for (const std::string& each : record.failures->reasons)
        EXPECT_NE(each.find(reason), std::string::npos) << each;
      for (const auto& x : record.failures->x) EXPECT_GT(x[1], 1.2);
    }
  }
  EXPECT_TRUE(record_with("exits", "nlopt-neldermead").failures) << "the region was visited";
}

TEST_F(ForeignCells, EndAfterTooManyFailedCallsInARow) {
  const auto script = folder.path() / "fails.py";
  write_text(script,
             "import isoline, math, sys\n"
             "def forward(x):\n"
             "    if list(x) == [1.0, 2.0]: return x\n"
             "    if sys.argv[1] == 'raise': raise KeyError('mesh')\n"
             "    return [math.nan, x[1]]\n"
             "isoline.problem(forward, [1.0, 2.0], target=[0, 0], differences=True)\n");
  const std::string command = "python3 " + script.string();
  for (const std::string kind : {" raise", " nan"})
    for (const char* method : {"nlopt-neldermead", "nlopt-lbfgs", "levenberg-marquardt"})
      for (const int limit : {100, 10}) {  // the first is the default, which few make
        if (limit == 100 && std::string_view(method) != "nlopt-neldermead") continue;
        const std::string option = limit == 10 ? ",failures=10" : "";
        const Record ended = record_of(request_of(process_of(command + kind, option), method));
        EXPECT_EQ(ended.status, Status::failed) << method << kind;
        ASSERT_TRUE(ended.failures) << method << kind;
        EXPECT_EQ(ended.failures->total, limit) << method << kind;
        EXPECT_EQ(ended.summary.loss, 2.5) << "the best point is that of the start";
        EXPECT_NE(ended.message.find(std::to_string(limit) + " calls in a row"), std::string::npos)
            << ended.message;
      }
  const Record one =
      record_of(request_of(process_of(command + " raise", ",failures=1"), "nlopt-neldermead"));
  EXPECT_EQ(one.status, Status::failed);
  EXPECT_NE(one.message.find("KeyError"), std::string::npos) << one.message;
}

TEST_F(ForeignCells, TakeTheStepOfDifferencesThatTheirOptionNames) {
  const auto script = folder.path() / "line.py", log = folder.path() / "calls";
  write_text(
      script,
      "import isoline, sys\n"
      "def forward(x):\n"
      "    print(*x, file=open(sys.argv[1], 'a'))\n"
      "    return [x[0], x[1]]\n"
      "isoline.problem(forward, [1.0, 2.0], target=[3, 4], differences=len(sys.argv) > 2)\n");
  const std::string command = fmt::format("python3 {} {}", script.string(), log.string());
  for (const std::string words : {"", " differences"}) {
    write_text(log, "");
    const std::string kind = words.empty() ? ",derivatives=central" : "";
    record_of(
        request_of(process_of(command + words, kind + ",difference-step=0.25:0.125"), "ceres-lm"));
    EXPECT_NE(read_text(log).find("1.25 2.0"), std::string::npos) << words;
    EXPECT_NE(read_text(log).find("1.0 2.25"), std::string::npos) << words;
  }
}

// Two of Rosenbrock's valleys, with a part that fails. Writes a letter per call, and kills
// Isoline's cell, the process above it, at call `every` of each program, as often as `kills` says.
TEST_F(ForeignCells, ThatWereKilledManyTimesAreAnsweredFromTheStoreAndEndAsOthers) {
  const auto script = folder.path() / "mortal.py", log = folder.path() / "calls",
             kills = folder.path() / "kills";
  write_text(
      script,
      "import os, signal, sys\n"
      "sys.modules['numpy'] = None  # a quick start\n"
      "import isoline\n"
      "log, kills = '" +
          log.string() + "', '" + kills.string() +
          "'\n"
          "every = 0\n"
          "if os.path.exists(kills): every, left = map(int, open(kills).read().split())\n"
          "calls = 0\n"
          "def count():\n"
          "    global calls\n"
          "    calls += 1\n"
          "    with open(log, 'a') as file: file.write('.')\n"
          "    if every == calls and left > 0:\n"
          "        with open(kills, 'w') as file: file.write(f'{every} {left - 1}')\n"
          "        os.kill(os.getppid(), signal.SIGKILL)\n"
          "def forward(x):\n"
          "    count()\n"
          "    if x[1] > 1.2 and len(sys.argv) == 1: raise KeyError('mesh')\n"
          "    return [10 * (x[1] - x[0] ** 2), 1 - x[0], 10 * (x[3] - x[2] ** 2), 1 - x[2]]\n"
          "def jacobian(x):\n"
          "    count()\n"
          "    return [[-20 * x[0], 10, 0, 0], [-1, 0, 0, 0],\n"
          "            [0, 0, -20 * x[2], 10], [0, 0, -1, 0]]\n"
          "isoline.problem(forward, [-1.2, 1, -1.1, 1.1], target=[0] * 4, jacobian=jacobian)\n");
  const std::string command = "python3 " + script.string();
  constexpr std::size_t kKills = 8;
  options.logs_calls = true;
  std::vector<std::string> methods = {"nlopt-bobyqa",
                                      "ceres-lm",
                                      "levenberg-marquardt",
                                      "dfo-gn",
                                      "levenberg-marquardt[jacobian=differences]",
                                      "eki"};
  if (const std::string python = python_with("scipy"); !python.empty())
    methods.push_back(process_of(example("scipy_optimize.py bfgs", python)));
  for (const std::string& method : methods) {
    const bool is_script = method.starts_with("process");  // whose line search fails for good
    const Request request = request_of(process_of(command + (is_script ? " safe" : "")), method,
                                       {.iterations = 40, .target = 0});
    options.force = true;
    write_text(log, "");
    std::filesystem::remove(kills);
    const Record uninterrupted = record_of(request);
    EXPECT_FALSE(is_failure(uninterrupted.status)) << method << ": " << uninterrupted.message;
    const Json whole = without_timings(to_json(uninterrupted));
    const std::size_t calls = read_text(log).size();
    ASSERT_GT(calls, 2 * kKills + 5) << method;
    std::filesystem::remove_all(store.folder() / "evaluations");
    const std::size_t every = std::max<std::size_t>(3, calls / (kKills + 1));
    write_text(kills, std::to_string(every) + " " + std::to_string(kKills));
    write_text(log, "");
    for (std::size_t kill = 0; kill < kKills; ++kill) {
      const Record record = record_of(request);
      ASSERT_EQ(record.status, Status::interrupted) << method << " " << kill << record.message;
      options.force = false;
    }
    EXPECT_EQ(without_timings(to_json(record_of(request))), whole) << method;
    // A call that was cut short is made again, and the point of a product that follows it.
    EXPECT_LE(read_text(log).size(), calls + 2 * kKills) << method;
  }
}

// Each point that the list names fails again, and of the curve those without a loss.
TEST_F(ForeignCells, OfAFeatureListEachFailedEvaluation) {
  const Record record =
      record_of(request_of("rosenbrock[fail=0.05]", "nlopt-neldermead", {.iterations = 500}));
  ASSERT_TRUE(record.failures);
  EXPECT_EQ(std::ssize(record.failures->x), record.failures->total);
  EXPECT_NE(record.message.find(fmt::format("{} evaluation", record.failures->total)),
            std::string::npos)
      << record.message;
  const Problem problem = make_problem(catalog(), record.request.problem, 0);
  const auto loss_at = [&](const std::vector<Real>& x) {
    problems::Point at;
    problem.forward(Eigen::Map<const Vector>(x.data(), std::ssize(x)), at);
    return at.loss;
  };
  for (const auto& x : record.failures->x) EXPECT_TRUE(std::isnan(loss_at(x)));
  for (std::size_t i = 0; i < record.trajectory->x.size(); ++i)
    EXPECT_EQ(std::isnan(loss_at(record.trajectory->x[i])), std::isnan(record.curve.loss[i])) << i;
}

// A failed member of an ensemble is left out, a step to a failed point is halved, and no method
// ends at a point without a loss.
TEST_F(ForeignCells, OfAFeatureThatFailsEndNoMethodAtAFailedPoint) {
  for (const char* method :
       {"eki", "etki", "uki", "gd[rate=1e-4]", "adam[rate=0.1]", "dfo-gn", "levenberg-marquardt",
        "gauss-newton", "gsl-multifit", "minpack-lmder", "nlopt-lbfgs", "ceres-lm", "cma-es"})
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      Request request = request_of(seed < 2 ? "rosenbrock[fail=0.05]" : "rosenbrock[fail=0.2]",
                                   method, {.iterations = 1000});
      request.seed = seed % 2;  // at 0 every second mean of uki fails
      const Record record = record_of(named(request));
      EXPECT_FALSE(is_failure(record.status)) << method << " " << seed << record.message;
      EXPECT_NE(record.status, Status::diverged) << method << " " << seed;
      EXPECT_LE(record.summary.loss, record.summary.start_loss) << method << " " << seed;
    }
  for (const std::string kind :
       {"differences", "central"}) {  // columns at a failed point cost no call
    const Record record = record_of(
        named(request_of("wood[fail=0.2]", "gauss-newton[jacobian=" + kind + "]", {.work = 2000})));
    EXPECT_FALSE(is_failure(record.status)) << kind << ": " << record.message;
    EXPECT_LE(record.summary.loss, record.summary.start_loss) << kind;
  }
}

TEST_F(ForeignCells, HaveTheNamesAndUnitsThatTheirScriptGives) {
  const auto script = folder.path() / "named.py";
  write_text(script,
             "import ast, sys, isoline\n"
             "names, units = map(ast.literal_eval, sys.argv[1:])\n"
             "isoline.problem(lambda x: x, [1.0, 2.0], names=names, units=units)\n");
  const auto record_with = [&](const std::string& names, const std::string& units) {
    return record_of(
        request_of(process_of(fmt::format("python3 {} {} {}", script.string(), names, units)),
                   "nlopt-bobyqa"));
  };
  const Record named = record_with("'[\"k\",\"c\"]'", "'[\"N/m\",None]'");
  ASSERT_TRUE(named.answer) << named.message;
  EXPECT_EQ(named.answer->names, (std::vector<std::string>{"k", "c"}));
  EXPECT_EQ(named.answer->units, (std::vector<std::string>{"N/m", ""}));
  write_text(folder.path() / "in.tpl", "~ k ~ ~ c ~");
  const auto calibrate = folder.path() / "calibrate.py";
  write_text(
      calibrate,
      "import isoline, sys\n"
      "isoline.problem(isoline.command(run='cat in.txt', template=sys.argv[1]), [1.0, 2.0])\n");
  const Record of_template =
      record_of(request_of(process_of(fmt::format("python3 {} {}", calibrate.string(),
                                                  (folder.path() / "in.tpl").string())),
                           "nlopt-bobyqa", {.iterations = 2}));
  EXPECT_EQ(of_template.answer->names, (std::vector<std::string>{"k", "c"}));
  const Record unnamed = record_with("None", "None");
  EXPECT_TRUE(unnamed.answer->names.empty() && unnamed.answer->units.empty());
  for (const char* wrong : {"'[\"k\"]'", "'\"kc\"'", "'[\"a\\nb\",\"c\"]'"})
    EXPECT_NE(refusal([&] { record_with(wrong, "None"); }).find("names"), std::string::npos);
}

// Layers that are too thin for any point to lie in one.
TEST_F(ForeignCells, OrOthersAreTheSameWhereTheRegionOfFailuresIsNeverVisited) {
  for (const char* method : {"levenberg-marquardt", "nlopt-neldermead", "gd"}) {
    const Record plain = record_of(request_of("rosenbrock", method));
    const Record failing = record_of(request_of("rosenbrock[fail=1e-15]", method));
    EXPECT_EQ(failing.curve.loss, plain.curve.loss) << method;
    EXPECT_EQ(failing.curve.work, plain.curve.work) << method;
    EXPECT_FALSE(failing.failures || plain.failures) << method;
  }
}

TEST_F(ForeignCells, WhoseProgramWasKilledAreInterrupted) {
  EXPECT_EQ(record_after("is-killed").status, Status::interrupted);
}

// The plan starts the first program, the cell the second, and the verifier the third.
TEST_F(ForeignCells, WhoseProgramWasKilledAtItsStartOrInTheVerifierRunAgain) {
  const auto script = folder.path() / "mortal.py", log = folder.path() / "programs";
  write_text(script,
             "import os, signal, sys, isoline\n"
             "log = '" +
                 log.string() +
                 "'\n"
                 "open(log, 'a').write('.')\n"
                 "if os.path.getsize(log) > int(sys.argv[1]):\n"
                 "    os.kill(os.getpid(), signal.SIGKILL)\n"
                 "isoline.problem(lambda x: [x[0]], [1.0], jacobian=lambda x: [[1.0]])\n");
  for (const std::size_t spared : {1U, 2U}) {
    write_text(log, "");
    const Request request =
        request_of(process_of("python3 " + script.string() + " " + std::to_string(spared)), "gd");
    const Record record = record_of(request);
    EXPECT_EQ(record.status, Status::interrupted) << record.message;
    EXPECT_EQ(record.curve.iteration.empty(), spared == 1) << "the cell's own program";
    EXPECT_EQ(run_all(catalog(), {request}, store, options).run, 1) << "it runs again";
  }
}

TEST_F(ForeignCells, OfOneThatPrintsAGigabyteKeepItsBeginning) {
  options.limits.hard_seconds = 60;
  const Record record = record_after("floods");
  EXPECT_EQ(record.status, Status::budget) << record.message;
  EXPECT_GE(record.output.size(), CapturedOutput::kMost);
  EXPECT_LT(record.output.size(), CapturedOutput::kMost + 100);
  EXPECT_NE(record.output.find("bytes more"), std::string::npos);
}

TEST_F(ForeignCells, OfOneThatAnswersTooLateAreTimedOutAndNoneReturnsAPointWithoutALoss) {
  const Record record = record_after("is-not-finite", "gd[rate=1]");
  EXPECT_NE(record.status, Status::diverged) << record.message;
  EXPECT_TRUE(std::isfinite(record.summary.loss)) << record.message;
  options.limits.hard_seconds = 0.4;  // of processor time; five times that on the wall
  EXPECT_EQ(record_after("hangs").status, Status::timeout);
}

TEST_F(ForeignCells, TakeWhatTheirProgramStartedWithThem) {
  const auto file = folder.path() / "process";
  const Record record = record_after("forks file=" + file.string());
  EXPECT_EQ(record.status, Status::budget) << record.message;
  pid_t process = 0;
  std::ifstream(file) >> process;
  ASSERT_GT(process, 0);
  const auto figures = figures_of(process);
  EXPECT_FALSE(figures && figures->resident_bytes > 0);
}

TEST_F(ForeignCells, WithoutAProductAreInapplicableWithTheReason) {
  const std::string alone = process_of(misbehaving("offers.py forward"));
  const Record gradient = record_of(request_of(alone, "gd"));
  EXPECT_EQ(gradient.status, Status::inapplicable);
  EXPECT_NE(gradient.message.find("gradients"), std::string::npos);
  const Record simplex = record_of(request_of(alone, "nlopt-neldermead"));
  EXPECT_NE(simplex.status, Status::inapplicable);
  EXPECT_FALSE(is_failure(simplex.status)) << simplex.message;
  EXPECT_LT(simplex.summary.loss, simplex.summary.start_loss);
  const std::string pulls = process_of(misbehaving("offers.py vjp"));
  EXPECT_NE(record_of(request_of(pulls, "gauss-newton")).status, Status::inapplicable);
}

// --- certificates

TEST_F(ForeignCells, AreRunOnlyWhereTheProblemIsCertified) {
  const auto complaint = [&](const std::string& misdeed) {
    const Request request = request_of(process_of(misbehaving("misbehaving.py " + misdeed)), "gd");
    return refusal([&] { run_plan(catalog(), "trial", {request}, folder.path(), options, {}); });
  };
  const std::string sign = complaint("has-a-wrong-sign"), random = complaint("is-random");
  EXPECT_NE(sign.find("falls as h²"), std::string::npos) << sign;
  EXPECT_NE(random.find("gives the same bits"), std::string::npos) << random;
  EXPECT_NE(complaint("always-raises").find("mesh is tangled"), std::string::npos) << "the reason";
  EXPECT_NE(complaint("two-answers").find("cannot be checked"), std::string::npos)
      << "no certificate, no cells";
  EXPECT_EQ(complaint("is-sound"), "");
}

// The few checks of a slow program take the step of its differences.
TEST_F(ForeignCells, OfASlowProgramThatPrintsSixDigitsAreCertified) {
  const auto script = folder.path() / "six_digits.py";
  write_text(script,
             "import math, time, isoline\n"
             "def forward(x):\n"
             "    time.sleep(0.11)\n"
             "    y = [x[0] * math.exp(-x[1] * t) * math.cos(3 * t) for t in range(9)]\n"
             "    return [float(f'{each:.6g}') for each in y]\n"
             "isoline.problem(forward, start=[2.0, 0.3], target=[1.0] * 9, differences=True)\n");
  const Request request =
      request_of(process_of("python3 " + script.string()), "levenberg-marquardt", {.work = 1});
  EXPECT_EQ(refusal([&] { run_plan(catalog(), "trial", {request}, folder.path(), options, {}); }),
            "");
}

TEST_F(ForeignCells, WaitForACertificateThatSaysHowFarItIs) {
  const auto script = folder.path() / "slow.py";
  write_text(script,
             "import time, isoline\n"
             "def forward(x):\n"
             "    time.sleep(0.01)\n"
             "    return [x[0]]\n"
             "isoline.problem(forward, start=[1.0], jacobian=lambda x: [[1.0]])\n");
  const Request request =
      request_of(process_of("python3 " + script.string()), "gd", {.iterations = 1});
  options.progress = Progress::Style::live;
  testing::internal::CaptureStderr();
  run_plan(catalog(), "trial", {request}, folder.path(), options, {});
  const std::string shown = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(std::regex_search(shown, std::regex("[0-9]+ of [0-9]+ checks"))) << shown;
}

TEST_F(ForeignCells, OfAnUncheckedProblemAreMarkedInEachTable) {
  const Request sound = request_of(kValley, "gd");
  run_plan(catalog(), "trial", {sound}, folder.path(), options, {});
  options.uncertified = true;
  const Request wrong =
      request_of(process_of(misbehaving("misbehaving.py has-a-wrong-sign")), "gd");
  const Request known = request_of(kValley, "levenberg-marquardt");
  run_plan(catalog(), "trial", {wrong, known}, folder.path(), options, {});
  std::size_t marked = 0, all = 0;
  for (const std::string& name : names_in(folder.path() / "runs")) {
    const Record record = read_record(folder.path() / "runs" / name);
    const bool is_marked = record.foreign.problem->label.ends_with(" (uncertified)");
    EXPECT_EQ(is_marked, record.cell == wrong.cell) << "the other one has a certificate";
    marked += is_marked;
    ++all;
  }
  EXPECT_EQ(marked, 1U);
  EXPECT_EQ(all, 3U);
}

// A program that writes a line per call, of 0.11 s each: the process that it computes for.
class SlowProgram : public ForeignCells {
 protected:
  Request request_with(const std::string& derivatives, const std::string& method) {
    write_text(script,
               "import os, signal, time, isoline\n"
               "log, mortal = '" +
                   log.string() + "', '" + mortal.string() +
                   "'\n"
                   "def forward(x):\n"
                   "    with open(log, 'a') as file: file.write(f'{os.getppid()}\\n')\n"
                   "    time.sleep(0.11)\n"
                   "    if os.path.exists(mortal):\n"
                   "        with open(log) as file: calls = len(list(file))\n"
                   "        if calls == 4: os.kill(os.getppid(), signal.SIGKILL)\n"
                   "    return [x[0] ** 2 - x[1], 2 * x[1]]\n"
                   "isoline.problem(forward, [1.0, 1.0], target=[0, 0], minimum=0" +
                   derivatives + ")\n");
    write_text(log, "");
    return request_of(process_of("python3 " + script.string()), method, {.work = 12});
  }
  // Calls for each process, in the order of its first.
  std::vector<std::size_t> calls() const {
    std::vector<std::string> processes;
    std::vector<std::size_t> counts;
    std::istringstream lines(read_text(log));
    for (std::string line; std::getline(lines, line);) {
      if (processes.empty() || processes.back() != line) {
        processes.push_back(line);
        counts.push_back(0);
      }
      ++counts.back();
    }
    return counts;
  }
  std::int64_t run(const Request& request) {
    return run_plan(catalog(), "trial", {request}, folder.path(), options, {}).run;
  }
  std::optional<Calls> stated_calls(std::int64_t work) const {
    for (const std::string& name : names_in(folder.path() / "runs"))
      if (Record record = read_record(folder.path() / "runs" / name);
          record.request.budget.work == work)
        return record.calls;
    return std::nullopt;
  }

  std::filesystem::path script = folder.path() / "slow.py", log = folder.path() / "calls",
                        mortal = folder.path() / "mortal";
};

// The metadata make none, and the verification one.
TEST_F(SlowProgram, MakesTheAnnouncedCallsThoseOfItsCellAndOneForTheVerifier) {
  options.progress = Progress::Style::plain;
  const std::map<std::string, std::size_t> expected = {
      {"", 3}, {", jacobian=lambda x: [[2 * x[0], -1], [0, 2]]", 9}, {", differences=True", 13}};
  for (const auto& [derivatives, count] : expected) {
    const Request request = request_with(derivatives, "nlopt-neldermead");
    std::filesystem::remove_all(folder.path() / "runs");  // of the other scripts, and the same cell
    testing::internal::CaptureStderr();
    EXPECT_EQ(run(request), 1);
    const std::string shown = testing::internal::GetCapturedStderr();
    std::smatch found;
    ASSERT_TRUE(std::regex_search(shown, found, std::regex("([0-9]+) calls of [0-9.]+ s")))
        << shown;
    EXPECT_EQ(std::stoul(found[1]), count) << derivatives;
    const std::vector<std::size_t> made = calls();
    ASSERT_EQ(made.size(), 3U) << derivatives << ": the checks, the cell and the verifier";
    EXPECT_LE(made[0], count) << derivatives;
    EXPECT_GE(made[0] + 3, count) << derivatives << ": differences may ask for a point twice";
    EXPECT_EQ(made[2], 1U) << derivatives;
    if (derivatives.empty()) {
      EXPECT_EQ(made[1], 10U) << "the checks have made the call at the start";
    }
    const std::optional<Calls> stated = stated_calls(12);
    ASSERT_TRUE(stated);
    const bool has_products = derivatives.find("jacobian") != std::string::npos;
    if (!has_products) {  // the script logs none
      EXPECT_EQ(stated->made, made[1]);
    }
    EXPECT_EQ(stated->verified, 1);
    EXPECT_EQ(stated->failed, 0);
    EXPECT_EQ(run(request), 0);
    std::vector<std::size_t> again = made;
    again.push_back(1);
    EXPECT_EQ(calls(), again) << "a second run makes the returned point's";
    EXPECT_EQ(run(request_of(request.problem.spec, "nlopt-neldermead", {.work = 18})), 1);
    const std::optional<Calls> after = stated_calls(18);
    ASSERT_TRUE(after);
    EXPECT_GE(after->answered, made[1]) << "the calls of the shorter run";
    EXPECT_GT(after->made, 0);
    EXPECT_TRUE(names_in(folder.path() / "checkpoints").empty());
    const Component& problem = request.problem;
    Sheet sheet{.kind = "problem", .name = problem.name, .spec = problem.spec};
    const auto file = folder.path() / "components" / sheet.file_name();
    sheet = sheet_from_text(read_text(file), file.string());
    ASSERT_TRUE(sheet.prices.has_value());
    EXPECT_GE(sheet.prices->forward_seconds, 0.11);
  }
}

// At the fourth call of its checks, which is made again.
TEST_F(SlowProgram, WhoseChecksWereKilledMakesTheOthersAlone) {
  const Request request = request_with(", jacobian=lambda x: [[2 * x[0], -1], [0, 2]]", "gd");
  write_text(mortal, "");
  EXPECT_EQ(refusal([&] { EXPECT_EQ(run(request), 0) << "interrupted"; }), "");
  EXPECT_EQ(calls(), std::vector<std::size_t>{4});
  std::filesystem::remove(mortal);
  EXPECT_EQ(run(request), 1);
  const std::vector<std::size_t> made = calls();
  ASSERT_EQ(made.size(), 5U) << "the checks, a stored point again, the other checks, the cell, the "
                                "verifier";
  EXPECT_EQ(made[1], 1U);
  constexpr std::size_t kAfresh = 2;  // of the checks whether a call repeats
  EXPECT_EQ(made[2], 9U - 3U + kAfresh);
}

TEST_F(ForeignCells, HandOverACopyOfX) {
  const Request changes =
      request_of(process_of(misbehaving("misbehaving.py changes-its-argument")), "gd");
  EXPECT_EQ(refusal([&] { run_plan(catalog(), "trial", {changes}, folder.path(), options, {}); }),
            "");
}

// What a program counts: its forwards.
TEST_F(ForeignCells, AreCertifiedOncePerFolderAndBuild) {
  const auto script = folder.path() / "counts.py", log = folder.path() / "calls";
  const std::string text =
      "import isoline\n"
      "def forward(x):\n"
      "    open('" +
      log.string() +
      "', 'a').write('.')\n"
      "    return [x[0], 2 * x[1]]\n"
      "isoline.problem(forward, start=[1.0, 1.0], jacobian=lambda x: [[1, 0], [0, 2]])\n";
  const auto calls_of = [&](std::uint64_t seed) {
    write_text(log, "");
    Request request = request_of(process_of("python3 " + script.string()), "gd", {.iterations = 1});
    request.seed = seed;
    run_plan(catalog(), "trial", {named(request)}, folder.path(), options, {});
    return read_text(log).size();
  };
  constexpr std::size_t kCertificate = 20;  // fewer than its forwards, for all that it checks
  write_text(script, text);
  const std::size_t first = calls_of(0), second = calls_of(1);
  EXPECT_LT(second + kCertificate, first);
  write_text(script, text + "# edited\n");
  EXPECT_GT(calls_of(1), second + kCertificate);
}

// --- options that a program declares

TEST_F(ForeignCells, HaveTheOptionsThatTheirProgramDeclares) {
  const auto rods = folder.path() / "rods.py", descent = folder.path() / "descent.py";
  write_text(rods,
             "import isoline\n"
             "n = isoline.option('n', 2)\n"
             "isoline.problem(lambda x: list(x), start=[0.0] * n, jacobian=lambda x: None, "
             "name='rods')\n");
  write_text(descent,
             "import isoline\n"
             "rate = isoline.option('rate', 0.25, tunable=True)\n"
             "p = isoline.optimizer(needs=['pullback'], reports=True)\n"
             "x = list(p.x0)\n"
             "while True:\n"
             "    x = [a - rate * b for a, b in zip(x, p.gradient(x))]\n"
             "    p.report(x)\n");
  const std::string command = "python3 " + rods.string();
  const Component usual = complete_problem(catalog(), parse_spec(process_of(command)));
  const Component larger = complete_problem(catalog(), parse_spec(process_of(command, ",n=5")));
  EXPECT_EQ(make_problem(catalog(), usual, 0).unknowns(), 2);
  EXPECT_EQ(make_problem(catalog(), larger, 0).unknowns(), 5);
  EXPECT_EQ(usual.foreign->label, "rods");
  EXPECT_EQ(larger.foreign->label, "rods[n=5]");
  EXPECT_NE(request_of(process_of(command), "gd").cell,
            request_of(process_of(command, ",n=5"), "gd").cell);
  EXPECT_NE(refusal([&] { request_of(process_of(command, ",m=5"), "gd"); }), "");
  EXPECT_NE(refusal([&] { request_of(process_of(command, ",n=2.5"), "gd"); }), "");
  const std::string method = "python3 " + descent.string();
  const auto loss_at = [&](const std::string& more) {
    return record_of(request_of("square", process_of(method, more), {.iterations = 1}))
        .summary.loss;
  };
  EXPECT_NE(loss_at(""), loss_at(",rate=0.125"));
  const OptionValues of_method = options_of(parse_spec(process_of(method)));
  EXPECT_EQ(entry_of(catalog(), "process", of_method).tunable.option, "rate");
}

// --- records and builds

// The digest of the old script must not stand beside results of the new one.
TEST_F(ForeignCells, OfAScriptThatIsEditedDuringTheRunAreInterrupted) {
  const auto script = folder.path() / "mine.py";
  const std::string original = read_text(ISOLINE_SOURCE_DIR "/tests/clients/misbehaving.py");
  write_text(script, original);
  const Request during =
      request_of(process_of("python3 " + script.string() + " edits-itself"), "gd");
  const Request before = request_of(process_of("python3 " + script.string() + " is-sound"), "gd");
  EXPECT_EQ(record_of(before).status, Status::budget);
  EXPECT_EQ(record_of(during).status, Status::interrupted) << "edited while the cell ran";
  options.force = true;
  EXPECT_EQ(record_of(before).status, Status::interrupted) << "edited before the cell began";
  write_text(script, original);
  EXPECT_EQ(record_of(before).status, Status::budget);
}

TEST_F(ForeignCells, SayWhoComputedThem) {
  const Record record = record_of(request_of(kValley, process_of(example("descent.py"))));
  ASSERT_TRUE(record.foreign.problem && record.foreign.optimizer);
  EXPECT_EQ(record.foreign.problem->door, "process");
  EXPECT_EQ(record.foreign.problem->command, example("rosenbrock.py"));
  EXPECT_EQ(record.foreign.problem->label, "rosenbrock-python");
  EXPECT_TRUE(record.foreign.problem->interpreter.find("Python 3.") != std::string::npos);
  EXPECT_EQ(record.foreign.optimizer->label, "descent-python");
  const Json json = to_json(record);
  EXPECT_EQ(schema_violations(json, schema("run")), std::vector<std::string>{});
  EXPECT_EQ(to_json(record_from_text(json_text(json), "it")), json);
  EXPECT_FALSE(to_json(record_of(request_of("rosenbrock", "gd"))).contains("foreign"));
}

TEST_F(ForeignCells, OfAChangedScriptAreOfAnotherBuild) {
  const auto script = folder.path() / "mine.py";
  const std::string spec = process_of("python3 " + script.string());
  const auto written = [&](const std::string& factor) {
    std::ofstream(script) << "import isoline\nisoline.problem(lambda x: [" << factor
                          << " * x[0]], [1], jacobian=lambda x: [[" << factor << "]])\n";
    return request_of(spec, "gd");
  };
  const Request first = written("2"), again = written("2"), changed = written("3");
  EXPECT_EQ(build_digest(first), build_digest(again));
  EXPECT_EQ(first.cell, changed.cell) << "the same was asked";
  const BuildParts before = build_parts(first), after = build_parts(changed);
  for (const auto& [part, one] : before)
    EXPECT_EQ(one == after.at(part), part != "problem") << part;
}

// --- optimizers

TEST_F(ForeignCells, OfAnOptimizerAreCountedAndTraced) {
  const Record record =
      record_of(request_of("rosenbrock", process_of(example("descent.py")), {.iterations = 30}));
  EXPECT_EQ(record.status, Status::budget) << record.message << record.output;
  EXPECT_EQ(record.summary.iterations, 30);
  const auto count = [&](Oracle oracle) { return record.counts[static_cast<std::size_t>(oracle)]; };
  EXPECT_EQ(count(Oracle::forward), 31) << "the start, then one an iteration";
  EXPECT_EQ(count(Oracle::pullback), 31);
  EXPECT_LT(record.summary.loss, record.summary.start_loss);
  EXPECT_EQ(record.curve.iteration.size(), 31U);
}

TEST_F(ForeignCells, OfAnOptimizerKeepWhatItClaimsAndPrintsAndFailWithWhatItDid) {
  const Record record = record_of_method("talks");
  EXPECT_EQ(record.status, Status::unconfirmed) << record.message;
  EXPECT_EQ(record.claimed, "a small loss, I believe");
  EXPECT_EQ(record.output, "what I think of it\n");
  EXPECT_EQ(record.counts[0], 1)
      << "it called no oracle and returned an x that was never evaluated";
  const Record refused = record_of_method("asks-what-it-did-not-declare");
  EXPECT_EQ(refused.status, Status::failed);
  EXPECT_NE(refused.message.find("'jacobian'"), std::string::npos) << refused.message;
  EXPECT_NE(record_of_method("raises").message.find("ValueError: the step"), std::string::npos);
  EXPECT_NE(record_of_method("leaves").message.find("it exited with code 4"), std::string::npos);
  EXPECT_NE(record_of_method("forgets").message.find("ended without finish"), std::string::npos);
  const Record endless = record_of_method("never-stops", {.work = 40});
  EXPECT_EQ(endless.status, Status::budget) << endless.message;
  EXPECT_LE(endless.summary.work, 42);
}

TEST_F(ForeignCells, OfAProblemFromOutsideHaveTheTraceOfTheTreesOwn) {
  const std::string valley = valley_of_this_build();
  for (const char* method : {"levenberg-marquardt", "gd[rate=1e-3]", "nlopt-lbfgs", "newton"}) {
    const Budget budget{.iterations = 60, .target = 0};
    const Record ours = record_of(request_of("rosenbrock", method, budget));
    const Record theirs = record_of(request_of(valley, method, budget));
    if (std::string_view(method) == "newton") {
      EXPECT_EQ(theirs.status, Status::inapplicable) << "it offers no second derivatives";
      continue;
    }
    EXPECT_EQ(ours.curve.loss, theirs.curve.loss) << method;
    EXPECT_EQ(ours.curve.x_error, theirs.curve.x_error) << method;
    EXPECT_EQ(ours.curve.step_norm, theirs.curve.step_norm) << method;
    EXPECT_EQ(ours.counts, theirs.counts) << method;
    EXPECT_EQ(ours.verified, theirs.verified) << method;
    EXPECT_GE(ours.curve.loss.size(), 5U) << method;
  }
}

// "nfev=17 njev=12" at the end of what the example claims.
std::pair<std::int64_t, std::int64_t> counts_of_scipy(const std::string& claimed) {
  const std::size_t nfev = claimed.rfind("nfev="), njev = claimed.rfind("njev=");
  if (nfev == std::string::npos || njev == std::string::npos) return {-1, -1};
  return {std::atoll(claimed.c_str() + nfev + 5), std::atoll(claimed.c_str() + njev + 5)};
}

// SciPy's own counts. Of `lm` they are MINPACK's: a step that rounds to nothing asks the same point
// again, which is one forward here, and least_squares asks for a last Jacobian that it leaves out.
TEST_F(ForeignCells, OfScipyCountWhatScipyCounts) {
  const std::string python = python_with("scipy");
  if (python.empty()) GTEST_SKIP() << "SciPy is not installed";
  const Budget endless{.iterations = 100'000, .target = -1};  // no loss is small enough
  for (const std::string method : {"lm", "trf", "bfgs", "l-bfgs-b"})
    for (const char* problem : {"rosenbrock", "helical-valley", "powell-singular"}) {
      SCOPED_TRACE(method + " on " + problem);
      const Record record = record_of(
          request_of(problem, process_of(example("scipy_optimize.py " + method, python)), endless));
      ASSERT_TRUE(record.status == Status::converged || record.status == Status::unconfirmed)
          << record.message;
      const bool is_least_squares = method == "lm" || method == "trf";
      const auto asked = [&](Oracle oracle) {
        return record.counts[static_cast<std::size_t>(oracle)];
      };
      const auto [nfev, njev] = counts_of_scipy(record.claimed);
      const std::int64_t slopes = asked(is_least_squares ? Oracle::jacobian : Oracle::pullback);
      const bool is_exact = method != "lm" || problem == std::string("rosenbrock");
      EXPECT_LE(asked(Oracle::forward), nfev) << record.claimed;
      EXPECT_GE(asked(Oracle::forward), is_exact ? nfev : nfev - 1) << record.claimed;
      EXPECT_GE(slopes, njev) << record.claimed;
      EXPECT_LE(slopes, is_exact ? njev : njev + 1) << record.claimed;
      EXPECT_EQ(record.foreign.optimizer->label, "scipy-" + method);
      EXPECT_TRUE(record.verified.at("1e-3").value_or(false));
    }
}

// A program that declares keeps_bounds gets them, and fails where it leaves them.
TEST_F(ForeignCells, OfMethodsThatKeepBoundsStayWithinThem) {
  const std::string problem = "poisson[N=4,bounds=active]";
  const auto record_within = [&](const std::string& word, const Budget& budget) {
    return record_of(
        request_of(problem, process_of(misbehaving("idle_optimizers.py " + word)), budget));
  };
  const Budget budget{.iterations = 5000, .target = 0};
  const Record own = record_within("descends-within-bounds", budget);
  EXPECT_FALSE(is_failure(own.status)) << own.message;
  EXPECT_LT(own.curve.kkt_residual.back(), 1e-6 * own.curve.gradient_norm.front());
  EXPECT_GT(own.curve.gradient_norm.back(), 1e-3);
  const Record native = record_of(request_of(problem, "gd[rate=0.5]", budget));
  EXPECT_NEAR(own.summary.loss, native.summary.loss, 1e-12 * own.summary.start_loss);
  EXPECT_TRUE(native.is_best_known) << "f_L is the loss of a fit";
  for (const std::string word : {"leaves-its-bounds", "finishes-outside-its-bounds"}) {
    const Record record = record_within(word, {.iterations = 50});
    EXPECT_EQ(record.status, Status::failed) << word << ": " << record.message;
    const std::string component = word.starts_with("leaves") ? "component 3" : "component 0";
    EXPECT_NE(record.message.find(component), std::string::npos) << record.message;
    EXPECT_NE(record.message.find(word), std::string::npos) << record.message;
  }
  const Record ignorant = record_within("talks", {.iterations = 50});
  EXPECT_EQ(ignorant.status, Status::inapplicable) << ignorant.message;
  EXPECT_NE(ignorant.message.find("keeps_bounds"), std::string::npos) << ignorant.message;
}

TEST_F(ForeignCells, OfScipySolveWithinBounds) {
  const std::string python = python_with("scipy");
  if (python.empty()) GTEST_SKIP() << "SciPy is not installed";
  for (const std::string method : {"trf", "dogbox", "l-bfgs-b", "slsqp", "lm"}) {
    SCOPED_TRACE(method);
    const std::string tight = method == "l-bfgs-b" ? " ftol=0 gtol=1e-10" : "";
    const Record record =
        record_of(request_of("burgers[N=16,bounds=active]",
                             process_of(example("scipy_optimize.py " + method + tight, python)),
                             {.iterations = 100'000, .target = 0}));
    EXPECT_EQ(record.status == Status::inapplicable, method == "lm") << record.message;
    if (method == "lm") continue;
    EXPECT_FALSE(is_failure(record.status)) << record.message;
    // By as much as their own tests of convergence allow.
    EXPECT_LT(record.summary.loss, 1.01 * *record.minimum);
    EXPECT_LT(record.curve.kkt_residual.back(), 1e-2 * record.curve.gradient_norm.back());
  }
}

// Peers that call residuals or losses alone, each with its package.
TEST_F(ForeignCells, OfPeersSolveWithoutDerivatives) {
  const std::string petsc =  // not on the path of Debian's Python
      "glob, sys; sys.path += "
      "glob.glob(\"/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages\"); import numpy, petsc4py";
  std::string missing;
  for (const auto& [package, script] : {std::pair<std::string, std::string>{petsc, "pounders.py"},
                                        {"cmaes", "cma_es.py"},
                                        {"scipy", "scipy_optimize.py trf jac=2-point"},
                                        {"scipy", "scipy_optimize.py bfgs jac=3-point"},
                                        {"dfols", "dfo_ls.py"}}) {
    const std::string python = python_with(package);
    if (python.empty()) {
      missing += ' ' + script;
      continue;
    }
    const std::string problem = "rosenbrock[derivatives=none]";
    const auto record_within = [&](std::int64_t work) {
      return record_of(request_of(problem, process_of(example(script, python)),
                                  {.iterations = 100'000, .work = work, .target = 1e-5}));
    };
    const Record record = record_within(2000);
    EXPECT_EQ(record.status, Status::target) << script << ": " << record.message;
    EXPECT_EQ(record_within(20).status, Status::budget) << script;
  }
  if (!missing.empty()) GTEST_SKIP() << "the packages of these scripts are missing:" << missing;
}

TEST_F(ForeignCells, OfTorchReportEachOfItsSteps) {
  const std::string python = python_with("torch");
  if (python.empty()) GTEST_SKIP() << "PyTorch is not installed";
  const Record record = record_of(
      request_of("rosenbrock", process_of(example("torch_lbfgs.py", python)), {.iterations = 60}));
  EXPECT_TRUE(record.verified.at("1e-3").value_or(false)) << record.message;
  EXPECT_GT(record.summary.iterations, 5);
}

}  // namespace
}  // namespace isoline::benchmarks
