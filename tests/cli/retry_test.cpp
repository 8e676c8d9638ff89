// What --retry repeats, and what a record from the future changes: nothing.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const std::string kMatrix =
    "./isoline run --problem square,brown-dennis --optimizer gd,newton --iterations 20 --out out "
    "--no-report ";

class Retry : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(shell(kMatrix).exit_code, 0); }
  // Changes every record of an optimizer, or of all.
  void change(const char* optimizer, const std::function<void(Json&)>& how) {
    for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs")) {
      Json record = read_json(entry.path());
      const bool is_meant = record.at("request").at("optimizer").at("name") == optimizer;
      if (!is_meant && std::string(optimizer) != "*") continue;
      how(record);
      write_text(entry.path(), record.dump() + "\n");
    }
  }
  Shell shell;
};

TEST_F(Retry, RepeatsCellsThatEndedSoAndNoOthers) {
  change("gd", [](Json& record) { record["status"] = "crashed"; });
  EXPECT_TRUE(contains(shell(kMatrix + "--retry timeout,memory").out, "0 run, 4 reused"));
  const Finished dry = shell(kMatrix + "--retry crashed --dry-run");
  EXPECT_TRUE(contains(dry.out, "4 cells: 2 cached, 0 inapplicable, 2 to run")) << dry.out;
  const Finished again = shell(kMatrix + "--retry failed,crashed");
  EXPECT_TRUE(contains(again.out, "4 cells: 2 run, 2 reused")) << again.out;
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_FALSE(contains(again.err, "another result")) << again.err;
  EXPECT_TRUE(contains(shell(kMatrix + "--retry failed,crashed").out, "0 run, 4 reused"));
  const Finished suite = shell("./isoline run --retry failed notebook --dry-run");
  EXPECT_EQ(suite.exit_code, 0) << "the word behind is a suite: " << suite.err;
}

// Timings of a cell that went wrong are no timings of the one that takes its place.
TEST_F(Retry, ForgetsTheTimesOfWhatItReplaces) {
  change("gd", [](Json& record) {
    record["status"] = "memory";
    record["repeat_wall_seconds"] = {1e-5};
  });
  EXPECT_EQ(shell(kMatrix + "--retry memory").exit_code, 0);
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs"))
    EXPECT_EQ(read_json(entry.path()).at("repeat_wall_seconds").size(), 1U);
}

TEST_F(Retry, NeedsNoClockThatGoesForward) {
  change("*",
         [](Json& record) { record["provenance"]["run"]["started"] = "2199-12-31T23:59:59Z"; });
  EXPECT_TRUE(contains(shell(kMatrix).out, "4 cells: 0 run, 4 reused"));
  EXPECT_TRUE(contains(shell(kMatrix + "--force").out, "4 cells: 4 run, 0 reused"));
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs"))
    EXPECT_LT(read_json(entry.path()).at("provenance").at("run").at("started"), "2199");
}

// A record of another build, from the future, does not win over the one of this build.
TEST_F(Retry, ARecordOfTheFutureDoesNotHideThisBuildsOwn) {
  const fs::path runs = shell.folder() / "out" / "runs";
  for (const auto& entry : fs::directory_iterator(runs)) {
    Json record = read_json(entry.path());
    const std::string cell = record.at("cell");
    record["build"] = std::string(16, 'f');
    record["provenance"]["run"]["started"] = "2199-12-31T23:59:59Z";
    write_text(runs / (cell + "-" + std::string(16, 'f') + ".json"), record.dump() + "\n");
    break;
  }
  const Finished reused = shell(kMatrix + "--reuse");
  EXPECT_TRUE(contains(reused.out, "4 cells: 0 run, 4 reused")) << reused.out;
  EXPECT_FALSE(contains(reused.err, "another build")) << reused.err;
}

}  // namespace
}  // namespace isoline::benchmarks
