// --plugin as a user meets it: every verb knows what a library brings.
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

}  // namespace
}  // namespace isoline::benchmarks
