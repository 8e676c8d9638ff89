// The verbs that work on a result folder: run, report and validate.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/files.h"
#include "tests/cli/shell.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// Two applicable optimizers and one that is not (an inverse gradient needs a square Jacobian).
const std::string kMatrix =
    "./isoline run --problem brown-dennis --optimizer gd,newton,inverse-gradient "
    "--iterations 20 --out out ";

class Run : public testing::Test {
 protected:
  Shell shell;
  fs::path out = shell.folder() / "out";
};

TEST_F(Run, WritesRecordsAPlanSheetsAndAReportAndSaysWhere) {
  const Finished result = shell(kMatrix);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "3 cells: 3 run, 0 reused")) << result.out;
  EXPECT_TRUE(contains(result.out, "1 inapplicable")) << result.out;
  EXPECT_TRUE(contains(result.out, "out/report/index.html")) << result.out;
  EXPECT_EQ(count_records(out), 3U);
  EXPECT_TRUE(fs::exists(out / "plan.json"));
  for (const char* format :
       {"index.html", "report.md", "report.csv", "report.tex", "report.json", "statistics.csv"})
    EXPECT_TRUE(fs::exists(out / "report" / format)) << format;
  const Finished validated = shell("./isoline validate out");
  EXPECT_EQ(validated.exit_code, 0) << validated.out;
}

TEST_F(Run, DoneCellsAreNotRepeatedUnlessForced) {
  shell(kMatrix + "--no-report");
  EXPECT_FALSE(fs::exists(out / "report"));
  EXPECT_TRUE(contains(shell(kMatrix).out, "3 cells: 0 run, 3 reused"));
  EXPECT_TRUE(contains(shell(kMatrix + "--force").out, "3 cells: 3 run, 0 reused"));
}

TEST_F(Run, AFlagAfterTheMatrixTakesEffect) {
  EXPECT_TRUE(contains(shell(kMatrix + "--seeds 2..4 --jobs 2").out, "9 cells: 9 run"));
  EXPECT_TRUE(contains(shell(kMatrix + "--seeds =9 --jobs 1").out, "3 cells: 3 run"));
  EXPECT_TRUE(contains(shell(kMatrix + "--seeds 2 --exclusive").out, "6 cells: 6 run"));
}

TEST_F(Run, QuietSaysNothingWhereNothingIsWrong) {
  const Finished result = shell(kMatrix + "--quiet");
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_EQ(result.exit_code, 0);
}

TEST_F(Run, RepetitionsAppendTimings) {
  EXPECT_EQ(shell(kMatrix + "--repeat 3").exit_code, 0);
  EXPECT_TRUE(contains(shell(kMatrix + "--repeat 3").out, "3 cells: 0 run, 3 reused"));
  for (const auto& entry : fs::directory_iterator(out / "runs")) {
    const Json record = read_json(entry.path());
    if (record.at("status") == "inapplicable") continue;
    EXPECT_EQ(record.at("repeat_wall_seconds").size(), 3U) << record.at("request").dump();
  }
}

TEST_F(Run, DryRunPrintsThePlanAndTouchesNothing) {
  const Finished before = shell(kMatrix + "--dry-run");
  EXPECT_EQ(before.exit_code, 0);
  EXPECT_FALSE(fs::exists(out));
  EXPECT_TRUE(contains(before.out, "inapplicable: the Jacobian has no inverse")) << before.out;
  EXPECT_TRUE(contains(before.out, "3 cells: 0 cached, 1 inapplicable, 2 to run")) << before.out;
  shell(kMatrix);
  const Finished after = shell(kMatrix + "--seeds 2 --dry-run");
  EXPECT_TRUE(contains(after.out, "6 cells: 3 cached, 1 inapplicable, 2 to run, about"))
      << after.out;
}

TEST_F(Run, ADryRunOfManyCellsSaysTheTotalFirstAndListsTwenty) {
  const std::string matrix = "./isoline run --problem square --optimizer gd,newton --seeds 15 ";
  const Finished result = shell(matrix + "--dry-run");
  EXPECT_TRUE(result.out.starts_with("30 cells: 0 cached, 0 inapplicable, 30 to run"))
      << result.out;
  EXPECT_EQ(count_lines(result.out), 23U) << result.out;
  EXPECT_TRUE(contains(result.out, "… and 10 more; --all lists them\n")) << result.out;
  EXPECT_EQ(count_lines(shell(matrix + "--dry-run --all").out), 32U);
}

// The folders under results/, in order.
std::vector<std::string> result_folders(const fs::path& at) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(at / "results"))
    names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

TEST_F(Run, AMatrixOfOnesOwnGoesToAFolderNamedByItsPlan) {
  const std::string matrix = "./isoline run --problem square --optimizer newton --quiet ";
  EXPECT_EQ(shell(matrix + "--iterations 5").exit_code, 0);
  const std::vector<std::string> first = result_folders(shell.folder());
  ASSERT_EQ(first.size(), 1U);
  EXPECT_TRUE(first[0].starts_with("square-newton-")) << first[0];
  EXPECT_EQ(shell(matrix + "--iterations 5").exit_code, 0);
  EXPECT_EQ(result_folders(shell.folder()), first) << "the same plan has the same folder";
  EXPECT_EQ(shell(matrix + "--iterations 6").exit_code, 0);
  EXPECT_EQ(result_folders(shell.folder()).size(), 2U) << "another plan has another";
  for (const std::string& name : result_folders(shell.folder()))
    EXPECT_EQ(count_records(shell.folder() / "results" / name), 1U) << name;
}

TEST_F(Run, ProblemsAndOptimizersKeepTheirPartOfASuite) {
  const std::string part = "./isoline run notebook --optimizer newton --problem square ";
  const Finished result = shell(part + "--no-report --out out");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  ASSERT_GE(count_records(out), 1U);
  const std::string whole = shell("./isoline run notebook --dry-run --all").out;
  for (const auto& entry : fs::directory_iterator(out / "runs")) {
    const Json request = read_json(entry.path()).at("request");
    EXPECT_EQ(request.at("problem").at("name"), "square");
    EXPECT_EQ(request.at("optimizer").at("name"), "newton");
    // Its cells are the suite's own, budget and all: they are found again in a run of the whole.
    EXPECT_TRUE(contains(shell("./isoline run notebook --out out --dry-run").out, " cached"));
  }
  EXPECT_LT(count_records(out), count_lines(whole));
  const std::string folder = shell(part + "--dry-run").out;
  EXPECT_TRUE(contains(folder, "result folder: results/notebook-square-newton-")) << folder;
}

TEST_F(Run, TheRecordedCommandRepeatsTheRunInAShell) {
  const std::string words = "run --problem square --optimizer 'gd[rate=0.01]' --iterations 3 ";
  ASSERT_EQ(shell("./isoline " + words + "--no-report --out \"it's here\"").exit_code, 0);
  const fs::path folder = shell.folder() / "it's here";
  ASSERT_EQ(count_records(folder), 1U);
  const auto record = read_json(fs::directory_iterator(folder / "runs")->path());
  const auto command = record.at("provenance").at("run").at("command").get<std::string>();
  const Finished again = shell("./" + command + " --dry-run");
  EXPECT_EQ(again.exit_code, 0) << command << "\n" << again.err;
  EXPECT_TRUE(contains(again.out, "1 cell: 1 cached")) << command << "\n" << again.out;
}

TEST_F(Run, AReportOfAFolderWithoutRecordsIsAnErrorAndWritesNothing) {
  fs::create_directories(out / "runs");
  const Finished result = shell("./isoline report out");
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_TRUE(contains(result.err, "no records in out")) << result.err;
  EXPECT_EQ(count_lines(result.err), 1U) << result.err;
  EXPECT_FALSE(fs::exists(out / "report"));
}

TEST_F(Run, TuningStoresItsPlanAndSheetsLikeEveryRun) {
  const Finished tuned = shell(
      "./isoline tune square --optimizer gd --grid rate=1e-2..1e-1x2 --tuning-seeds =100 --work 50 "
      "--out out");
  EXPECT_EQ(tuned.exit_code, 0) << tuned.err;
  EXPECT_EQ(count_records(out), 2U);
  EXPECT_EQ(read_json(out / "plan.json").at("cells").size(), 2U);
  EXPECT_EQ(shell("./isoline validate out").exit_code, 0);
  EXPECT_EQ(shell("./isoline report out").exit_code, 0);
}

TEST_F(Run, ProgressInAPipeIsPlainLinesOnStandardError) {
  const Finished result = shell(kMatrix);
  EXPECT_TRUE(contains(result.err, "cells 3/3")) << result.err;
  EXPECT_FALSE(contains(result.err, "\r")) << result.err;
  EXPECT_FALSE(contains(result.out, "cells 3/3")) << result.out;
}

TEST_F(Run, AnExplicitRateWinsOverTheTable) {
  shell("./isoline run --problem square --optimizer 'gd[lr=0.01]' --iterations 3 --out out");
  for (const auto& entry : fs::directory_iterator(out / "runs")) {
    const Json optimizer = read_json(entry.path()).at("request").at("optimizer");
    EXPECT_EQ(optimizer.at("options").at("rate"), 0.01);
  }
}

TEST_F(Run, AReportOfAPartialPlanSaysHowMuchIsThere) {
  shell(kMatrix + "--no-report");
  fs::remove(fs::directory_iterator(out / "runs")->path());
  EXPECT_EQ(shell("./isoline report out").exit_code, 0);
  EXPECT_TRUE(contains(read_text(out / "report" / "report.md"), "2 of 3 cells"));
  EXPECT_TRUE(contains(read_text(out / "report" / "index.html"), "2 of 3 cells"));
}

// Two runs of one build agree; a loss raised by 5 % in one cell, and a cell taken away, do not
// pass.
TEST_F(Run, CompareAndMergeSeeOneChangedCell) {
  shell(kMatrix + "--no-report");
  shell("mv out again");
  shell(kMatrix + "--no-report");
  const Finished same = shell("./isoline compare out again");
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_TRUE(contains(same.out, "3 cells in both: 3 equal")) << same.out;
  EXPECT_EQ(shell("./isoline merge out again --out both").exit_code, 0);
  EXPECT_EQ(shell("./isoline validate both").exit_code, 0);
  EXPECT_EQ(count_records(shell.folder() / "both"), 3U);
  for (const auto& entry : fs::directory_iterator(out / "runs")) {
    Json record = read_json(entry.path());
    if (record.at("request").at("optimizer").at("name") != "gd") continue;
    record["summary"]["loss"] = 1.05 * real_of(record["summary"]["loss"]);
    record["curve"]["loss"].back() = record["summary"]["loss"];  // else it contradicts itself
    write_text(entry.path(), record.dump());
  }
  const Finished worse = shell("./isoline compare again out --json");
  EXPECT_EQ(worse.exit_code, 2) << worse.out;
  EXPECT_EQ(parse_json(worse.out, "comparison").at("tables").at(0).at("rows").size(), 1U)
      << worse.out;
  const Finished conflict = shell("./isoline merge out again --out torn");
  EXPECT_EQ(conflict.exit_code, 2);
  EXPECT_TRUE(contains(conflict.err, "brown-dennis × gd")) << conflict.err;
  EXPECT_FALSE(fs::exists(shell.folder() / "torn"));
}

TEST_F(Run, ValidateFindsWhatIsWrongAndExitsTwo) {
  shell(kMatrix + "--no-report");
  const fs::path victim = fs::directory_iterator(out / "runs")->path();
  Json record = read_json(victim);
  record["status"] = "splendid";
  write_text(victim, record.dump());
  const Finished result = shell("./isoline validate out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.out, victim.filename())) << result.out;
  EXPECT_TRUE(contains(result.out, ", 1 wrong")) << result.out;
}

// --- a run that takes long: gradient descent so slow that it neither arrives nor stalls

class LongRun : public Run {
 protected:
  void SetUp() override {
    child_ = fork();
    if (child_ != 0) return;
    fs::current_path(shell.folder());
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
    execl("./isoline", "isoline", "run", "--problem", "square,rosenbrock", "--optimizer",
          "newton,gd[rate=1e-9]", "--iterations", "1000000000", "--target", "0", "--rates", "none",
          "--out", "out", "--jobs", "1", nullptr);
    _exit(1);
  }
  void TearDown() override {
    if (child_ > 0) kill(child_, SIGKILL);
  }
  bool wait_for_records(std::size_t count) const {
    wait_until([&] { return count_records(out) >= count || kill(child_, 0) != 0; });
    return count_records(out) >= count;
  }
  // The first lets running cells finish, which here would take for ever; the second stops them.
  int exit_code_after_two(int signal) {
    kill(child_, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // two at once would be one
    kill(child_, signal);
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t child_ = 0;

 protected:
  pid_t child() const { return child_; }
};

TEST_F(LongRun, TheParentHasOneThread) {
  ASSERT_TRUE(wait_for_records(1));
  const std::string status = read_text("/proc/" + std::to_string(child()) + "/status");
  EXPECT_TRUE(contains(status, "\nThreads:\t1\n")) << status;
}

TEST_F(LongRun, ThatIsInterruptedTwiceExitsWith130AndGoesOn) {
  ASSERT_TRUE(wait_for_records(1));
  EXPECT_EQ(exit_code_after_two(SIGINT), 130);
  const std::size_t kept = count_records(out);
  EXPECT_LT(kept, 4U);
  const Finished rest = shell(
      "./isoline run --problem square --optimizer newton --iterations 1000000000 --target 0 "
      "--rates none --out out --no-report");
  EXPECT_TRUE(contains(rest.out, "1 cell: 0 run, 1 reused")) << rest.out;
  EXPECT_TRUE(
      contains(shell("./isoline report out && cat out/report/report.md").out, "of 4 cells"));
}

}  // namespace
}  // namespace isoline::benchmarks
