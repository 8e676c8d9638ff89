// What SLURM is given, looked at by an sbatch and an scontrol that only write down how they were
// called. tests/cluster runs the same jobs on a real SLURM.
#include <gtest/gtest.h>

#include "benchmarks/shard/slurm.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

TEST(Slurm, TellsTheMostIndicesOfAnArray) {
  EXPECT_EQ(most_array_size("MailProg = /bin/mail\nMaxArraySize            = 5001\nMax = 1\n"),
            5001U);
  EXPECT_EQ(most_array_size("MaxArraySize = 17"), 17U);
  EXPECT_EQ(most_array_size("MaxArraySize = \nMaxDBDMsgs = 20008"), std::nullopt);
  EXPECT_EQ(most_array_size("scontrol: not found"), std::nullopt);
}

TEST(Slurm, GetsNoMoreShardsThanTheArrayAndTheirLengthAllow) {
  EXPECT_EQ(shards_within({}, 1e6), 16U);
  EXPECT_EQ(shards_within({.wanted = 5000}, 1e9), 1000U) << "indices end below MaxArraySize";
  EXPECT_EQ(shards_within({}, 1000), 3U) << "five minutes each";
  EXPECT_EQ(shards_within({}, 1), 1U);
  EXPECT_EQ(shards_within({}, 0), 1U);
  EXPECT_EQ(shards_within({.least_seconds = 1}, 10), 10U);
}

class Submit : public testing::Test {
 protected:
  // The scheduler's programs: they note their words, one a line, and answer.
  Submit() {
    const std::string note = "#!/bin/sh\nprintf '%s\\n' \"$(basename $0)\" \"$@\" >> called\n";
    write_text(shell.folder() / "bin-sbatch", note + "echo 4711\n");
    write_text(
        shell.folder() / "bin-scontrol",
        note + "echo 'MaxArraySize            = 4'\necho '   JobState=RUNNING Reason=None'\n");
    EXPECT_EQ(shell("mkdir bin; for p in sbatch scontrol; do mv bin-$p bin/$p; chmod +x bin/$p; "
                    "done")
                  .exit_code,
              0);
  }
  Finished submit(const std::string& options) const {
    return shell("PATH=$PWD/bin:$PATH ./isoline submit --slurm " + options);
  }
  std::string called() const { return shell("cat called").out; }
  Shell shell;
};

const std::string kRun =
    " -- --problem 'sine[xi=1|32]' --optimizer gd,adam --seeds 2 --iterations 50 --out 'the results'";

TEST_F(Submit, PrintsTwoJobsAndSubmitsNone) {
  const Finished printed = submit("--array 16 --time 90m --partition long --least 1s" + kRun);
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  for (const char* part :
       {"array=$(sbatch --parsable --array=1-", "--requeue", "--open-mode=append",
        "--signal=B:TERM@120", "--time=90", "--partition=long", "--job-name=isoline-custom",
        "sbatch --parsable --dependency=afterany:\"$array\"", "scontrol requeue",
        "OPENBLAS_CORETYPE=", "the results/program/isoline-", " merge ", " report "})
    EXPECT_TRUE(contains(printed.out, part)) << part << "\n" << printed.out;
  EXPECT_FALSE(contains(called(), "sbatch")) << called();
  EXPECT_TRUE(contains(printed.err, "nothing was submitted")) << printed.err;
  EXPECT_TRUE(fs::exists(shell.folder() / "the results/predicted.json"));
}

TEST_F(Submit, DoesWhatItPrintsWhereItIsToldYes) {
  const std::string arguments = "--least 1ms --sbatch=--account=physics" + kRun;
  const Finished printed = submit(arguments);
  write_text(shell.folder() / "printed", printed.out);
  ASSERT_EQ(shell("PATH=$PWD/bin:$PATH sh ./printed").exit_code, 0);
  const std::string by_hand = called();
  ASSERT_EQ(shell("rm called").exit_code, 0);
  const Finished submitted = submit("--yes " + arguments);
  EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_TRUE(contains(submitted.out, "submitted: job 4711 (3 tasks), then job 4711"))
      << submitted.out;
  const std::string asked = "scontrol\nshow\nconfig\n";
  EXPECT_EQ(called(), by_hand);
  EXPECT_EQ(by_hand.substr(0, asked.size()), asked);
  EXPECT_TRUE(contains(by_hand, "--account=physics\n")) << by_hand;
  EXPECT_TRUE(contains(by_hand, "--array=1-3\n")) << "below MaxArraySize: " << by_hand;
  EXPECT_TRUE(contains(by_hand, "--dependency=afterany:4711\n")) << by_hand;
}

// The wrapped script itself, run as a task: its shard is run, and what is stopped is asked for
// again.
TEST_F(Submit, WrapsAScriptThatRunsItsShard) {
  ASSERT_EQ(submit("--yes --least 1ms" + kRun).exit_code, 0);
  const std::string cut =
      "sed -n '/^--wrap=/,/^exit/p' called | sed 's/^--wrap=//; /^exit/q' > task.sh; ";
  const Finished run =
      shell(cut + "PATH=$PWD/bin:$PATH SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=2 sh ./task.sh");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(count_records(shell.folder() / "the results/shards/2-of-3"), 0U);
  EXPECT_FALSE(contains(called(), "\nrequeue\n"));
}

TEST_F(Submit, WrapsAScriptThatGoesBackIntoTheQueueWhenItIsStopped) {
  const std::string endless =
      " -- --problem 'poisson[N=32]' --optimizer gd --iterations 100000000 --target 0 --out out";
  ASSERT_EQ(submit("--yes --array 1" + endless).exit_code, 0);
  const Finished stopped = shell(
      "sed -n '/^--wrap=/,/^exit/p' called | sed 's/^--wrap=//; /^exit/q' > task.sh; "
      "PATH=$PWD/bin:$PATH SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=1 sh ./task.sh & task=$!\n"
      "until ./isoline status out | grep -q ' 1 running'; do sleep 0.1; done\n"
      "sleep 1; kill -TERM $task; wait $task");
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_TRUE(contains(called(), "\nrequeue\n7_1\n")) << called();
  const fs::path checkpoints = shell.folder() / "out/shards/1-of-1/checkpoints";
  EXPECT_FALSE(fs::is_empty(checkpoints)) << "its state was kept";
}

TEST_F(Submit, SaysWhatTheSchedulerRefuses) {
  ASSERT_EQ(shell("printf '#!/bin/sh\\nexit 1\\n' > bin/sbatch").exit_code, 0);
  const Finished refused = submit("--yes" + kRun);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(contains(refused.err, "sbatch refused the array")) << refused.err;
}

}  // namespace
}  // namespace isoline::benchmarks
