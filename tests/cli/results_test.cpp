// Results of runs: plans in shards, exports, the gate.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/npy.h"
#include "core/records/record.h"
#include "core/status.h"
#include "tests/cli/shell.h"
#include "tests/reports/true_record.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const std::string kTwelveCells =
    "--problem square,rosenbrock,beale --optimizer gd,adam,newton,ceres-lm --seeds 2 "
    "--iterations 40 ";

// A choice is that of the report: methods that need more than the user has are not named.
TEST(Choose, NamesAMethodThatNeedsNoMoreThanTheUserHas) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem rosenbrock,beale,square,scaling --optimizer "
      "nlopt-bobyqa,gd,newton,gauss-newton --iterations 300 --out out --no-report --quiet");
  const auto chosen = [&](const std::string& have) {
    return shell.expect("./isoline report out --view choice --have " + have).out;
  };
  EXPECT_TRUE(contains(chosen("forward"), "nlopt-bobyqa")) << chosen("forward");
  EXPECT_FALSE(contains(chosen("forward"), "newton"));
  EXPECT_FALSE(contains(chosen("gradient"), "gauss-newton"));
  EXPECT_TRUE(contains(chosen("forward,jacobian"), "gauss-newton"));
  shell.expect("./isoline report out --view choice --noise 0.01",
               {.exit_code = 1, .err = {"1 % noise"}});
  shell.expect("./isoline report out --view choice --have wings", {.exit_code = 1});
}

TEST(Contest, HasItsContrastsTestedByTheReport) {
  const Shell shell;
  shell.expect("./isoline run contest --problem 'exponential[n=4]' --out out --no-report --quiet");
  const auto report = [&] { return shell.expect("./isoline report out").out; };
  EXPECT_FALSE(contains(report(), "contrasts named")) << "they were named for the whole suite";
  shell.expect("sed -i 's/part of contest/contest/' out/plan.json");
  EXPECT_TRUE(contains(report(), "contrasts named before")) << report();
  EXPECT_TRUE(contains(report(), "was not decided")) << report();
  shell.expect("grep -l '\"adam\"' out/runs/*.json | xargs rm");
  shell.expect("./isoline report out", {.out = {"no contrast is tested"}});
}

TEST(Output, InAFolderThatCannotBeIsRefusedWithTheReason) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd,adam --seeds 2 --iterations 20 "
      "--out out --no-report --quiet");
  write_text(shell.folder() / "README.md", "mine");
  const std::vector<std::string> with_folder = {"report out",
                                                "site out",
                                                "figures out",
                                                "merge out",
                                                "audit gd",
                                                "claims",
                                                "run --problem square --optimizer gd",
                                                "export out --format coco"};
  for (const std::string& verb : with_folder) {
    shell.expect("./isoline " + verb + " --out README.md/x",
                 {.exit_code = 1, .err = {"README.md is a file", "--out"}});
    shell.expect("./isoline " + verb + " --out /proc/nowhere",
                 {.exit_code = 1, .err = {"/proc", "--out"}});
  }
  for (const std::string verb : {"report out", "site out", "figures out"})
    shell.expect("./isoline " + verb + " --out README.md",
                 {.exit_code = 1, .err = {"README.md: it is a file", "--out"}});
  for (const std::string verb : {"export out", "baseline out", "solution out --format npy"})
    shell.expect("./isoline " + verb + " --out README.md/x",
                 {.exit_code = 1, .err = {"README.md: it is a file", "--out"}});
  shell.expect("./isoline baseline out --best README.md/x",
               {.exit_code = 1, .err = {"README.md: it is a file", "--out"}});
  EXPECT_EQ(read_text(shell.folder() / "README.md"), "mine");
}

// A feature belongs to the setting; its default is the plain problem.
TEST(Features, AreOptionsOfEveryProblemAndFactorsOfASuite) {
  const Shell shell;
  const auto cells = [&](const std::string& problem) {
    return shell.expect("./isoline run --problem '" + problem + "' --optimizer gd --dry-run --all")
        .out;
  };
  EXPECT_TRUE(contains(cells("burgers[N=8,noise=0]"), "burgers[N=8] "));
  EXPECT_TRUE(contains(cells("burgers[noise=1e-2,N=8]"), "burgers[N=8,noise=0.01]"));
  shell.expect("./isoline run --problem 'burgers[N=8,noise=-1]' --optimizer gd",
               {.exit_code = 1, .err = {"noise must be"}});
  write_text(shell.folder() / "s.json",
             R"({"schema": "isoline.suite/1", "name": "s", "matrix": [{"problems": ["burgers[N=8]"],
                 "features": ["plain", "noise=0.01", "scale=100,rotate=yes", "model=\"viscosity=0.2\""],
                 "optimizers": ["gauss-newton", "gd"], "budget": {"iterations": 20}}]})");
  shell.expect("./isoline run s.json --out out --no-report", {.out = {"8 cells: 8 new"}});
  EXPECT_EQ(shell.expect("./isoline replay out/runs/*.json").out.find("differ"), std::string::npos);
}

TEST(WrongValues, NameTheirFile) {
  const Shell shell;
  write_text(shell.folder() / "s.json",
             R"({"schema": "isoline.suite/1", "name": "s", "matrix": [{"problems": ["heat[M=8]"],
                 "optimizers": ["gd"]}]})");
  write_text(shell.folder() / "r.json", R"({"schema": "isoline.rates/1", "rows": [
             {"problem": "rosenbrock", "optimizer": "adam", "options": {"rate": ["a"]}}]})");
  shell("mkfifo pipe.bz2; echo torn > torn.bz2");
  shell.expect("./isoline run s.json --dry-run", {.exit_code = 1, .err = {"s.json: heat"}});
  for (const std::string wrong : {R"("matrix": [{"problems": ["heat["], "optimizers": ["gd"]}])",
                                  R"("cells_of": "zzzz", "rates": "none")"}) {
    write_text(shell.folder() / "w.json",
               R"({"schema": "isoline.suite/1", "name": "w", )" + wrong + "}");
    shell.expect("./isoline run w.json --dry-run", {.exit_code = 1, .err = {"w.json: "}});
  }
  const std::string run = "./isoline run --out out --optimizer adam --problem ";
  shell.expect(run + "rosenbrock --rates r.json --dry-run", {.exit_code = 1, .err = {"r.json"}});
  for (const std::string name : {"pipe.bz2", "torn.bz2"})
    shell.expect(run + "'bal[file=" + name + "]'", {.exit_code = 1, .err = {name}});
}

TEST(ReportOfARun, OfOneMethodThatCannotTreatAllProblemsHasAReport) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'heat,sine[xi=20]' --optimizer nlopt-neldermead --work 40 "
      "--out out",
      {.out = {"1 inapplicable"}});
  EXPECT_TRUE(fs::exists(shell.folder() / "out" / "report" / "report.json"));
}

// A plan in parts, in the folder `out`.
class Shards : public testing::Test {
 protected:
  Json plan(const std::string& arguments) const {
    return parse_json(
        shell.expect("./isoline run --dry-run " + kTwelveCells + arguments + " --json").out, "it");
  }
  Finished run(const std::string& arguments, const Expected& expected = {}) const {
    return shell.expect("./isoline run " + kTwelveCells + arguments, expected);
  }
  Shell shell;
};

TEST_F(Shards, APlanSaysWhatADryRunSays) {
  const std::string dry = run("--out out --dry-run").out;
  const std::string planned = shell("./isoline run --dry-run " + kTwelveCells + "--out out").out;
  EXPECT_TRUE(contains(planned, ", 24 to run")) << planned;
  EXPECT_EQ(dry.substr(0, dry.find(" to run")), planned.substr(0, planned.find(" to run")));
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
  shell.expect("./isoline run --dry-run " + kTwelveCells + "--shards 3 --out out",
               {.out = {"shard       2/3", "out/predicted.json, written earlier"}});
}

TEST_F(Shards, ArePredictedByWhatEarlierRunsTook) {
  run("--out before --no-report --quiet");
  shell.expect("./isoline run --dry-run " + kTwelveCells + "--shards 2 --out out --from before",
               {.out = {"24 from earlier runs", " 0 from nominal costs"}});
  shell.expect("./isoline run --dry-run " + kTwelveCells + "--from nowhere",
               {.exit_code = 1, .err = {"nowhere is not"}});
}

// The promise of it all. Measured prices stand in the sheets, which no comparison reads.
TEST_F(Shards, TogetherAreTheWholeBitForBit) {
  plan("--shards 3 --out out");
  run("--out whole --no-report --quiet");
  for (const char* shard : {"--shard 1/3", "--shard 2/3"})
    run(std::string("--out out --quiet ") + shard);
  shell.expect(
      "SLURM_ARRAY_TASK_ID=6 SLURM_ARRAY_TASK_MIN=4 SLURM_ARRAY_TASK_COUNT=3 ./isoline run " +
      kTwelveCells + "--out out --quiet --shard auto");
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

TEST(Versions, OfOneSuiteAreNeitherRankedTogetherNorMergedNorKeptInOneFolder) {
  const Shell shell;
  const auto write = [&](int version) {
    write_text(shell.folder() / "mine.json",
               fmt::format(R"({{"schema": "isoline.suite/1", "name": "mine", "version": {},
                               "matrix": [{{"problems": ["square"], "optimizers": ["gd"]}}]}})",
                           version));
  };
  write(1);
  shell.expect("./isoline run mine.json --out one --quiet");
  write(2);
  shell.expect("./isoline run mine.json --out two --quiet");
  EXPECT_EQ(read_json(shell.folder() / "two/plan.json").at("suites"), Json({"mine@2"}));
  for (const char* command : {"report one two", "merge one two --out both",
                              "report one two --view choice", "run mine.json --out one --force"})
    shell.expect(std::string("./isoline ") + command,
                 {.exit_code = 1, .err = {"mine@1 and mine@2"}});
}

TEST_F(Shards, ThatAreMissingAreMissedByTheUnion) {
  run("--out out --shard 1/3 --quiet");
  EXPECT_FALSE(fs::exists(shell.folder() / "out/shards/1-of-3/report"));
  shell.expect("./isoline merge out/shards/* --out merged");
  EXPECT_EQ(read_json(shell.folder() / "merged/plan.json").at("cells").size(), 24U)
      << "a part never passes for the whole";
  run("--out out --shard 1/3", {.out = {" 0 new, "}});
}

// A new division of the plan reuses completed cells.
TEST_F(Shards, TakeOverWhatOtherDivisionsHaveDone) {
  for (const char* shard : {"1/3", "2/3", "3/3"})
    run(std::string("--out out --quiet --shard ") + shard);
  EXPECT_EQ(plan("--shards 2 --out out").at("cached"), 24);
  for (const char* shard : {"1/2", "2/2"})
    run(std::string("--out out --shard ") + shard, {.out = {" 0 new, 12 reused"}});
  shell.expect("./isoline merge out/shards/* --out merged");
  EXPECT_EQ(count_records(shell.folder() / "merged"), 24U);
  run("--out out --shard 1/2 --force", {.out = {" 12 new, 0 reused"}});
}

TEST_F(Shards, OfAPlanThatIsNotThePredictedOneAreRefused) {
  plan("--shards 3 --out out");
  shell.expect("./isoline run --problem sine --optimizer gd --out out --shard 1/3",
               {.exit_code = 1, .err = {"another plan"}});
}

// --- status

class Status : public Shards {};

TEST_F(Status, CountsPlannedDoneFailedAndLeft) {
  plan("--shards 3 --out out");
  shell.expect("./isoline run out --dry-run", {.out = {"24 cells: 0 done", "cannot be predicted"}});
  run("--out out --shard 2/3 --quiet");
  const std::size_t done = count_records(shell.folder() / "out/shards/2-of-3");
  const Json json = parse_json(shell("./isoline run out --dry-run --json").out, "the status");
  EXPECT_EQ(json.at("done"), done);
  EXPECT_EQ(json.at("left"), 24 - done);
  EXPECT_EQ(json.at("planned"), 24);
  EXPECT_TRUE(json.at("left_seconds").is_null()) << "no earlier run predicts it";
  EXPECT_GT(json.at("remaining_seconds").get<double>(), 0);
  EXPECT_EQ(json.at("end").get<std::string>().size(), std::string("2026-01-31T12:00:00Z").size());
  for (const auto& entry : fs::directory_iterator(shell.folder() / "out/shards/2-of-3/runs")) {
    Json record = read_json(entry.path());
    record["status"] = "crashed";
    write_text(entry.path(), record.dump() + "\n");
    break;
  }
  shell.expect("./isoline run out --dry-run", {.exit_code = 2, .out = {"1 of them failed"}});
}

TEST_F(Status, OfARunWithoutShardsGoesByItsPlan) {
  run("--out out --no-report --quiet");
  const Finished text =
      shell.expect("./isoline run out --dry-run", {.out = {"24 done", " 0 left\n"}});
  EXPECT_EQ(count_lines(text.out), 1U) << text.out;
  shell.expect("mkdir empty; ./isoline run empty --dry-run", {.exit_code = 1});
}

// Two cells that would take minutes, looked at while they run, then stopped.
TEST_F(Status, SeesWhatIsRunning) {
  const std::string matrix =
      "--problem 'poisson[N=32]' --optimizer 'gd[rate=1e-9]' --seeds 2 --iterations 100000000 --target 0 ";
  shell.expect("./isoline run " + matrix +
                   "--out out --jobs 2 --quiet --no-report & run=$!; told=; tries=0\n"
                   "while [ $tries -lt 600 ]; do tries=$((tries + 1)); sleep 0.1\n"
                   "  told=$(./isoline run out --dry-run 2>/dev/null)\n"
                   "  case $told in *' 2 running'*) break ;; esac\n"
                   "done\n"
                   "kill -TERM $run; wait $run; echo \"$? $told\"; ./isoline run out --dry-run",
               {.out = {"130 2 cells: 0 done", " 2 running, 0 left", " 0 running, 2 left"}});
}

// Exports, imported curves, packed folders, reports by other measures, best losses.

// The two commands of docs/exchanging-results.md.
const std::string kPack =
    "(cd results && find . -type f ! -name SHA256SUMS ! -path './checkpoints/*' | sort | xargs sha256sum "
    "> SHA256SUMS) && tar --exclude=checkpoints -czf results.tar.gz results";

class Exchange : public testing::Test {
 protected:
  void SetUp() override {
    shell.expect(
        "./isoline run --problem square,rosenbrock --optimizer gd,gauss-newton --seeds 2 "
        "--iterations 50 --quiet --no-report --out results");
  }
  Shell shell;
};

TEST_F(Exchange, APackedFolderIsTheSameFolderElsewhere) {
  shell.expect(kPack);
  shell("mkdir there && tar -xzf results.tar.gz -C there");
  shell.expect("cd there/results && sha256sum --quiet -c SHA256SUMS");
  shell.expect("./isoline validate there/results");
  shell.expect("./isoline compare results there/results");
}

// `sha256sum -c` ignores the comment.
TEST_F(Exchange, ADoiInTheManifestStandsInTheReport) {
  shell.expect(kPack + " && sed -i '1i # doi: 10.5281/zenodo.1234567' results/SHA256SUMS");
  shell.expect("cd results && sha256sum --quiet -c SHA256SUMS");
  shell.expect("./isoline validate results && ./isoline report results");
  EXPECT_TRUE(contains(read_text(shell.folder() / "results/report/index.html"),
                       "https://doi.org/10.5281/zenodo.1234567"));
}

TEST_F(Exchange, AFileThatTheManifestLacksOrThatIsMissingIsNamed) {
  shell.expect(kPack);
  shell("cd results/runs && mv \"$(ls | head -n 1)\" 0123456789abcdef-0123456789abcdef.json");
  shell.expect("./isoline validate results",
               {.exit_code = 2,
                .out = {"0123456789abcdef-0123456789abcdef.json is not in SHA256SUMS",
                        "is missing, but SHA256SUMS"}});
}

TEST_F(Exchange, ARecordUnderTheNameOfAnotherCellIsNamed) {
  shell.expect(
      "./isoline run --problem rosenbrock --optimizer gd --seeds 2 --iterations 5 --quiet "
      "--no-report --out copied && ./isoline validate copied");
  shell("cd copied/runs && cp $(ls)");
  shell.expect("./isoline validate copied", {.exit_code = 2, .out = {"has another name"}});
}

TEST_F(Exchange, ANoiseLevelUnlikeThatOfItsInstanceIsNamed) {
  shell.expect(
      "./isoline run --problem 'exponential[n=4,noise=0.01]' --optimizer gd,gauss-newton,kfac "
      "--iterations 5 --quiet --no-report --out noisy");
  shell.expect("./isoline validate noisy");
  shell(
      "sed -i -E 's/\"noise_level\": ?[0-9.e-]+/\"noise_level\": 9/' "
      "\"$(grep -l noise_level noisy/runs/*.json | head -n 1)\"");
  shell.expect("./isoline validate noisy", {.exit_code = 2, .out = {"its noise level is"}});
}

TEST_F(Exchange, AnArchiveIsNoResultFolder) {
  shell("tar -czf results.tar.gz results");
  shell.expect("./isoline report results.tar.gz", {.exit_code = 1, .err = {"tar -xf"}});
}

TEST_F(Exchange, AnImportedCurveStandsInTheTablesAndIsNeverVerified) {
  shell("printf 'f,nfev\\n24.2,1\\n1,2\\n1e-12,3\\n' > c.csv");
  shell(
      "echo '{\"schema\": \"isoline.import/1\", \"problem\": \"rosenbrock\", \"optimizer\": \"theirs\", "
      "\"seed\": 0, \"source\": \"a paper\", \"date\": \"2026-01-31\", \"columns\": {\"loss\": \"f\", "
      "\"forward\": \"nfev\"}}' > c.json");
  shell.expect("python3 " ISOLINE_SOURCE_DIR "/clients/python/import_curve.py c.csv --out results",
               {.out = {"imported, not verified"}});
  shell.expect("./isoline report results", {.out = {"theirs §", "§: imported"}});
  for (const auto& [file, mark] : {std::pair{"report.md", "§"}, {"index.html", "&#167;"}})
    EXPECT_TRUE(contains(read_text(shell.folder() / "results/report" / file), mark)) << file;
  shell.expect("./isoline validate results");
  shell("./isoline export results --out curves.csv");
  EXPECT_TRUE(contains(read_text(shell.folder() / "curves.csv"), ",true,,,,"));
  shell.expect("./isoline baseline results --out base.json");
  EXPECT_FALSE(contains(read_text(shell.folder() / "base.json"), "theirs"));
  shell.expect("./isoline merge results --out merged");
}

TEST_F(Exchange, TwoExportsOfOneFolderAreTheSameText) {
  const std::string command = "./isoline export results --out ";
  shell.expect(command + "deep/a && " + command + "b && cmp deep/a b");
}

// --- `isoline report` at other tolerances and by other measures

class Report : public Exchange {
 protected:
  Json yardstick() const {
    return read_json(shell.folder() / "results" / "report" / "report.json")["yardstick"];
  }
};

TEST_F(Report, ByAnyMeasureAtAnyToleranceTellsWhichInItsJson) {
  for (const std::string by : {"work", "cost", "iterations", "time"}) {
    shell.expect("./isoline report results --tolerance 1e-4 --by " + by);
    EXPECT_EQ(yardstick()["by"], by);
    EXPECT_EQ(yardstick()["tolerances"][2]["name"], "1e-4");
  }
  shell.expect("./isoline validate results/report/report.json");
}

TEST_F(Report, KeepsTheProblemsThatAreNamed) {
  shell.expect("./isoline report results --out one --problem square");
  const std::string table = read_text(shell.folder() / "one" / "report.csv");
  EXPECT_TRUE(contains(table, "square,gd") && !contains(table, "rosenbrock,")) << table;
  shell.expect("./isoline report results --problem sine", {.exit_code = 1});
}

TEST_F(Report, AToleranceBetweenTwoIsTheNextStricterOneAndSaysSo) {
  shell.expect("./isoline report results --tolerance 5e-5",
               {.err = {"4e-5, the next stricter one"}});
  EXPECT_EQ(yardstick()["tolerances"][2]["name"], "4e-5");
  const Finished exact = shell.expect("./isoline report results --tolerance 1e-5");
  EXPECT_FALSE(contains(exact.err, "stricter")) << exact.err;
}

TEST(ValidateVerb, AcceptsEveryFileOfTheTreeThatResultsAreReadFrom) {
  const Shell shell;
  shell.expect("./isoline validate " ISOLINE_SOURCE_DIR "/benchmarks");
}

// --- the x that runs found

TEST(SolutionVerb, PrintsValuesAndDeviationsOfTheRunOfLeastLoss) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'nist[dataset=Misra1a],rosenbrock' --optimizer "
      "gd,levenberg-marquardt --rates none --iterations 200 --quiet --no-report --out out");
  shell.expect("./isoline solution out",
               {.out = {"nist × ", "rosenbrock", "b1", "x2", "returned", "standard deviation",
                        "./isoline run --problem "}});
  shell.expect("./isoline solution out --problem nist --format json --out x.json");
  const Json found = read_json(shell.folder() / "x.json").at(0);
  EXPECT_EQ(found.at("unknowns"), (Json{"b1", "b2"}));
  // Certified values and standard deviations of NIST's Misra1a.
  constexpr Real kB1 = 2.3894212918e2, kB2 = 5.5015643181e-4, kSd1 = 2.7070075241;
  EXPECT_NEAR(found.at("returned")[0].get<Real>(), kB1, 1e-6 * kB1);
  EXPECT_NEAR(found.at("returned")[1].get<Real>(), kB2, 1e-6 * kB2);
  EXPECT_NEAR(found.at("standard_deviation")[0].get<Real>(), kSd1, 1e-5 * kSd1);
  EXPECT_TRUE(contains(found.at("optimizer").get<std::string>(), "levenberg-marquardt"));
  // The command repeats the run, bit for bit.
  shell.expect(found.at("command").get<std::string>() + " --quiet --no-report --out again");
  shell.expect("./isoline solution again --format json --out again.json");
  EXPECT_EQ(read_json(shell.folder() / "again.json").at(0).at("returned"), found.at("returned"));
  const std::string csv = shell.expect("./isoline solution out --format csv --optimizer gd").out;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 5) << csv;  // the header, and two unknowns of each
  EXPECT_FALSE(contains(csv, "levenberg")) << csv;
  shell.expect(
      "./isoline run --problem 'rosenbrock[bounds=active]' --optimizer nlopt-lbfgs --rates none "
      "--iterations 200 --quiet --no-report --out bounded");
  shell.expect("./isoline solution bounded", {.out = {"active bound", "upper"}});
  shell.expect(
      "./isoline run --problem 'rosenbrock[fail=0.05]' --optimizer nlopt-neldermead "
      "--iterations 200 --quiet --no-report --out failing");
  shell.expect("./isoline solution failing",
               {.exit_code = 2, .out = {"unconfirmed", "evaluations failed"}});
  shell.expect("./isoline solution out --problem heat", {.exit_code = 1, .err = {"heat"}});
}

// The regression is nearly linear: its profiles are close to the intervals by t.
TEST(SolutionVerb, ProfilesEachUnknown) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'nist[dataset=Misra1a,start=2]' --optimizer levenberg-marquardt "
      "--seeds =0 --quiet --no-report --out out");
  const std::string profile = "./isoline solution out --profile --format json --out ";
  shell.expect(profile + "x.json", {.err = {"2 unknowns", "b2"}});
  const Json found = read_json(shell.folder() / "x.json").at(0);
  ASSERT_EQ(found.at("profile").size(), 2U);
  constexpr Real kT = 2.1788;  // for 12 degrees of freedom
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& one = found.at("profile")[i];
    const Real x = found.at("returned")[i], deviation = found.at("standard_deviation")[i];
    EXPECT_NEAR((x - one.at("low").get<Real>()) / deviation, kT, 0.1) << i;
    EXPECT_NEAR((one.at("high").get<Real>() - x) / deviation, kT, 0.1) << i;
    EXPECT_TRUE(one.at("messages").empty());
  }
  // With one unknown, its profile is P itself.
  shell.expect(
      "./isoline run --problem 'nist[dataset=Misra1a,start=2,fixed=\"b1=240\"]' --optimizer "
      "levenberg-marquardt --seeds =0 --quiet --no-report --out one");
  shell.expect("./isoline solution one --profile --format json --out one.json");
  const Json one = read_json(shell.folder() / "one.json").at(0), b2 = one.at("profile").at(0);
  EXPECT_EQ(b2.at("unknown"), "b2");
  const Real s = one.at("standard_deviation")[1];
  EXPECT_NEAR((b2.at("high").get<Real>() - b2.at("low").get<Real>()) / s, 2 * 2.1604, 0.1);
  shell.expect(profile + "again.json");
  EXPECT_EQ(read_json(shell.folder() / "again.json").at(0), found);
}

TEST(SolutionVerb, ReadsManyUnknownsFromTheFileThatMergeCopiesAndValidateExamines) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'poisson[N=32]' --optimizer nlopt-lbfgs --rates none "
      "--iterations 3 --quiet --no-report --out out && ./isoline merge out --out whole && ./isoline validate whole/runs");
  shell.expect("./isoline solution whole --format npy", {.exit_code = 1, .err = {"--out"}});
  shell.expect("./isoline solution whole --format npy --out x.npy");
  const NumberArray x = read_npy(shell.folder() / "x.npy");
  EXPECT_EQ(x.shape, (std::vector<Index>{1024}));
  EXPECT_NE(std::ranges::max(x.values), 0);
  shell.expect("./isoline solution whole", {.out = {"984 more unknowns"}});
  // It starts a run, which begins with the loss that this one found.
  shell.expect(
      "./isoline run --problem 'poisson[N=32]' --optimizer nlopt-lbfgs --rates none "
      "--iterations 1 --quiet --no-report --start x.npy --out more");
  const auto only_record = [&](const char* folder) {
    for (const auto& file : std::filesystem::directory_iterator(shell.folder() / folder / "runs"))
      if (file.path().extension() == ".json") return read_json(file.path());
    return Json();
  };
  EXPECT_EQ(only_record("more").at("summary").at("start_loss"),
            only_record("out").at("summary").at("best_loss"));
  shell.expect("for file in whole/runs/*.x.npy; do printf damaged > $file; done");
  shell.expect("./isoline validate whole/runs", {.exit_code = 2, .out = {".x.npy"}});
}

// One residual of two unknowns: gradients move both alike, simplices do not.
TEST(SolutionVerb, StatesThatRunsOfOneLossEndAtOtherPoints) {
  const Shell shell;
  write_text(shell.folder() / "sum.py",
             "import sys\n"
             "sys.path.insert(0, '" ISOLINE_SOURCE_DIR
             "/clients/python')\n"
             "import isoline\n"
             "isoline.problem(lambda x: [x[0] + x[1]], start=[3.0, -1.5], target=[1.0],\n"
             "                vjp=lambda x, u: [u[0], u[0]],\n"
             "                minimum=0.0, name='sum')\n");
  const std::string run =
      "./isoline run --problem 'process[command=\"python3 sum.py\"]' --rates none --iterations 300 "
      "--quiet --no-report --optimizer ";
  shell.expect(run + "'gd[rate=0.2]' --out one");
  const std::string one = shell.expect("./isoline solution one", {.out = {"x2"}}).out;
  EXPECT_FALSE(contains(one, "at another point")) << one;
  shell.expect(run + "'gd[rate=0.2],nlopt-neldermead' --out two");
  shell.expect("./isoline solution two", {.out = {"  1 run ", "at another point"}});
}

// --- the table of best losses, renewed from runs

TEST(BestVerb, KeepsTheLeastLossOfRunsThatDeclareNoneAndNoOther) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'brown-dennis[m=10],rosenbrock' --optimizer gd,levenberg-marquardt "
      "--rates none --work 500 --seeds 2 --quiet --no-report --out out");
  shell.expect("./isoline baseline out --best best.json", {.out = {"improved: 2\n"}});
  const Json table = read_json(shell.folder() / "best.json");
  ASSERT_EQ(table.at("rows").size(), 1U);
  const Json& row = table["rows"][0];
  EXPECT_EQ(row.at("problem"), "brown-dennis");
  EXPECT_EQ(row.at("options").at("m"), 10);
  ASSERT_EQ(row.at("losses").size(), 2U);
  EXPECT_EQ(row["losses"][0].at("optimizer"), "levenberg-marquardt");
  shell.expect("./isoline validate best.json");
  shell.expect("./isoline baseline out --best best.json", {.out = {"improved: 0\n"}});
  EXPECT_EQ(read_json(shell.folder() / "best.json"), table);
  // Runs that read the table have an f_L; those that do not are compared by their losses.
  const auto solved_with = [&](const std::string& given, const std::string& out) {
    shell.expect(
        "./isoline run --problem 'brown-dennis[m=10]' --optimizer gd,levenberg-marquardt --rates "
        "none --work 500 --seeds 2 --quiet --out " +
        out + given);
    for (const auto& file : std::filesystem::directory_iterator(shell.folder() / out / "runs"))
      EXPECT_EQ(read_json(file.path()).value("best_known", false), !given.empty());
    return read_json(shell.folder() / out / "report/report.json").at("ranked").size();
  };
  EXPECT_EQ(solved_with("", "plain"), 0U);
  EXPECT_EQ(solved_with(" --best best.json", "known"), 1U);
  const std::string differences = shell("./isoline compare plain known").out;
  EXPECT_NE(differences.find("the lowest known"), std::string::npos) << differences;
  EXPECT_EQ(differences.find("problem's source"), std::string::npos) << differences;
}

// A record may come from someone else.
TEST(Records, StartNoCommandUntilTheyAreTrusted) {
  const Shell shell;
  const fs::path started = shell.folder() / "started";
  write_text(shell.folder() / "mine.py",
             "import isoline\nopen('started', 'w').close()\n"
             "isoline.problem(lambda x: [x[0] - 1], [3], jacobian=lambda x: [[1]])\n");
  shell.expect(
      "./isoline run --problem 'process[command=\"python3 mine.py\"]' --optimizer gd --out out "
      "--iterations 5 --quiet --no-report");
  ASSERT_TRUE(fs::remove(started));
  shell.expect("./isoline baseline out --best best.json && ./isoline report out");
  const std::string named = "python3 mine.py";
  shell.expect("./isoline replay out/runs/*.json", {.exit_code = 1, .err = {named}});
  shell.expect("./isoline baseline out --out base.json", {.exit_code = 1, .err = {named}});
  EXPECT_FALSE(fs::exists(started));
  shell.expect("./isoline replay --trust out/runs/*.json");
  EXPECT_TRUE(fs::exists(started));
}

// The gate of this repository on runs of the built program: it fails on each planted fault, with
// one line that names the cause.

const std::string kRun = "./isoline run --problem square,brown-dennis --iterations 20 --no-report ";

// A baseline of adam, gd and newton on two problems, and the same results beside it.
class PlantedFault : public testing::Test {
 protected:
  void SetUp() override {
    shell.expect(kRun + "--optimizer adam,gd,newton --out new");
    shell.expect("./isoline baseline new --perturbations 1 --out base.json");
    shell.expect("./isoline validate base.json");
  }

  Finished gate(const Expected& expected) const {
    return shell.expect("ISOLINE=./isoline BASELINE=base.json bash " ISOLINE_SOURCE_DIR
                        "/.ci/compare new",
                        expected);
  }

  // Every record of an optimizer as a changed program would have written it.
  void change_records(const std::string& optimizer, const std::function<void(Record&)>& edit) {
    std::vector<Record> records;
    for (const auto& entry : fs::directory_iterator(runs)) {
      Record record = read_record(entry.path());
      if (record.request.optimizer.name != optimizer) continue;
      fs::remove(entry.path());
      records.push_back(std::move(record));
    }
    ASSERT_EQ(records.size(), 2U);
    for (Record& record : records) {
      edit(record);
      record.cell = cell_digest(record.request);
      write_text(runs / record.file_name(), to_json(record).dump());
    }
  }

  // It fails, and the last line on standard error is the cause.
  void expect_fault(int exit_code, const std::string& cause) {
    const Finished result = gate({.exit_code = exit_code});
    const std::size_t last = result.err.rfind('\n', result.err.size() - 2);
    const std::string line = result.err.substr(last == std::string::npos ? 0 : last + 1);
    EXPECT_TRUE(contains(line, cause)) << result.err;
    EXPECT_EQ(read_text(shell.folder() / "new/comparison.md"), result.out);
  }

  Shell shell;
  fs::path runs = shell.folder() / "new" / "runs";
};

TEST_F(PlantedFault, NoneLetsTheSameResultsPass) { gate({.out = {"Comparison: equal"}}); }

TEST_F(PlantedFault, InADefaultFailsTheGate) {
  change_records("adam", [](Record& record) {
    record.request.optimizer.options.set("epsilon", 1e-2);  // from 1e-8
    end_at(record, 1.5 * record.summary.loss);
    record.build_parts["optimizer"] = "0123456789abcdef";
    record.build = "fedcba9876543210";
  });
  expect_fault(kWorse, "epsilon 1e-8 → 0.01 (2 cells); 2 cells of adam ");
  gate({.exit_code = kWorse, .out = {"source (2 cells of adam "}});
}

TEST_F(PlantedFault, InAFormulaFailsTheGate) {
  change_records("gd", [](Record& record) { end_at(record, record.summary.loss * (1 + 1e-5)); });
  expect_fault(kWorse, "worse: 2 cells of gd");
}

TEST_F(PlantedFault, AMissingOptimizerFailsTheGate) {
  fs::remove_all(shell.folder() / "new");
  ASSERT_EQ(shell(kRun + "--optimizer adam,gd --out new").exit_code, 0);
  expect_fault(kWorse, "NEW lacks 2 cells of newton");
  write_text(shell.folder() / "allowed.json",
             R"({"schema": "isoline.allowed/1",
                 "cells": [{"optimizer": "newton", "reason": "it moved out"}]})");
  shell.expect("./isoline compare base.json new --tolerance 1e-6 --allow allowed.json");
}

TEST_F(PlantedFault, ACellThatAClockCutFailsTheGate) {
  change_records("newton", [](Record& record) { record.is_nondeterministic = true; });
  expect_fault(kNotComparable, "ended the run in NEW");
}

TEST_F(PlantedFault, BetterResultsPass) {
  change_records("gd", [](Record& record) { end_at(record, record.summary.loss * 0.5); });
  gate({.out = {"Comparison: better, "}});
}

TEST_F(PlantedFault, InARecordIsFoundByValidate) {
  const fs::path file = fs::directory_iterator(runs)->path();
  Record record = read_record(file);
  end_at(record, 2 * record.summary.loss);
  write_text(runs / "copy.json", to_json(record).dump());
  shell.expect("./isoline validate new", {.exit_code = 2, .out = {"differs at", "/curve/loss/"}});
  fs::remove(runs / "copy.json");
  shell.expect("./isoline validate new");
  record.request.seed = 77;
  write_text(file, to_json(record).dump());
  shell.expect("./isoline validate new", {.exit_code = 2, .out = {"its cell is "}});
}

}  // namespace
}  // namespace isoline::benchmarks
