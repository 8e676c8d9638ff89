// Results in and out as a user meets them: exports, imported curves, packed folders.
#include <gtest/gtest.h>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

const std::string kRun =
    "./isoline run --problem square,rosenbrock --optimizer gd,gauss-newton --seeds 2 --iterations 50 "
    "--quiet --no-report --out ";

// The two commands of docs/exchanging-results.md.
const std::string kPack =
    "(cd results && find . -type f ! -name SHA256SUMS ! -path './checkpoints/*' | sort | xargs sha256sum "
    "> SHA256SUMS) && tar --exclude=checkpoints -czf results.tar.gz results";

TEST(Exchange, APackedFolderIsTheSameFolderElsewhere) {
  const Shell shell;
  shell(kRun + "results");
  ASSERT_EQ(shell(kPack).exit_code, 0);
  shell("mkdir there && tar -xzf results.tar.gz -C there");
  EXPECT_EQ(shell("cd there/results && sha256sum --quiet -c SHA256SUMS").exit_code, 0);
  EXPECT_EQ(shell("./isoline validate there/results").exit_code, 0);
  EXPECT_EQ(shell("./isoline compare results there/results").exit_code, 0);
}

TEST(Exchange, AFileThatTheManifestLacksOrThatIsMissingIsNamed) {
  const Shell shell;
  shell(kRun + "results");
  ASSERT_EQ(shell(kPack).exit_code, 0);
  shell("cd results/runs && mv \"$(ls | head -n 1)\" 0123456789abcdef-0123456789abcdef.json");
  const Finished wrong = shell("./isoline validate results");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_TRUE(contains(wrong.out, "0123456789abcdef-0123456789abcdef.json is not in SHA256SUMS"))
      << wrong.out;
  EXPECT_TRUE(contains(wrong.out, "is missing, and SHA256SUMS lists it")) << wrong.out;
}

TEST(Exchange, AnArchiveIsNoResultFolder) {
  const Shell shell;
  shell(kRun + "results");
  shell("tar -czf results.tar.gz results");
  const Finished refused = shell("./isoline report results.tar.gz");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(contains(refused.err, "tar -xf")) << refused.err;
}

TEST(Exchange, AnImportedCurveStandsInTheTablesAndIsNeverVerified) {
  const Shell shell;
  shell(kRun + "results");
  shell("printf 'f,nfev\\n24.2,1\\n1,2\\n1e-12,3\\n' > c.csv");
  shell(
      "echo '{\"schema\": \"isoline.import/1\", \"problem\": \"rosenbrock\", \"optimizer\": \"theirs\", "
      "\"seed\": 0, \"source\": \"a paper\", \"date\": \"2026-01-31\", \"columns\": {\"loss\": \"f\", "
      "\"forward\": \"nfev\"}}' > c.json");
  const Finished imported =
      shell("python3 " ISOLINE_SOURCE_DIR "/clients/python/import_curve.py c.csv --out results");
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_TRUE(contains(imported.out, "imported, not verified")) << imported.out;
  const Finished table = shell("./isoline report results");
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_TRUE(contains(table.out, "theirs §")) << table.out;
  EXPECT_TRUE(contains(table.out, "§: imported")) << table.out;
  for (const std::string file : {"report.md", "index.html"})
    EXPECT_TRUE(contains(read_text(shell.folder() / "results/report" / file), "§")) << file;
  EXPECT_EQ(shell("./isoline validate results").exit_code, 0)
      << shell("./isoline validate results").out;
  shell("./isoline export results --out curves.csv");
  EXPECT_TRUE(contains(read_text(shell.folder() / "curves.csv"), ",true,,,,"));
  const Finished baseline = shell("./isoline baseline results --out base.json");
  EXPECT_EQ(baseline.exit_code, 0) << baseline.err;
  EXPECT_FALSE(contains(read_text(shell.folder() / "base.json"), "theirs"));
  EXPECT_EQ(shell("./isoline merge results --out merged").exit_code, 0);
}

TEST(Exchange, TwoExportsOfOneFolderAreTheSameText) {
  const Shell shell;
  shell(kRun + "results");
  const std::string command = "./isoline export results --out ";
  EXPECT_EQ(shell(command + "deep/a && " + command + "b && cmp deep/a b").exit_code, 0);
}

}  // namespace
}  // namespace isoline::benchmarks
