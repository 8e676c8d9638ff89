// Results in and out as a user meets them: exports, imported curves, packed folders, reports by
// other measures, best losses.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

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

TEST_F(Exchange, AFileThatTheManifestLacksOrThatIsMissingIsNamed) {
  shell.expect(kPack);
  shell("cd results/runs && mv \"$(ls | head -n 1)\" 0123456789abcdef-0123456789abcdef.json");
  shell.expect("./isoline validate results",
               {.exit_code = 2,
                .out = {"0123456789abcdef-0123456789abcdef.json is not in SHA256SUMS",
                        "is missing, and SHA256SUMS lists it"}});
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
  for (const std::string file : {"report.md", "index.html"})
    EXPECT_TRUE(contains(read_text(shell.folder() / "results/report" / file), "§")) << file;
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

TEST_F(Report, AToleranceBetweenTwoIsTheNextStricterOneAndSaysSo) {
  shell.expect("./isoline report results --tolerance 5e-5",
               {.err = {"4e-5, the next stricter one"}});
  EXPECT_EQ(yardstick()["tolerances"][2]["name"], "4e-5");
  const Finished exact = shell.expect("./isoline report results --tolerance 1e-5");
  EXPECT_FALSE(contains(exact.err, "stricter")) << exact.err;
}

// --- the table of best losses, renewed from runs

TEST(BestVerb, KeepsTheLeastLossOfRunsThatDeclareNoneAndNoOther) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem 'brown-dennis[m=10],rosenbrock' --optimizer gd,levenberg-marquardt "
      "--rates none --work 500 --seeds 2 --quiet --no-report --out out");
  shell.expect("./isoline best out --out best.json");
  const Json table = read_json(shell.folder() / "best.json");
  ASSERT_EQ(table.at("rows").size(), 1U);
  const Json& row = table["rows"][0];
  EXPECT_EQ(row.at("problem"), "brown-dennis");
  EXPECT_EQ(row.at("options").at("m"), 10);
  ASSERT_EQ(row.at("losses").size(), 2U);
  EXPECT_EQ(row["losses"][0].at("optimizer"), "levenberg-marquardt");
  shell.expect("./isoline validate best.json");
  shell.expect("./isoline best out --out best.json", {.out = {"improved: 0\n"}});
  EXPECT_EQ(read_json(shell.folder() / "best.json"), table);
}

}  // namespace
}  // namespace isoline::benchmarks
