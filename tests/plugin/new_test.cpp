// What `isoline new` writes builds and passes its checks as it is written.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

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
