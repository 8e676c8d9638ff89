// Shared libraries with the struct of core/foreign/isoline.h: the same runs as components of the
// tree, and an error that names the library wherever it violates a rule; --plugin and `isoline
// new`.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/catalog.h"
#include "core/files.h"
#include "core/foreign/plugin_library.h"
#include "core/records/record.h"
#include "problems/conformance.h"
#include "problems/problem.h"
#include "tests/benchmarks/matrix.h"
#include "tests/cli/shell.h"
#include "tests/refusal.h"

namespace isoline::benchmarks {
using problems::examine;
using problems::Finding;

namespace {

// Catalogs with the libraries that the tests build, and cells run on them.

const std::string kPlugins = ISOLINE_PLUGINS;
const std::string kTrials = kPlugins + "/trials.so";

// As long as it lives one thing is wrong with the first component of trials.so.
class Defect {
 public:
  explicit Defect(const char* name) { setenv("ISOLINE_DEFECT", name, 1); }
  ~Defect() { unsetenv("ISOLINE_DEFECT"); }
  Defect(const Defect&) = delete;
  Defect& operator=(const Defect&) = delete;
};

Catalog catalog_with(const std::vector<std::string>& libraries) {
  Catalog catalog = builtin_catalog();
  for (const std::string& library : libraries) add_plugin(catalog, kPlugins + "/" + library);
  return catalog;
}

FinishedMatrix run(const Catalog& catalog, const std::vector<std::string>& problems,
                   const std::vector<std::string>& optimizers) {
  const Suite suite{.name = "plugin",
                    .title = "",
                    .blocks = {{.problems = problems,
                                .optimizers = optimizers,
                                .seeds = {0},
                                .budget = {.iterations = 300, .work = 3000}}}};
  return {catalog, suite, {}};
}

// All that happened, to the last bit, whatever the components are called.
void expect_same_run(const Record& one, const Record& other) {
  const auto happened = [](const Record& record) {
    const Json all = without_timings(to_json(record));
    Json kept;
    for (const char* name : {"status", "counts", "verified", "found", "curve", "trajectory"})
      kept[name] = all.at(name);
    return kept;
  };
  EXPECT_EQ(happened(one), happened(other)) << title_of(one) << " and " << title_of(other);
  EXPECT_GT(one.curve.iteration.size(), 5U);
}

void expect_same_runs(const FinishedMatrix& ours, const FinishedMatrix& theirs, std::size_t count) {
  ASSERT_EQ(ours.records.size(), count);
  ASSERT_EQ(theirs.records.size(), count);
  for (std::size_t i = 0; i < count; ++i) expect_same_run(ours.records[i], theirs.records[i]);
}

TEST(Plugin, AProblemOrAMethodGivesTheSameTraceAsTheTreesOwnBitForBit) {
  const Catalog catalog = catalog_with({"rosenbrock.so", "gradient_descent.so", "trials.so"});
  const std::vector<std::string> methods = {"levenberg-marquardt", "gd[rate=1e-3]", "ceres-lm",
                                            "nlopt-neldermead", "nlopt-lbfgs"};
  const FinishedMatrix theirs = run(catalog, {"rosenbrock-c"}, methods);
  expect_same_runs(run(catalog, {"rosenbrock"}, methods), theirs, methods.size());
  EXPECT_TRUE(theirs.records[0].verified.at("1e-6") == true);
  const std::vector<std::string> problems = {"rosenbrock", "square", "trial-products"};
  expect_same_runs(run(catalog, problems, {"gd[rate=1e-3]"}),
                   run(catalog, problems, {"gd-c[rate=1e-3]"}), problems.size());
}

TEST(Plugin, AWholeSolveReportsItsIterationsAndSaysThatItConverged) {
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"}, {"trial-solve"});
  ASSERT_EQ(all.records.size(), 1U);
  const Record& record = all.records[0];
  EXPECT_TRUE(record.status == Status::converged || record.status == Status::target)
      << record.message;
  EXPECT_EQ(record.verified.at("1e-6"), true);
  EXPECT_GT(record.summary.iterations, 3);
  EXPECT_LT(record.summary.iterations, 20);
}

TEST(Plugin, ASolveThatIsToldThatTheRunIsOverEndsByItsBudget) {
  const Catalog catalog = catalog_with({"trials.so"});
  const Suite suite{.name = "plugin",
                    .title = "",
                    .blocks = {{.problems = {"trial-products"},
                                .optimizers = {"trial-solve"},
                                .seeds = {0},
                                .budget = {.iterations = 2, .target = 0}}}};
  const FinishedMatrix all(catalog, suite, {});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].status, Status::budget) << all.records[0].message;
  EXPECT_EQ(all.records[0].summary.iterations, 2);
}

TEST(Plugin, SoundProblemsHoldWhatEveryProblemMust) {
  const Catalog catalog = catalog_with({"rosenbrock.so", "trials.so"});
  for (const char* name : {"rosenbrock-c", "trial-products", "trial-forward"}) {
    const Problem problem =
        make_problem(catalog, complete_problem(catalog, name, OptionValues()), 1);
    RandomStream stream(1, name, "check");
    const std::vector<Finding> findings = examine(problem, stream);
    EXPECT_GE(findings.size(), 2U) << name;
    for (const Finding& finding : findings)
      EXPECT_TRUE(finding.holds()) << name << ": " << finding.property << " " << finding.figure;
  }
}

TEST(Plugin, AProblemOfForwardAloneIsInapplicableToWhoAsksForMore) {
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all =
      run(catalog, {"trial-forward"}, {"gd", "levenberg-marquardt", "nlopt-neldermead"});
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[0].status, Status::inapplicable);
  EXPECT_NE(all.records[1].status, Status::inapplicable) << "by differences of its own";
  EXPECT_NE(all.records[2].status, Status::inapplicable);
  EXPECT_LT(all.records[2].summary.loss, all.records[2].summary.start_loss);
}

TEST(Plugin, TheRecordSaysWhoComputed) {
  const Catalog catalog = catalog_with({"rosenbrock.so", "gradient_descent.so"});
  const FinishedMatrix all = run(catalog, {"rosenbrock-c"}, {"gd-c", "gd"});
  ASSERT_EQ(all.records.size(), 2U);
  const ForeignParts& both = all.records[0].foreign;
  ASSERT_TRUE(both.problem && both.optimizer);
  EXPECT_EQ(both.problem->door, "plugin");
  EXPECT_EQ(both.problem->command, kPlugins + "/rosenbrock.so");
  EXPECT_EQ(both.problem->digest.size(), 16U);
  EXPECT_NE(both.problem->digest, both.optimizer->digest);
  EXPECT_FALSE(all.records[1].foreign.optimizer);
}

// The sentence about a defect, of the library's loading or of its first problem's making.
std::string complaint(const char* defect) {
  const Defect here(defect);
  const std::string said = refusal<std::exception>([] {
    Catalog catalog;
    add_plugin(catalog, kTrials);
    make_problem(catalog, complete_problem(catalog, "trial-products", OptionValues()), 0);
  });
  return said.empty() ? "nothing" : said;
}

struct Law {
  const char *defect, *sentence;
};

const Law kLaws[] = {{"version", "version 1 of isoline.h, got 2"},
                     {"bytes", "`bytes` must be sizeof(isoline_component), "},
                     {"null name", "no. 0: `name` is null"},
                     {"bad name", "`name` must be"},
                     {"empty title", "trial-products: `title` is empty"},
                     {"null source", "trial-products: `source` is null"},
                     {"inverse of unknown kind", "dimension() must set"},
                     {"alien capability", "capabilities 0x10000000000 are"},
                     {"no capability", "a problem must have ISOLINE_FORWARD"},
                     {"two kinds of step", "either ISOLINE_STEP or ISOLINE_SOLVE"},
                     {"null options", "`options` is null"},
                     {"endless options", "100 options, got 1099511627776"},
                     {"option outside", "'size' must be in [0, 1], got 5"},
                     {"endless components", "got 1000"},
                     {"nothing at all", "isoline_plugin() has no component"},
                     {"no inputs", "inputs from 1 to 134217728, got 0"},
                     {"2^40 inputs", "inputs from 1 to 134217728, got 1099511627776"},
                     {"no outputs", "outputs from 1 to 134217728, got 0"},
                     {"2^40 outputs", "outputs from 1 to 134217728, got 1099511627776"},
                     {"2^40 kept", "kept from 0 to 134217728, got 1099511627776"},
                     {"no dimension", "dimension() failed"},
                     {"crossed bounds", "got 0.5 and 0 for unknown 0"},
                     {"null bounds", "upper, got null"},
                     {"no instance", "instance() failed"},
                     {"null instance of it", "open() returned null"}};

TEST(PluginLaws, ThatAreBrokenAreToldWithTheLibraryAndWhatWasGiven) {
  for (const auto& [defect, sentence] : kLaws) {
    const std::string told = complaint(defect);
    EXPECT_NE(told.find(sentence), std::string::npos) << defect << ": " << told;
    EXPECT_TRUE(told.starts_with(kTrials + ": ")) << defect << ": " << told;
  }
  for (const std::string function : {"dimension", "instance", "forward", "pushforward", "pullback",
                                     "jacobian", "inverse", "step"})
    EXPECT_NE(complaint(("null " + function).c_str()).find(function + "(), which is null"),
              std::string::npos);
  EXPECT_EQ(complaint("unknown"), "nothing");
}

// What a method returns or asks, as the message of its cell.
std::string message_of_overreach(const char* defect) {
  const Defect here(defect);
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"square"}, {"trial-overreach"});
  return all.records.size() == 1 && all.records[0].status == Status::failed ? all.records[0].message
                                                                            : "it did not fail";
}

TEST(PluginLaws, AMethodIsRefusedWhatItDidNotDeclareWhateverItMakesOfThat) {
  EXPECT_NE(message_of_overreach("").find("jacobian"), std::string::npos)
      << message_of_overreach("");
  EXPECT_NE(message_of_overreach("gradient first").find("call linearize() before"),
            std::string::npos);
  EXPECT_NE(message_of_overreach("unknown verdict").find("got 7"), std::string::npos);
  EXPECT_NE(message_of_overreach("failed step").find("trial-overreach: step() failed"),
            std::string::npos);
}

// The bounds keep x1 from 1, where the solution is.
TEST(Plugin, AProblemWithBoundsIsSolvedWithinThemByMethodsThatRespectThem) {
  const Defect here("bounds");
  const Catalog catalog = catalog_with({"trials.so", "gradient_descent.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"},
                                 {"levenberg-marquardt", "nlopt-lbfgs", "ceres-lbfgs", "gd-c", "gd",
                                  "trial-solve", "trial-leaves-bounds"});
  ASSERT_EQ(all.records.size(), 7U);
  std::vector<Real> descents;  // final losses of gd in C and of our own
  for (const Record& record : all.records) {
    const std::string& name = record.request.optimizer.name;
    if (name == "trial-leaves-bounds") {
      EXPECT_EQ(record.status, Status::failed) << record.message;
      EXPECT_NE(record.message.find("component 0"), std::string::npos) << record.message;
      EXPECT_NE(record.message.find(name), std::string::npos) << record.message;
      continue;
    }
    EXPECT_EQ(record.status == Status::inapplicable, name == "ceres-lbfgs" || name == "trial-solve")
        << name;
    if (record.status == Status::inapplicable) continue;
    EXPECT_EQ(record.trajectory->x.back()[0], 0.5) << name;
    if (name.starts_with("gd")) {
      descents.push_back(record.summary.loss);
      continue;
    }
    EXPECT_LT(record.curve.kkt_residual.back(), 1e-6) << name;
    EXPECT_GT(record.curve.gradient_norm.back(), 0.1) << name;
  }
  ASSERT_EQ(descents.size(), 2U);
  EXPECT_EQ(descents[0], descents[1]);
}

TEST(PluginLaws, AForwardWithoutAnAnswerIsNotANumber) {
  const Defect here("no answer");
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"}, {"gd"});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].status, Status::diverged) << all.records[0].message;
}

TEST(PluginLaws, WhatIsNoLibraryIsNamed) {
  const auto told = [](const std::string& path) { return refusal([&] { load_plugin(path); }); };
  EXPECT_NE(told(kPlugins).find("is a folder"), std::string::npos) << told(kPlugins);
  EXPECT_NE(told(kPlugins + "/empty.so").find("does not export isoline_plugin()"),
            std::string::npos);
}

TEST(PluginLaws, ALibraryThatFlushesSubnormalNumbersChangesNoneOfOurs) {
  const volatile double least = std::numeric_limits<double>::min();
  load_plugin(kPlugins + "/fast.so");
  EXPECT_GT(least / 2, 0);
}

// --plugin and `isoline new` as a user meets them.

namespace fs = std::filesystem;

class PluginProgram : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"rosenbrock.so", "gradient_descent.so", "trials.so"})
      fs::copy_file(fs::path(kPlugins) / name, shell.folder() / name);
  }
  Finished run(const std::string& more) {
    return shell("./isoline run --no-report --quiet --iterations 40 --out out " + more);
  }
  Shell shell;
};

TEST_F(PluginProgram, ListsDescribesChecksAuditsAndPlansWhatALibraryBrings) {
  const std::string both = " --plugin ./rosenbrock.so --plugin gradient_descent.so";
  EXPECT_TRUE(contains(shell("./isoline describe problems --names" + both).out, "rosenbrock-c\n"));
  EXPECT_TRUE(contains(shell("./isoline describe optimizers --names" + both).out, "gd-c\n"));
  EXPECT_FALSE(contains(shell("./isoline describe problems --names").out, "rosenbrock-c\n"));
  EXPECT_TRUE(contains(shell("./isoline describe rosenbrock-c" + both).out, "in C"));
  const Finished checked = shell("./isoline check rosenbrock-c" + both);
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  EXPECT_TRUE(contains(checked.out, "⟨u, J v⟩ = ⟨Jᵀu, v⟩")) << checked.out;
  const Finished audited = shell("./isoline audit gd-c" + both);
  EXPECT_EQ(audited.exit_code, 0) << audited.err;
  EXPECT_TRUE(contains(audited.out, "gd-c")) << audited.out;
  const Finished planned =
      shell("./isoline run --dry-run --problem rosenbrock-c --optimizer gd-c,gd" + both);
  EXPECT_TRUE(contains(planned.out, "2 cells")) << planned.out << planned.err;
  const Finished tuned =
      shell("./isoline tune rosenbrock-c --optimizer gd-c --work 200 --json" + both);
  EXPECT_EQ(tuned.exit_code, 0) << tuned.err;
  EXPECT_TRUE(contains(tuned.out, "gd-c")) << tuned.out;
}

TEST_F(PluginProgram, ItsRecordsAreValidReplayedAndRepeatedWhereTheLibraryChanged) {
  const std::string cells =
      "--problem rosenbrock-c,rosenbrock --optimizer levenberg-marquardt --plugin ./rosenbrock.so";
  ASSERT_EQ(run(cells).exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "out"), 2U);
  EXPECT_EQ(shell("./isoline validate out").exit_code, 0);
  const Finished replayed = shell("./isoline replay --plugin ./rosenbrock.so out/runs/*.json");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;
  EXPECT_EQ(shell("./isoline replay out/runs/*.json").exit_code, 4) << "the library is not given";
  ASSERT_EQ(run(cells).exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "out"), 2U) << "done cells were repeated";
  shell("printf changed >> rosenbrock.so");
  ASSERT_EQ(run(cells).exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "out"), 3U) << "of the library's cell alone";
}

TEST_F(PluginProgram, ACrashCostsItsCellAlone) {
  const Finished result =
      run("--problem trial-crash,square --optimizer levenberg-marquardt --plugin ./trials.so");
  EXPECT_EQ(result.exit_code, 2) << result.err;
  std::size_t crashed = 0, good = 0;
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs")) {
    const bool is_crash = read_json(entry.path()).at("status") == "crashed";
    (is_crash ? crashed : good) += 1;
  }
  EXPECT_EQ(crashed, 1U);
  EXPECT_EQ(good, 1U);
}

TEST_F(PluginProgram, WhatCannotBeLoadedIsOneSentence) {
  const struct {
    std::string before, plugin, sentence;
  } all[] = {
      {"ISOLINE_DEFECT='crash at load'", "./trials.so", "./trials.so cannot be loaded: "},
      {"ISOLINE_DEFECT=version", "./trials.so", "./trials.so: no. 0: "},
      {"", "./nowhere.so", "./nowhere.so: no such file"},
      {"", "./isoline", "./isoline cannot be loaded"},
      {"head -c 3000 rosenbrock.so > cut.so;", "./cut.so", "./cut.so cannot be loaded"},
      {"", "./rosenbrock.so --plugin ./rosenbrock.so", "'rosenbrock-c' is registered twice"}};
  for (const auto& [before, plugin, sentence] : all) {
    const Finished result = shell(before + " ./isoline describe --plugin " + plugin);
    EXPECT_EQ(result.exit_code, 1) << plugin << ": " << result.err;
    EXPECT_EQ(count_lines(result.err), 1U) << result.err;
    EXPECT_TRUE(contains(result.err, sentence)) << result.err;
  }
}

namespace fs = std::filesystem;

const std::string kTree = ISOLINE_SOURCE_DIR;

std::string built(const Shell& shell, const std::string& name) {
  const std::string warnings = " -std=c99 -pedantic -Wall -Wextra -Werror ";
  return shell(ISOLINE_C_COMPILER + warnings + "-O2 -shared -fPIC -o lib" + name + ".so " + name +
               ".c")
      .err;
}

TEST(New, AProblemInCBuildsPassesItsChecksAndIsSolved) {
  const Shell shell;
  const Finished made = shell("./isoline new problem double-well --c");
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_TRUE(contains(made.out, "wrote isoline.h\nwrote double_well.c\n")) << made.out;
  EXPECT_TRUE(contains(made.out,
                       "next: cc -O2 -shared -fPIC -o libdouble_well.so double_well.c && "
                       "isoline check double-well --plugin ./libdouble_well.so\n"))
      << made.out;
  EXPECT_EQ(built(shell, "double_well"), "");
  const Finished checked = shell("./isoline check double-well --plugin ./libdouble_well.so");
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  const Finished run = shell(
      "./isoline run --problem 'double-well[coupling=0.1|0.25]' --optimizer levenberg-marquardt "
      "--seeds 3 --plugin ./libdouble_well.so --out out --quiet --no-report");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(count_records(shell.folder() / "out"), 6U);
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs"))
    EXPECT_EQ(read_json(entry.path()).at("verified").at("1e-6"), true) << entry.path();
}

// Rosenbrock's valley, whose inverse does `deed` first, on one method.
Finished run_of_valley(const Shell& shell, const std::string& deed) {
  fs::copy_file(kTree + "/core/foreign/isoline.h", shell.folder() / "isoline.h");
  std::string text = read_text(kTree + "/clients/c/rosenbrock.c");
  const std::string begin = "  (void)self, (void)x0;\n";
  text.insert(text.find(begin) + begin.size(), "  " + deed + ";\n");
  write_text(shell.folder() / "valley.c",
             "#define _POSIX_C_SOURCE 200809L\n#include <signal.h>\n#include <stdlib.h>\n"
             "#include <unistd.h>\n" +
                 text);
  EXPECT_EQ(built(shell, "valley"), "");
  return shell(
      "./isoline run --problem rosenbrock-c --optimizer newton --plugin ./libvalley.so --out out "
      "--no-report");
}

TEST(Library, ThatAbortsInItsCertificateHasNoCells) {
  const Shell shell;
  const Finished refused = run_of_valley(shell, "abort()");
  EXPECT_EQ(refused.exit_code, 1) << refused.out << refused.err;
  EXPECT_TRUE(contains(refused.err, "rosenbrock-c failed a check")) << refused.err;
  EXPECT_TRUE(contains(refused.err, "signal 6")) << refused.err;
  EXPECT_EQ(count_records(shell.folder() / "out"), 0U);
}

TEST(Library, ThatTerminatesItsParentInItsCertificateDoesNotEndTheRun) {
  const Shell shell;
  const Finished done = run_of_valley(shell, "kill(getppid(), SIGTERM)");
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
  EXPECT_EQ(count_records(shell.folder() / "out"), 1U);
}

TEST(Library, ThatAbortsWhenItIsUnloadedCostsNothingThatIsDone) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline new problem last --c").exit_code, 0);
  write_text(shell.folder() / "last.c",
             read_text(shell.folder() / "last.c") +
                 "#include <stdlib.h>\n"
                 "__attribute__((destructor)) static void leave(void) { abort(); }\n");
  EXPECT_EQ(built(shell, "last"), "");
  EXPECT_EQ(shell("./isoline describe --plugin ./liblast.so").exit_code, 0);
  EXPECT_EQ(shell("./isoline describe absent --plugin ./liblast.so").exit_code, 1);
}

TEST(New, AnOptimizerInCBuildsIsFlaggedNowhereAndDescends) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline new optimizer slow --c").exit_code, 0);
  EXPECT_EQ(built(shell, "slow"), "");
  const Finished audited = shell("./isoline audit slow --plugin ./libslow.so --json");
  EXPECT_EQ(audited.exit_code, 0) << audited.err;
  ASSERT_EQ(
      shell("./isoline run --problem rosenbrock --optimizer slow --plugin ./libslow.so --out out "
            "--quiet --no-report")
          .exit_code,
      0);
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs"))
    EXPECT_EQ(read_json(entry.path()).at("verified").at("1e-3"), true);
}

TEST(New, InCppWritesTheFileOfTheRuleAndWhatBuildsIt) {
  const Shell shell;
  const Finished problem = shell("./isoline new problem batch");
  EXPECT_EQ(problem.exit_code, 0) << problem.err;
  EXPECT_TRUE(contains(problem.out, "wrote CMakeLists.txt\nwrote problems/batch.cpp\n"));
  EXPECT_TRUE(contains(problem.out, "build/mine check batch\n")) << problem.out;
  EXPECT_TRUE(contains(problem.out, "next: cmake --install ")) << "of a build folder";
  const Finished method = shell("./isoline new optimizer my-problem-2");
  EXPECT_TRUE(contains(method.out, "wrote optimizers/my_problem_2.cpp\n")) << method.out;
  EXPECT_FALSE(contains(method.out, "CMakeLists.txt\n")) << "which is there: " << method.out;
  const std::string text = read_text(shell.folder() / "problems" / "batch.cpp");
  EXPECT_TRUE(contains(text, "void register_batch(ProblemRegistry&")) << text;
  EXPECT_FALSE(contains(text, "my")) << text;
}

// By the door of processes, where Python is.
TEST(New, InPythonPassesItsChecksAndIsSolvedWithoutAnyPackage) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline new problem well --python").out,
            "wrote well.py\nnext: isoline check 'process[command=\"python3 well.py\"]'\n");
  ASSERT_EQ(shell("./isoline new optimizer dig --python").exit_code, 0);
  if (shell("python3 --version").exit_code != 0) GTEST_SKIP() << "there is no python3";
  const std::string well = "'process[command=\"python3 well.py\"]'";
  const std::string dig = "'process[command=\"python3 dig.py\"]'";
  const Finished checked = shell("./isoline check " + well);
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  const Finished run = shell("./isoline run --problem " + well + " --optimizer ceres-lm," + dig +
                             " --out out --quiet --no-report");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(count_records(shell.folder() / "out"), 2U);
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs"))
    EXPECT_EQ(read_json(entry.path()).at("verified").at("1e-3"), true) << entry.path();
}

// In the tree itself the launcher builds.
TEST(New, InTheTreeNamesTheLauncher) {
  const Shell shell;
  fs::copy_file(kTree + "/CMakeLists.txt", shell.folder() / "CMakeLists.txt");
  EXPECT_TRUE(contains(shell("./isoline new problem well").out, "next: ./isoline check well\n"));
  EXPECT_TRUE(contains(shell("./isoline new optimizer dig").out, "next: ./isoline audit dig\n"));
}

TEST(New, OverwritesNothingAndTakesNoNameTwice) {
  const struct {
    std::string command, sentence;
  } mistakes[] = {{"problem well --c", "well.c exists already"},
                  {"problem sine", "'sine' exists already"},
                  {"optimizer adam --c", "'adam' exists already"},
                  {"problem Well", "got 'Well'"},
                  {"problem ../well", "got '../well'"},
                  {"problem -- -well", "got '-well'"},
                  {"problem 2well", "got '2well'"},
                  {"problem well-", "got 'well-'"},
                  {"problem we--ll", "got 'we--ll'"},
                  {"network well", "network"},
                  {"problem well --c --python", "--python"}};
  const Shell shell;
  ASSERT_EQ(shell("./isoline new problem well --c; echo mine > well.c").exit_code, 0);
  for (const auto& [command, sentence] : mistakes) {
    const Finished result = shell("./isoline new " + command);
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_EQ(count_lines(result.err), 1U) << result.err;
    EXPECT_TRUE(contains(result.err, sentence)) << command << ": " << result.err;
  }
  EXPECT_EQ(read_text(shell.folder() / "well.c"), "mine\n");
  EXPECT_FALSE(fs::exists(shell.folder() / "problems"));
}

}  // namespace
}  // namespace isoline::benchmarks
