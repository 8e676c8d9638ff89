// A plan run in parts: planned once, run wherever, watched, united into what one run gives.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const std::string kMatrix =
    "--problem square,rosenbrock,beale --optimizer gd,adam,newton,ceres-lm --seeds 2 "
    "--iterations 40 ";

// A plan in parts, in the folder `out`.
class Shards : public testing::Test {
 protected:
  Json plan(const std::string& arguments) const {
    return parse_json(shell.expect("./isoline plan " + kMatrix + arguments + " --json").out, "it");
  }
  Finished run(const std::string& arguments, const Expected& expected = {}) const {
    return shell.expect("./isoline run " + kMatrix + arguments, expected);
  }
  Shell shell;
};

TEST_F(Shards, APlanSaysWhatADryRunSays) {
  const std::string dry = run("--out out --dry-run").out;
  const std::string planned = shell("./isoline plan " + kMatrix + "--out out").out;
  const std::string counts = "24 cells: 0 cached, 0 inapplicable, 24 to run, ";
  EXPECT_TRUE(planned.starts_with(counts)) << planned;
  EXPECT_TRUE(dry.starts_with(counts)) << dry;
  EXPECT_FALSE(fs::exists(shell.folder() / "out")) << "it only looks";
}

TEST_F(Shards, AreToldByAPlanAsAMatrixForAWorkflow) {
  const Json told = plan("--shards 3 --out out");
  EXPECT_EQ(told.at("cells"), 24);
  EXPECT_EQ(told.at("missing"), 24);
  EXPECT_TRUE(told.at("seconds").is_null()) << "no earlier run tells";
  ASSERT_EQ(told.at("shards").size(), 3U);
  int cells = 0;
  for (const Json& shard : told.at("shards")) cells += shard.at("cells").get<int>();
  EXPECT_EQ(cells, 24);
  EXPECT_EQ(told.at("shards")[1].at("shard"), "2/3");
  shell.expect("./isoline validate out");
  shell.expect("./isoline plan " + kMatrix + "--shards 3 --out out",
               {.out = {"shard       2/3", "out/predicted.json, written earlier"}});
}

TEST_F(Shards, ArePredictedByWhatEarlierRunsTook) {
  run("--out before --no-report --quiet");
  shell.expect("./isoline plan " + kMatrix + "--shards 2 --out out --from before",
               {.out = {"24 from earlier runs and 0 from nominal costs"}});
  shell.expect("./isoline plan " + kMatrix + "--from nowhere",
               {.exit_code = 1, .err = {"nowhere: no such result folder"}});
}

// The promise of it all. Measured prices stand in the sheets, which no comparison reads.
TEST_F(Shards, TogetherAreTheWholeBitForBit) {
  plan("--shards 3 --out out");
  run("--out whole --no-report --quiet");
  for (const char* shard : {"--shard 1/3", "--shard 2/3"})
    run(std::string("--out out --quiet ") + shard);
  shell.expect(
      "SLURM_ARRAY_TASK_ID=6 SLURM_ARRAY_TASK_MIN=4 SLURM_ARRAY_TASK_COUNT=3 ./isoline run " +
      kMatrix + "--out out --quiet --shard auto");
  std::size_t records = 0;
  for (int i = 1; i <= 3; ++i)
    records += count_records(shell.folder() / fmt::format("out/shards/{}-of-3", i));
  EXPECT_EQ(records, 24U) << "every cell is run once";
  shell.expect("./isoline merge out/shards/* --out out/merged");
  shell.expect("./isoline compare whole out/merged", {.out = {"24 equal"}});
  const auto sorted_plan = [&](const char* file) {
    Json cells = read_json(shell.folder() / file).at("cells");
    std::sort(cells.begin(), cells.end());
    return cells;
  };
  EXPECT_EQ(sorted_plan("whole/plan.json"), sorted_plan("out/merged/plan.json"));
  run("--out out/merged --quiet");
  EXPECT_EQ(count_records(shell.folder() / "out/merged"), 24U) << "the union is a result folder";
}

TEST_F(Shards, ThatAreMissingAreMissedByTheUnion) {
  run("--out out --shard 1/3 --quiet");
  EXPECT_FALSE(fs::exists(shell.folder() / "out/shards/1-of-3/report"));
  shell.expect("./isoline merge out/shards/* --out merged");
  EXPECT_EQ(read_json(shell.folder() / "merged/plan.json").at("cells").size(), 24U)
      << "a part never passes for the whole";
  run("--out out --shard 1/3", {.out = {" 0 run, "}});
}

// What is done is not done again when the plan is divided anew.
TEST_F(Shards, TakeOverWhatOtherDivisionsHaveDone) {
  for (const char* shard : {"1/3", "2/3", "3/3"})
    run(std::string("--out out --quiet --shard ") + shard);
  EXPECT_EQ(plan("--shards 2 --out out").at("cached"), 24);
  for (const char* shard : {"1/2", "2/2"})
    run(std::string("--out out --shard ") + shard, {.out = {" 0 run, 12 reused"}});
  shell.expect("./isoline merge out/shards/* --out merged");
  EXPECT_EQ(count_records(shell.folder() / "merged"), 24U);
  run("--out out --shard 1/2 --force", {.out = {" 12 run, 0 reused"}});
}

TEST_F(Shards, OfAPlanThatIsNotThePredictedOneAreRefused) {
  plan("--shards 3 --out out");
  shell.expect("./isoline run --problem sine --optimizer gd --out out --shard 1/3",
               {.exit_code = 1, .err = {"predicts another plan"}});
}

// --- status

class Status : public Shards {};

TEST_F(Status, CountsPlannedDoneFailedAndLeft) {
  plan("--shards 3 --out out");
  const Finished told = shell.expect("./isoline status out", {.out = {"cannot be predicted"}});
  EXPECT_TRUE(told.out.starts_with("24 cells: 0 done, 0 of them failed, 0 running, 24 left\n"))
      << told.out;
  run("--out out --shard 2/3 --quiet");
  const std::size_t done = count_records(shell.folder() / "out/shards/2-of-3");
  const Json json = parse_json(shell("./isoline status out --json").out, "the status");
  EXPECT_EQ(json.at("done"), done);
  EXPECT_EQ(json.at("left"), 24 - done);
  EXPECT_TRUE(json.at("left_seconds").is_null()) << "no earlier run predicts it";
  EXPECT_GT(json.at("remaining_seconds").get<double>(), 0);
  EXPECT_EQ(json.at("end").get<std::string>().size(), std::string("2026-01-31T12:00:00Z").size());
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out/shards/2-of-3/runs")) {
    Json record = read_json(entry.path());
    record["status"] = "crashed";
    write_text(entry.path(), record.dump() + "\n");
    break;
  }
  shell.expect("./isoline status out", {.exit_code = 2, .out = {"1 of them failed"}});
}

TEST_F(Status, OfARunWithoutShardsGoesByItsPlan) {
  run("--out out --no-report --quiet");
  EXPECT_EQ(shell("./isoline status out").out,
            "24 cells: 24 done, 0 of them failed, 0 running, 0 left\n");
  shell.expect("mkdir empty; ./isoline status empty", {.exit_code = 1});
}

// Two cells that would take minutes, looked at while they run, then stopped.
TEST_F(Status, SeesWhatIsRunning) {
  const std::string matrix =
      "--problem 'poisson[N=32]' --optimizer gd --seeds 2 --iterations 100000000 --target 0 ";
  shell.expect("./isoline run " + matrix +
                   "--out out --jobs 2 --quiet --no-report & run=$!; told=; tries=0\n"
                   "while [ $tries -lt 600 ]; do tries=$((tries + 1)); sleep 0.1\n"
                   "  told=$(./isoline status out 2>/dev/null)\n"
                   "  case $told in *' 2 running'*) break ;; esac\n"
                   "done\n"
                   "kill -TERM $run; wait $run; echo \"$? $told\"; ./isoline status out",
               {.out = {"130 2 cells: 0 done, 0 of them failed, 2 running, 0 left",
                        "2 cells: 0 done, 0 of them failed, 0 running, 2 left"}});
}

}  // namespace
}  // namespace isoline::benchmarks
