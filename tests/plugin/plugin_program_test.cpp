// --plugin and `isoline new` as a user meets them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const fs::path kPlugins = ISOLINE_PLUGINS;

class PluginProgram : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"rosenbrock.so", "gradient_descent.so", "trials.so"})
      fs::copy_file(kPlugins / name, shell.folder() / name);
  }
  Finished run(const std::string& more) {
    return shell("./isoline run --no-report --quiet --iterations 40 --out out " + more);
  }
  Shell shell;
};

TEST_F(PluginProgram, ListsDescribesChecksAuditsAndPlansWhatALibraryBrings) {
  const std::string both = " --plugin ./rosenbrock.so --plugin gradient_descent.so";
  EXPECT_TRUE(contains(shell("./isoline list problems --names" + both).out, "rosenbrock-c\n"));
  EXPECT_TRUE(contains(shell("./isoline list optimizers --names" + both).out, "gd-c\n"));
  EXPECT_FALSE(contains(shell("./isoline list problems --names").out, "rosenbrock-c\n"));
  EXPECT_TRUE(contains(shell("./isoline describe rosenbrock-c" + both).out, "in C"));
  const Finished checked = shell("./isoline check rosenbrock-c" + both);
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  EXPECT_TRUE(contains(checked.out, "⟨u, J v⟩ = ⟨Jᵀu, v⟩")) << checked.out;
  const Finished audited = shell("./isoline audit gd-c" + both);
  EXPECT_EQ(audited.exit_code, 0) << audited.err;
  EXPECT_TRUE(contains(audited.out, "gd-c")) << audited.out;
  const Finished planned =
      shell("./isoline plan --problem rosenbrock-c --optimizer gd-c,gd" + both);
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
      {"ISOLINE_DEFECT=version", "./trials.so",
       "./trials.so: no. 0: a component must have version"},
      {"", "./nowhere.so", "./nowhere.so: no such file"},
      {"", "./isoline", "./isoline cannot be loaded as a library"},
      {"head -c 3000 rosenbrock.so > cut.so;", "./cut.so", "./cut.so cannot be loaded"},
      {"", "./rosenbrock.so --plugin ./rosenbrock.so", "'rosenbrock-c' is registered twice"}};
  for (const auto& [before, plugin, sentence] : all) {
    const Finished result = shell(before + " ./isoline list --plugin " + plugin);
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
                  {"problem Well", "a name must be lower-case letters"},
                  {"problem ../well", "got '../well'"},
                  {"problem -- -well", "got '-well'"},
                  {"problem 2well", "the first a letter, got '2well'"},
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
