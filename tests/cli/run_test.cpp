// The verbs on a result folder: run and its retries, replay, report and validate; full disks.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <functional>
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
  std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(out / "runs"))
      if (entry.path().extension() == ".json") all.push_back(entry.path());
    return all;
  }
  std::vector<Json> records() const {
    std::vector<Json> all;
    for (const fs::path& file : files()) all.push_back(read_json(file));
    return all;
  }
  // Changes every record of an optimizer, or of all ("*").
  void change(const std::string& optimizer, const std::function<void(Json&)>& how) const {
    for (const fs::path& file : files()) {
      Json record = read_json(file);
      if (optimizer != "*" && record.at("request").at("optimizer").at("name") != optimizer)
        continue;
      how(record);
      write_text(file, record.dump() + "\n");
    }
  }

  Shell shell;
  fs::path out = shell.folder() / "out";
};

TEST_F(Run, WritesRecordsAPlanSheetsAndAReportAndSaysWhere) {
  const Finished result = shell.expect(
      kMatrix, {.out = {"3 cells: 3 new, 0 reused", "1 inapplicable", "out/report/index.html"},
                .err = {"cells 3/3"}});
  EXPECT_FALSE(contains(result.err, "\r")) << "progress in a pipe is plain lines: " << result.err;
  EXPECT_FALSE(contains(result.out, "cells 3/3")) << result.out;
  EXPECT_EQ(count_records(out), 3U);
  EXPECT_TRUE(fs::exists(out / "plan.json"));
  for (const char* format :
       {"index.html", "report.md", "report.csv", "report.tex", "report.json", "statistics.csv"})
    EXPECT_TRUE(fs::exists(out / "report" / format)) << format;
  shell.expect("./isoline validate out");
}

TEST_F(Run, DoneCellsAreNotRepeatedUnlessForced) {
  shell(kMatrix + "--no-report");
  EXPECT_FALSE(fs::exists(out / "report"));
  shell.expect(kMatrix, {.out = {"3 cells: 0 new, 3 reused"}});
  shell.expect(kMatrix + "--force", {.out = {"3 cells: 3 new, 0 reused"}});
  const Finished quiet = shell.expect(kMatrix + "--force --quiet");
  EXPECT_EQ(quiet.out + quiet.err, "") << "where nothing is wrong";
}

TEST_F(Run, AFlagAfterTheMatrixTakesEffect) {
  shell.expect(kMatrix + "--seeds 2..4 --jobs 2", {.out = {"9 cells: 9 new"}});
  shell.expect(kMatrix + "--seeds =9 --jobs 1", {.out = {"3 cells: 3 new"}});
  shell.expect(kMatrix + "--seeds 2 --exclusive", {.out = {"6 cells: 6 new"}});
}

TEST_F(Run, InstancesAndStartsAreCrossed) {
  const std::string matrix = "./isoline run --problem sine --optimizer newton --out out ";
  shell.expect(matrix + "--instances 2 --starts 3", {.out = {"6 cells: 6 new"}});
  const std::string csv = read_text(out / "report" / "report.csv");
  EXPECT_TRUE(contains(csv, "optimizer,method,seed,instance,start,status")) << csv;
  EXPECT_TRUE(contains(csv, ",newton,1001002,1,2,")) << csv;
  EXPECT_TRUE(contains(csv, "--seeds =1:2 ")) << csv;
  shell.expect(matrix + "--seeds 1:2,=1 --dry-run", {.out = {"seed 1:2", "2 cells: 2 cached"}});
  shell.expect(matrix + "--seeds 3 --starts 3", {.exit_code = 1, .err = {"--seeds", "--starts"}});
}

TEST_F(Run, RepetitionsAppendTimings) {
  shell.expect(kMatrix + "--repeat 3");
  shell.expect(kMatrix + "--repeat 3", {.out = {"3 cells: 0 new, 3 reused"}});
  for (const Json& record : records()) {
    if (record.at("status") == "inapplicable") continue;
    EXPECT_EQ(record.at("repeat_wall_seconds").size(), 3U) << record.at("request").dump();
  }
}

TEST_F(Run, DryRunPrintsThePlanAndTouchesNothing) {
  shell.expect(kMatrix + "--dry-run",
               {.out = {"inapplicable: the Jacobian ", "3 cells: 0 cached, 1 inapplicable, 2 "}});
  EXPECT_FALSE(fs::exists(out));
  shell(kMatrix);
  shell.expect(kMatrix + "--seeds 2 --dry-run", {.out = {"6 cells: 3 cached, 1 inapplicable, 2 "}});
}

TEST_F(Run, ADryRunOfManyCellsSaysTheTotalFirstAndListsTwenty) {
  const std::string matrix = "./isoline run --problem square --optimizer gd,newton --seeds 15 ";
  const Finished result =
      shell.expect(matrix + "--dry-run", {.out = {"… and 10 more cells; --all"}});
  EXPECT_TRUE(result.out.starts_with("30 cells: 0 cached, 0 inapplicable, 30 ")) << result.out;
  EXPECT_EQ(count_lines(result.out), 23U) << result.out;
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
  shell.expect(matrix + "--iterations 5");
  const std::vector<std::string> first = result_folders(shell.folder());
  ASSERT_EQ(first.size(), 1U);
  EXPECT_TRUE(first[0].starts_with("square-newton-")) << first[0];
  shell.expect(matrix + "--iterations 5");
  EXPECT_EQ(result_folders(shell.folder()), first) << "the same plan has the same folder";
  shell.expect(matrix + "--iterations 6");
  EXPECT_EQ(result_folders(shell.folder()).size(), 2U) << "another plan has another";
  for (const std::string& name : result_folders(shell.folder()))
    EXPECT_EQ(count_records(shell.folder() / "results" / name), 1U) << name;
}

TEST_F(Run, ProblemsAndOptimizersKeepTheirPartOfASuite) {
  const std::string part = "./isoline run notebook --optimizer newton --problem square ";
  shell.expect(part + "--no-report --out out");
  ASSERT_GE(count_records(out), 1U);
  for (const Json& record : records()) {
    EXPECT_EQ(record.at("request").at("problem").at("name"), "square");
    EXPECT_EQ(record.at("request").at("optimizer").at("name"), "newton");
  }
  // Its cells are the suite's own, budget and all: they are found again in a run of the whole.
  shell.expect("./isoline run notebook --out out --dry-run",
               {.out = {fmt::format(" {} cached", count_records(out))}});
  EXPECT_LT(count_records(out), count_lines(shell("./isoline run notebook --dry-run --all").out));
  shell.expect(part + "--dry-run", {.out = {"result folder: results/notebook-square-newton-"}});
}

TEST_F(Run, TheRecordedCommandRepeatsTheRunInAShell) {
  const std::string words = "run --problem square --optimizer 'gd[rate=0.01]' --iterations 3 ";
  shell.expect("./isoline " + words + "--no-report --out \"it's here\"");
  out = shell.folder() / "it's here";
  ASSERT_EQ(count_records(out), 1U);
  const auto command = records()[0].at("provenance").at("run").at("command").get<std::string>();
  shell.expect("./" + command + " --dry-run", {.out = {"1 cell: 1 cached"}});
}

TEST_F(Run, AReportOfAFolderWithoutRecordsIsAnErrorAndWritesNothing) {
  fs::create_directories(out / "runs");
  const Finished result =
      shell.expect("./isoline report out", {.exit_code = 1, .err = {"no records in out"}});
  EXPECT_EQ(count_lines(result.err), 1U) << result.err;
  EXPECT_FALSE(fs::exists(out / "report"));
}

TEST_F(Run, TuningStoresItsPlanAndSheetsLikeEveryRun) {
  shell.expect(
      "./isoline tune square --optimizer gd --grid rate=1e-2..1e-1x2 --tuning-seeds =100 --work 50 "
      "--out out");
  EXPECT_EQ(count_records(out), 2U);
  EXPECT_EQ(read_json(out / "plan.json").at("cells").size(), 2U);
  shell.expect("./isoline validate out && ./isoline report out");
}

TEST_F(Run, AnExplicitRateWinsOverTheTable) {
  shell("./isoline run --problem square --optimizer 'gd[lr=0.01]' --iterations 3 --out out");
  for (const Json& record : records())
    EXPECT_EQ(record.at("request").at("optimizer").at("options").at("rate"), 0.01);
}

TEST_F(Run, AReportOfAPartialPlanSaysHowMuchIsThere) {
  shell(kMatrix + "--no-report");
  fs::remove(files()[0]);
  shell.expect("./isoline report out");
  for (const char* page : {"report.md", "index.html"})
    EXPECT_TRUE(contains(read_text(out / "report" / page), "2 of 3 cells")) << page;
}

// Two runs of one build are united; a loss raised by 5 % in one cell does not pass.
TEST_F(Run, MergeSeesOneChangedCell) {
  shell(kMatrix + "--no-report");
  shell("mv out again");
  shell(kMatrix + "--no-report");
  shell.expect("./isoline merge out again --out both && ./isoline validate both");
  EXPECT_EQ(count_records(shell.folder() / "both"), 3U);
  change("gd", [](Json& record) {
    record["summary"]["loss"] = 1.05 * real_of(record["summary"]["loss"]);
    record["curve"]["loss"].back() = record["summary"]["loss"];  // else it contradicts itself
  });
  shell.expect("./isoline compare again out --json", {.exit_code = 2});
  shell.expect("./isoline merge out again --out torn",
               {.exit_code = 2, .err = {"brown-dennis × gd"}});
  EXPECT_FALSE(fs::exists(shell.folder() / "torn"));
}

TEST_F(Run, ValidateFindsWhatIsWrongAndExitsTwo) {
  shell(kMatrix + "--no-report");
  const fs::path victim = files()[0];
  Json record = read_json(victim);
  record["status"] = "splendid";
  write_text(victim, record.dump());
  shell.expect("./isoline validate out",
               {.exit_code = 2, .out = {victim.filename(), ", 1 invalid"}});
}

// --- budgets, starts and targets of one's own

TEST_F(Run, StallsAfterAsManyIterationsAsAskedAndUsualCellsKeepTheirNames) {
  const std::string still =
      "./isoline run --problem rosenbrock --optimizer 'gd[rate=1e-300]' "
      "--iterations 250 --out out --no-report ";
  const auto iterations = [&](const char* status) {
    std::int64_t most = 0;
    for (const Json& record : records())
      if (record.at("status") == status)
        most = std::max(most, record.at("summary").at("iterations").get<std::int64_t>());
    return most;
  };
  shell.expect(still, {.out = {"1 stalled"}});
  EXPECT_EQ(iterations("stalled"), 100);
  shell.expect(still + "--stall 100", {.out = {"0 new, 1 reused"}});
  shell.expect(still + "--stall 150", {.out = {"1 stalled"}});
  EXPECT_EQ(iterations("stalled"), 150);
  shell.expect(still + "--stall never", {.out = {"1 budget"}});
  EXPECT_EQ(iterations("budget"), 250);
  shell.expect(still + "--stall 0", {.exit_code = 1, .err = {"--stall"}});
  write_text(shell.folder() / "mine.json",
             R"({"schema": "isoline.suite/1", "name": "mine", "matrix": [
                 {"problems": ["rosenbrock"], "optimizers": ["gd[rate=1e-300]"],
                  "budget": {"iterations": 250, "stall": "never"}}]})");
  shell.expect("./isoline run mine.json --out out --no-report", {.out = {"0 new, 1 reused"}});
  shell.expect("./isoline validate out mine.json");
}

TEST_F(Run, StopsAtTheNoiseWhereAskedAndTheRecordSaysSo) {
  const std::string noisy =
      "./isoline run --problem 'burgers[N=16,noise=0.01]' --optimizer ceres-lm --out out "
      "--no-report ";
  shell.expect(noisy + "--stop 'discrepancy[tau=1.2]'", {.out = {"1 discrepancy"}});
  ASSERT_EQ(records().size(), 1U);
  const Json record = records()[0];
  const Json& all = record.at("curve").at("discrepancy");
  const double most = 1.2 * record.at("noise_level").get<double>();
  EXPECT_LE(all.back().get<double>(), most);
  EXPECT_GT(all.at(all.size() - 2).get<double>(), most);
  shell.expect(noisy + "--stop none", {.out = {"1 new"}});
  EXPECT_EQ(records().size(), 2U);
  shell.expect(noisy + "--stop discrepency", {.exit_code = 1, .err = {"--stop"}});
  shell.expect(noisy + "--stop 'discrepancy[tau=0.5]'", {.exit_code = 1, .err = {"tau"}});
  write_text(shell.folder() / "mine.json",
             R"({"schema": "isoline.suite/1", "name": "mine", "matrix": [
                 {"problems": ["burgers[N=16]"], "features": ["noise=0.01"],
                  "optimizers": ["ceres-lm"], "budget": {"stop": "discrepancy[tau=1.2]"}}]})");
  shell.expect("./isoline run mine.json --out out --no-report", {.out = {"0 new, 1 reused"}});
  shell.expect("./isoline validate out mine.json");
}

TEST_F(Run, MoreIterationsAreOtherCellsAndAFinishedCellKeepsNoCheckpoint) {
  shell.expect(kMatrix + "--no-report", {.out = {"3 cells: 3 new"}});
  shell.expect(kMatrix + "--no-report --seeds 2", {.out = {"6 cells: 3 new, 3 reused"}});
  EXPECT_TRUE(!fs::exists(out / "checkpoints") || fs::is_empty(out / "checkpoints"));
  const std::string longer =
      "./isoline run --problem brown-dennis --optimizer gd,newton "
      "--iterations 40 --out out --no-report";
  shell.expect(longer, {.out = {"2 cells: 2 new, 0 reused"}});
  EXPECT_EQ(count_records(out), 8U);
}

TEST_F(Run, BeginsAtTheStartOfAFileWhoseContentBelongsToTheCell) {
  const std::string run =
      "./isoline run --problem rosenbrock --optimizer newton --out out --no-report ";
  const auto begin = [&](const char* numbers) { write_text(shell.folder() / "a.csv", numbers); };
  begin("0.5,2");
  shell.expect(run + "--start a.csv", {.out = {"1 new"}});
  EXPECT_EQ(records().at(0).at("summary").at("start_loss"), 153.25);  // ½ (17.5² + 0.5²)
  EXPECT_EQ(records().at(0).at("minimum"), 0);
  shell.expect(
      "./isoline run --problem 'rosenbrock[start-file=a.csv]' --optimizer newton --out "
      "out --no-report",
      {.out = {"1 reused"}});
  shell.expect("./isoline replay out/runs/*.json");
  begin("0.5,1");
  shell.expect("./isoline replay out/runs/*.json", {.exit_code = 4, .out = {"a.csv"}});
  shell.expect(run + "--start a.csv", {.out = {"1 new"}});
  EXPECT_EQ(count_records(out), 2U);
  begin("1,2,3");
  shell.expect(run + "--start a.csv", {.exit_code = 1, .err = {"a.csv", "rosenbrock", "(1, 3)"}});
  shell.expect(run + "--start b.csv", {.exit_code = 1, .err = {"b.csv"}});
  shell.expect("./isoline run --problem 'sine[mode=learn]' --optimizer gd --start a.csv",
               {.exit_code = 1, .err = {"sine"}});
}

TEST_F(Run, FitsTheTargetOfAFileWhoseSolutionIsUnknown) {
  write_text(shell.folder() / "y.csv", "0\n0.5\n");  // 10 (x₂ − x₁²) and 1 − x₁
  shell.expect(
      "./isoline run --problem rosenbrock --optimizer gauss-newton --target-data y.csv "
      "--out out --no-report",
      {.out = {"1 new"}});
  const Json record = records().at(0);
  EXPECT_LT(record.at("summary").at("loss"), 1e-20);
  EXPECT_EQ(record.at("minimum"), nullptr);
  EXPECT_EQ(record.at("verified").at("1e-6"), nullptr);
  EXPECT_EQ(record.at("aim"), "loss");
}

// --- damaged files of the user

TEST_F(Run, DamagedFilesAreNamedWithTheirPlace) {
  shell(kMatrix + "--no-report");
  for (const char* text : {R"({"schema": "isoline.baseline/1", "cells": 3})",
                           R"({"schema": "isoline.baseline/1", "cells": [{"given": 99}]})", "[]",
                           R"({"schema": "isoline.rates/1", "rows": [{"problem": 3}]})",
                           R"({"schema": "isoline.suite/1", "name": "x", "matrix": 3})"}) {
    write_text(shell.folder() / "bad.json", text);
    for (const char* command :
         {"compare bad.json out", "run bad.json --dry-run", "run --rates bad.json --dry-run",
          "run --best bad.json --dry-run", "compare out out --allow bad.json",
          "tune square --optimizer gd --work 20 --table bad.json"}) {
      const Finished done = shell(std::string("./isoline ") + command);
      EXPECT_EQ(done.exit_code, 1) << command << text << done.err;
      EXPECT_FALSE(contains(done.err, "json.exception")) << command << text << done.err;
      const bool is_no_baseline = contains(command, "compare bad") && !contains(text, "baseline");
      EXPECT_TRUE(is_no_baseline || contains(done.err, "bad.json")) << command << done.err;
    }
  }
  shell.expect("./isoline run --problem 'navier-stokes[N=7]' --optimizer gd --dry-run",
               {.exit_code = 1, .err = {"navier-stokes: ", "even", "7"}});
}

// --- what a component does to its parent, and a system without room

TEST_F(Run, GoesOnWhereAComponentTerminatesItsParent) {
  write_text(shell.folder() / "kills.py",
             "import os, signal, isoline\n"
             "os.kill(os.getppid(), signal.SIGTERM)\n"
             "isoline.problem(lambda x: [2 * x[0]], start=[1.0], jacobian=lambda x: [[2]])\n");
  const std::string problem = "'process[command=\"python3 kills.py\"]' ";
  shell.expect("./isoline describe " + problem);
  shell.expect("./isoline run --problem " + problem + "--optimizer gd --out out",
               {.exit_code = 130, .err = {"killed by signal 15", "sent by another program"}});
}

TEST_F(Run, EndsWithAMessageWhereNoFileMayGrow) {
  shell.expect("ulimit -f 1; " + kMatrix + "--no-report",
               {.exit_code = 2, .err = {"cannot write out/", "File too large"}});
}

TEST_F(Run, EndsWithAMessageWhereNoFileCanBeOpened) {
  for (int files = 6; files <= 12; ++files) {
    const Finished done =
        shell(fmt::format("ulimit -n {}; timeout 60 {}--jobs 2 --no-report", files, kMatrix));
    EXPECT_TRUE(done.exit_code == 0 ||
                ((done.exit_code == 2 || done.exit_code == 130) && !done.err.empty()))
        << files << ": " << done.exit_code << done.err;
    fs::remove_all(out);
  }
}

// --- a run that takes long: gradient descent so slow that it neither arrives nor stalls

class LongRun : public Run {
 protected:
  void SetUp() override {
    child = fork();
    if (child != 0) return;
    fs::current_path(shell.folder());
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
    execl("./isoline", "isoline", "run", "--problem", "square,rosenbrock", "--optimizer",
          "newton,gd[rate=1e-9]", "--iterations", "1000000000", "--target", "0", "--rates", "none",
          "--out", "out", "--jobs", "1", nullptr);
    _exit(1);
  }
  void TearDown() override {
    if (child > 0) kill(child, SIGKILL);
  }
  bool wait_for_records(std::size_t count) const {
    wait_until([&] { return count_records(out) >= count || kill(child, 0) != 0; });
    return count_records(out) >= count;
  }
  // The first lets running cells finish, which here would take for ever; the second stops them.
  int exit_code_after_two(int signal) {
    kill(child, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // two at once would be one
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    child = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  pid_t child = 0;
};

TEST_F(LongRun, ThatIsInterruptedTwiceExitsWith130AndGoesOn) {
  ASSERT_TRUE(wait_for_records(1));
  const std::string status = read_text("/proc/" + std::to_string(child) + "/status");
  EXPECT_TRUE(contains(status, "\nThreads:\t1\n")) << "the parent has one thread: " << status;
  EXPECT_EQ(exit_code_after_two(SIGINT), 130);
  EXPECT_LT(count_records(out), 4U);
  shell.expect(
      "./isoline run --problem square --optimizer newton --iterations 1000000000 --target 0 "
      "--rates none --out out --no-report",
      {.out = {"1 cell: 0 new, 1 reused"}});
  shell.expect("./isoline report out && cat out/report/report.md", {.out = {"of 4 cells"}});
}

// --- --retry, and records from the future, which change nothing

const std::string kRetried =
    "./isoline run --problem square,brown-dennis --optimizer gd,newton --iterations 20 --out out "
    "--no-report ";

class Retry : public Run {
 protected:
  void SetUp() override { ASSERT_EQ(shell(kRetried).exit_code, 0); }
};

TEST_F(Retry, RepeatsCellsThatEndedSoAndNoOthers) {
  change("gd", [](Json& record) { record["status"] = "crashed"; });
  EXPECT_TRUE(contains(shell(kRetried + "--retry timeout,memory").out, "0 new, 4 reused"));
  shell.expect(kRetried + "--retry crashed --dry-run",
               {.out = {"4 cells: 2 cached, 0 inapplicable, 2 "}});
  const Finished again =
      shell.expect(kRetried + "--retry failed,crashed", {.out = {"4 cells: 2 new, 2 reused"}});
  EXPECT_FALSE(contains(again.err, "repetitions differ")) << again.err;
  shell.expect(kRetried + "--retry failed,crashed", {.out = {"0 new, 4 reused"}});
  shell.expect("./isoline run --retry failed notebook --dry-run");  // the word behind is a suite
}

// Timings of a cell that went wrong are no timings of the one that takes its place.
TEST_F(Retry, ForgetsTheTimesOfWhatItReplaces) {
  change("gd", [](Json& record) {
    record["status"] = "memory";
    record["repeat_wall_seconds"] = {1e-5};
  });
  shell.expect(kRetried + "--retry memory");
  for (const Json& record : records()) EXPECT_EQ(record.at("repeat_wall_seconds").size(), 1U);
}

TEST_F(Retry, NeedsNoClockThatGoesForward) {
  change("*",
         [](Json& record) { record["provenance"]["run"]["started"] = "2199-12-31T23:59:59Z"; });
  shell.expect(kRetried, {.out = {"4 cells: 0 new, 4 reused"}});
  shell.expect(kRetried + "--force", {.out = {"4 cells: 4 new, 0 reused"}});
  for (const Json& record : records())
    EXPECT_LT(record.at("provenance").at("run").at("started"), "2199");
}

// A record of another build, from the future, does not win over the one of this build.
TEST_F(Retry, ARecordOfTheFutureDoesNotHideThisBuildsOwn) {
  Json record = records()[0];
  record["build"] = std::string(16, 'f');
  record["provenance"]["run"]["started"] = "2199-12-31T23:59:59Z";
  const std::string cell = record.at("cell");
  write_text(out / "runs" / (cell + "-" + std::string(16, 'f') + ".json"), record.dump() + "\n");
  const Finished reused = shell.expect(kRetried + "--reuse", {.out = {"4 cells: 0 new, 4 reused"}});
  EXPECT_FALSE(contains(reused.err, "another build")) << reused.err;
}

// --- replay: a record is run again, equal, or the first difference is named

class Replay : public Run {
 protected:
  void SetUp() override {
    shell.expect(
        "./isoline run --problem square,brown-dennis --optimizer newton,gd,inverse-gradient "
        "--iterations 30 --seeds 0..1 --out out --no-report --quiet");
  }
  // The first record of an optimizer, changed, as changed.json; its replay.
  Finished replay(const char* optimizer, const std::function<void(Json&)>& how,
                  const Expected& expected) const {
    for (Json& record : records()) {
      if (record.at("request").at("optimizer").at("name") != optimizer) continue;
      how(record);
      write_text(shell.folder() / "changed.json", record.dump());
      return shell.expect("./isoline replay changed.json", expected);
    }
    ADD_FAILURE() << "no record of " << optimizer;
    return {};
  }
};

TEST_F(Replay, OfRecordsOfThisBuildIsEqualAndWritesNothing) {
  const Finished all =
      shell.expect("./isoline replay out/runs/*.json", {.out = {"equal, 30 iterations"}});
  EXPECT_EQ(count_lines(all.out), 12U) << all.out;
  EXPECT_EQ(count_records(out), 12U);
  shell.expect("./isoline validate out");
  shell.expect("./isoline replay out", {.exit_code = 1});
  write_text(shell.folder() / "x.npy", "\x93NUMPY");
  shell.expect("./isoline replay x.npy", {.exit_code = 1, .err = {"x.npy is binary, not JSON"}});
  replay("gd", [](Json& record) { record["status"] = true; },
         {.exit_code = 1, .err = {"changed.json: not a record"}});
}

TEST_F(Replay, NamesTheFirstDifferenceInTheCurveOrBesideIt) {
  replay("gd",
         [](Json& record) {
           record["curve"]["loss"][17] = 0.25;
           record["curve"]["step_norm"][20] = 0.5;
         },
         {.exit_code = 2, .out = {" 17: 0.25 against "}});
  replay("newton", [](Json& record) { record["counts"]["forward"] = 12345; },
         {.exit_code = 2, .out = {"differs: counts/forward: 12345 against "}});
  replay("newton", [](Json& record) { record["verified"]["1e-3"] = false; }, {.exit_code = 2});
  const Finished several =
      shell.expect("./isoline replay changed.json out/runs/*.json", {.exit_code = 2});
  EXPECT_EQ(count_lines(several.out), 13U) << "the worst is the exit code";
}

TEST_F(Replay, OfASampleTakesSoManyRecordsOfAFolder) {
  const Finished half = shell.expect("./isoline replay out --sample 50% --seed 3",
                                     {.out = {"records, sampled with --seed 3"}});
  const std::size_t all = count_records(out);
  EXPECT_EQ(count_lines(half.out), all / 2 + 1) << half.out;
  EXPECT_EQ(shell("./isoline replay out --sample 50% --seed 3").out, half.out);
  fs::create_directories(shell.folder() / "forged" / "runs");
  replay("gd", [](Json& record) { record["curve"]["loss"][17] = 0.25; }, {.exit_code = 2});
  fs::rename(shell.folder() / "changed.json", shell.folder() / "forged" / "runs" / "one.json");
  shell.expect("./isoline replay forged --sample 1%", {.exit_code = 2});
  shell.expect("./isoline replay out --sample nothing", {.exit_code = 1});
}

TEST_F(Replay, OfAnotherBuildOrAComponentThatIsNotThereIsNotComparable) {
  replay("gd",
         [](Json& record) {
           record["build"] = std::string(16, '0');
           record["build_parts"]["optimizer"] = std::string(16, '1');
         },
         {.exit_code = 4, .out = {"parts differ: optimizer; equal"}});
  replay("gd", [](Json& record) { record["request"]["problem"]["name"] = "sqare"; },
         {.exit_code = 4, .out = {"did you mean 'square'"}});
}

TEST_F(Replay, OfARunThatAClockEndedGoesAsFarAsBothWent) {
  const auto cut = [](Json& record) {
    record["nondeterministic"] = true;
    record["status"] = "timeout";
    record.erase("trajectory");
    const auto shorten = [](Json& column) {
      if (column.is_array()) column = std::vector<Json>(column.begin(), column.begin() + 13);
    };
    for (Json& column : record["curve"]) shorten(column);
    for (Json& column : record["curve"]["counts"]) shorten(column);
    record["curve"]["loss"][12] = 77;  // where it was ended, in the midst of a step
  };
  replay("gd", cut, {.out = {"equal up to iteration 11"}});
}

// Full, exhausted or read-only disks: a clear message, no corrupt file, and the same command
// continues when there is room. The file systems are small and mounted in a separate namespace.

const std::string kRunOnDisk =
    "./isoline run --problem square,beale,wood --optimizer gd,newton,adam --rates none "
    "--iterations 300 --seeds 4 --out disk/out --jobs 2 ";

class Disk : public testing::Test {
 protected:
  // A script in a namespace where `disk` is a file system of its own.
  Finished on_disk(const std::string& options, const std::string& script) {
    std::filesystem::create_directories(shell.folder() / "disk");
    write_text(shell.folder() / "script.sh",
               "set -u\nmount -t tmpfs -o " + options + " none disk || exit 99\n" + script);
    return shell("unshare --user --map-root-user --mount bash script.sh");
  }
  void SetUp() override {
    const Finished allowed = on_disk("size=1m", "exit 0");
    if (allowed.exit_code != 0)
      GTEST_SKIP() << "no file system can be mounted here: " << allowed.err;
  }
  Shell shell;
};

// Room for the plan and some records, in bytes or in inodes. The second run has room for all of
// them.
TEST_F(Disk, ThatIsFullEndsTheRunWithAMessageAndTheNextGoesOnToSoundFiles) {
  for (const auto& [small, large] :
       {std::pair("size=300k", "size=64m"), std::pair("size=64m,nr_inodes=24", "nr_inodes=4096")}) {
    const Finished both =
        on_disk(small, kRunOnDisk + "--no-report 2>first.err; echo first $?\nmount -o remount," +
                           large + " disk\n" + kRunOnDisk +
                           "2>second.err; echo second $?\n"
                           "./isoline validate disk/out; echo valid $?\n"
                           "ls disk/out/runs | grep -vc 'json$'");
    const std::string first = read_text(shell.folder() / "first.err");
    EXPECT_TRUE(contains(first, "No space left on device")) << first;
    for (const char* part : {"first 2\n", "second 0\n", "valid 0\n"})
      EXPECT_TRUE(contains(both.out, part))
          << both.out << both.err << read_text(shell.folder() / "second.err");
    EXPECT_TRUE(both.out.ends_with("\n0\n")) << both.out;
  }
}

TEST_F(Disk, ThatIsReadOnlyIsTheCallersMistakeBeforeAnythingRuns) {
  const Finished result =
      on_disk("size=64m", kRunOnDisk + "--quiet --no-report; echo first $?\n" +
                              "mount -o remount,ro disk\n" + kRunOnDisk +
                              "--force 2>second.err; echo second $?\n" +
                              "./isoline run --problem square --optimizer gd --out disk/new "
                              "2>third.err; echo third $?\n");
  EXPECT_TRUE(contains(result.out, "first 0\nsecond 1\nthird 1\n")) << result.out << result.err;
  for (const char* file : {"second.err", "third.err"}) {
    const std::string message = read_text(shell.folder() / file);
    EXPECT_TRUE(contains(message, "Read-only file system")) << message;
    EXPECT_EQ(count_lines(message), 1U) << message;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
