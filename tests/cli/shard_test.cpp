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

Json plan_of(const Shell& shell, const std::string& arguments) {
  const Finished planned = shell("./isoline plan " + kMatrix + arguments + " --json");
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  return parse_json(planned.out, "the plan");
}

TEST(Plan, SaysWhatADryRunSays) {
  const Shell shell;
  const std::string dry = shell("./isoline run " + kMatrix + "--out out --dry-run").out;
  const std::string planned = shell("./isoline plan " + kMatrix + "--out out").out;
  const std::string counts = "24 cells: 0 cached, 0 inapplicable, 24 to run, ";
  EXPECT_TRUE(planned.starts_with(counts)) << planned;
  EXPECT_TRUE(dry.starts_with(counts)) << dry;
  EXPECT_FALSE(fs::exists(shell.folder() / "out")) << "it only looks";
}

TEST(Plan, TellsTheShardsAsAMatrixForAWorkflow) {
  const Shell shell;
  const Json plan = plan_of(shell, "--shards 3 --out out");
  EXPECT_EQ(plan.at("cells"), 24);
  EXPECT_EQ(plan.at("missing"), 24);
  EXPECT_TRUE(plan.at("seconds").is_null()) << "no earlier run tells";
  ASSERT_EQ(plan.at("shards").size(), 3U);
  int cells = 0;
  for (const Json& shard : plan.at("shards")) cells += shard.at("cells").get<int>();
  EXPECT_EQ(cells, 24);
  EXPECT_EQ(plan.at("shards")[1].at("shard"), "2/3");
  EXPECT_EQ(shell("./isoline validate out").exit_code, 0);
  const std::string told = shell("./isoline plan " + kMatrix + "--shards 3 --out out").out;
  EXPECT_TRUE(contains(told, "shard       2/3")) << told;
  EXPECT_TRUE(contains(told, "out/predicted.json, written earlier")) << told;
}

TEST(Plan, PredictsByWhatEarlierRunsTook) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline run " + kMatrix + "--out before --no-report --quiet").exit_code, 0);
  const std::string told =
      shell("./isoline plan " + kMatrix + "--shards 2 --out out --from before").out;
  EXPECT_TRUE(contains(told, "24 from earlier runs and 0 from nominal costs")) << told;
  const Finished absent = shell("./isoline plan " + kMatrix + "--from nowhere");
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_TRUE(contains(absent.err, "nowhere: no such result folder")) << absent.err;
}

// The promise of it all. Measured prices stand in the sheets, which no comparison reads.
TEST(Shards, TogetherAreTheWholeBitForBit) {
  const Shell shell;
  plan_of(shell, "--shards 3 --out out");
  ASSERT_EQ(shell("./isoline run " + kMatrix + "--out whole --no-report --quiet").exit_code, 0);
  for (const char* shard : {"--shard 1/3", "--shard 2/3"})
    EXPECT_EQ(shell("./isoline run " + kMatrix + "--out out --quiet " + shard).exit_code, 0);
  const std::string third =
      "SLURM_ARRAY_TASK_ID=6 SLURM_ARRAY_TASK_MIN=4 SLURM_ARRAY_TASK_COUNT=3 ./isoline run " +
      kMatrix + "--out out --quiet --shard auto";
  EXPECT_EQ(shell(third).exit_code, 0);
  std::size_t records = 0;
  for (int i = 1; i <= 3; ++i)
    records += count_records(shell.folder() / fmt::format("out/shards/{}-of-3", i));
  EXPECT_EQ(records, 24U) << "every cell is run once";
  EXPECT_EQ(shell("./isoline merge out/shards/* --out out/merged").exit_code, 0);
  const Finished compared = shell("./isoline compare whole out/merged");
  EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
  EXPECT_TRUE(contains(compared.out, "24 equal")) << compared.out;
  const auto sorted = [](const Json& plan) {
    Json cells = plan.at("cells");
    std::sort(cells.begin(), cells.end());
    return cells;
  };
  EXPECT_EQ(sorted(read_json(shell.folder() / "whole/plan.json")),
            sorted(read_json(shell.folder() / "out/merged/plan.json")));
  EXPECT_EQ(shell("./isoline run " + kMatrix + "--out out/merged --quiet").exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "out/merged"), 24U) << "the union is a result folder";
}

TEST(Shards, ThatAreMissingAreMissedByTheUnion) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline run " + kMatrix + "--out out --shard 1/3 --quiet").exit_code, 0);
  EXPECT_FALSE(fs::exists(shell.folder() / "out/shards/1-of-3/report"));
  ASSERT_EQ(shell("./isoline merge out/shards/* --out merged").exit_code, 0);
  const Json plan = read_json(shell.folder() / "merged/plan.json");
  EXPECT_EQ(plan.at("cells").size(), 24U) << "a part never passes for the whole";
  const Finished again = shell("./isoline run " + kMatrix + "--out out --shard 1/3");
  EXPECT_TRUE(contains(again.out, " 0 run, ")) << again.out;
}

// What is done is not done again when the plan is divided anew.
TEST(Shards, TakeOverWhatOtherDivisionsHaveDone) {
  const Shell shell;
  const std::string run = "./isoline run " + kMatrix + "--out out ";
  for (const char* shard : {"--shard 1/3 --quiet", "--shard 2/3 --quiet", "--shard 3/3 --quiet"})
    ASSERT_EQ(shell(run + shard).exit_code, 0);
  EXPECT_EQ(plan_of(shell, "--shards 2 --out out").at("cached"), 24);
  for (const char* shard : {"--shard 1/2", "--shard 2/2"}) {
    const Finished again = shell(run + shard);
    EXPECT_TRUE(contains(again.out, " 0 run, 12 reused")) << again.out;
  }
  EXPECT_EQ(shell("./isoline merge out/shards/* --out merged").exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "merged"), 24U);
  EXPECT_TRUE(contains(shell(run + "--shard 1/2 --force").out, " 12 run, 0 reused"));
}

TEST(Shards, OfAPlanThatIsNotThePredictedOneAreRefused) {
  const Shell shell;
  plan_of(shell, "--shards 3 --out out");
  const Finished other = shell("./isoline run --problem sine --optimizer gd --out out --shard 1/3");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(contains(other.err, "predicts another plan")) << other.err;
}

// --- status

TEST(Status, CountsPlannedDoneFailedAndLeft) {
  const Shell shell;
  plan_of(shell, "--shards 3 --out out");
  Finished told = shell("./isoline status out");
  EXPECT_TRUE(told.out.starts_with("24 cells: 0 done, 0 of them failed, 0 running, 24 left\n"))
      << told.out;
  EXPECT_TRUE(contains(told.out, "cannot be predicted")) << told.out;
  ASSERT_EQ(shell("./isoline run " + kMatrix + "--out out --shard 2/3 --quiet").exit_code, 0);
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
  told = shell("./isoline status out");
  EXPECT_EQ(told.exit_code, 2) << "a cell has failed";
  EXPECT_TRUE(contains(told.out, "1 of them failed")) << told.out;
}

TEST(Status, OfARunWithoutShardsGoesByItsPlan) {
  const Shell shell;
  ASSERT_EQ(shell("./isoline run " + kMatrix + "--out out --no-report --quiet").exit_code, 0);
  EXPECT_EQ(shell("./isoline status out").out,
            "24 cells: 24 done, 0 of them failed, 0 running, 0 left\n");
  EXPECT_EQ(shell("mkdir empty; ./isoline status empty").exit_code, 1);
}

// Two cells that would take minutes, looked at while they run, then stopped.
TEST(Status, SeesWhatIsRunning) {
  const Shell shell;
  const std::string matrix =
      "--problem 'poisson[N=32]' --optimizer gd --seeds 2 --iterations 100000000 --target 0 ";
  const Finished seen =
      shell("./isoline run " + matrix +
            "--out out --jobs 2 --quiet --no-report & run=$!; told=; tries=0\n"
            "while [ $tries -lt 600 ]; do tries=$((tries + 1)); sleep 0.1\n"
            "  told=$(./isoline status out 2>/dev/null)\n"
            "  case $told in *' 2 running'*) break ;; esac\n"
            "done\n"
            "kill -TERM $run; wait $run; echo \"$? $told\"; ./isoline status out");
  EXPECT_TRUE(contains(seen.out, "130 2 cells: 0 done, 0 of them failed, 2 running, 0 left"))
      << seen.out << seen.err;
  EXPECT_TRUE(contains(seen.out, "2 cells: 0 done, 0 of them failed, 0 running, 2 left"))
      << seen.out;
}

}  // namespace
}  // namespace isoline::benchmarks
