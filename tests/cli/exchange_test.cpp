// Results in and out as a user meets them: exports, imports, archives.
#include <gtest/gtest.h>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

const std::string kRun =
    "./isoline run --problem square,rosenbrock --optimizer gd,gauss-newton --seeds 2 --iterations 50 "
    "--quiet --no-report --out ";

TEST(Exchange, AnArchiveIsReadAsTheFolderItIsOf) {
  const Shell shell;
  shell(kRun + "results");
  ASSERT_EQ(shell("./isoline archive results --out results.tar.gz").exit_code, 0);
  ASSERT_EQ(shell("./isoline archive results --out again.tar.gz && cmp results.tar.gz again.tar.gz")
                .exit_code,
            0);
  EXPECT_EQ(shell("./isoline validate results.tar.gz").exit_code, 0);
  const Finished table = shell("./isoline report results --out a"),
                 packed = shell("./isoline report results.tar.gz");
  EXPECT_EQ(packed.exit_code, 0) << packed.err;
  EXPECT_TRUE(contains(packed.out, "report: results-report/index.html")) << packed.out;
  EXPECT_EQ(packed.out.substr(0, packed.out.find("report:")),
            table.out.substr(0, table.out.find("report:")));
  EXPECT_EQ(shell("./isoline compare results results.tar.gz").exit_code, 0);
  EXPECT_EQ(shell("./isoline compare results.tar.gz results --html page.html").exit_code, 0);
  EXPECT_EQ(shell("./isoline merge results.tar.gz --out merged").exit_code, 0);
  EXPECT_EQ(shell("diff -r results/runs merged/runs").exit_code, 0);
}

TEST(Exchange, AnArchiveIsUnpackedWhereTheUserSaysAndNothingStaysThere) {
  const Shell shell;
  shell(kRun + "results");
  ASSERT_EQ(shell("./isoline archive results --out results.tar.gz && mkdir own").exit_code, 0);
  const std::string elsewhere = "TMPDIR=$PWD/none ", here = "TMPDIR=$PWD/own ";
  const std::string read = "./isoline validate results.tar.gz";
  EXPECT_TRUE(contains(shell(elsewhere + read).err, "TMPDIR must name a folder"));  // it is asked
  EXPECT_EQ(shell(here + read).exit_code, 0);
  EXPECT_EQ(shell("ls -A own").out, "");
}

TEST(Exchange, AnArchiveIsCheckedByTheToolsOfTheSystem) {
  const Shell shell;
  shell(kRun + "results");
  ASSERT_EQ(shell("./isoline archive results --out results.tar.gz").exit_code, 0);
  const Finished listed = shell("tar --numeric-owner -tvzf results.tar.gz");
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_TRUE(listed.out.starts_with("-rw-r--r-- 0/0 ")) << listed.out;
  EXPECT_EQ(
      shell("mkdir x && tar -xzf results.tar.gz -C x && cd x && sed -n "
            "'s/.*\"name\": \"\\(.*\\)\",*/\\1/p' manifest.json | sort > ../a && find . -type f | "
            "sed 's|^./||' | grep -v '^manifest.json$' | sort > ../b && diff ../a ../b")
          .exit_code,
      0);
}

TEST(Exchange, ATamperedArchiveIsRefusedByEveryVerbThatReadsIt) {
  const Shell shell;
  shell(kRun + "results");
  shell(
      "./isoline archive results --out results.tar.gz && mkdir x && tar -xzf results.tar.gz -C x");
  ASSERT_EQ(
      shell("echo ' ' >> x/plan.json && cd x && tar -czf ../bad.tar.gz manifest.json plan.json "
            "runs components")
          .exit_code,
      0);
  for (const std::string verb :
       {"report bad.tar.gz", "merge bad.tar.gz --out merged", "validate bad.tar.gz",
        "compare bad.tar.gz results", "export bad.tar.gz --out curves.csv"}) {
    const Finished refused = shell("./isoline " + verb);
    EXPECT_EQ(refused.exit_code, 1) << verb;
    EXPECT_TRUE(contains(refused.err, "plan.json is longer than its manifest says")) << refused.err;
    EXPECT_EQ(count_lines(refused.err), 1U) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(shell.folder() / "merged"));
}

TEST(Exchange, AnArchiveWithALinkIsRefused) {
  const Shell shell;
  shell(kRun + "results");
  shell(
      "./isoline archive results --out results.tar.gz && mkdir x && tar -xzf results.tar.gz -C x");
  shell(
      "rm x/plan.json && ln -s /etc/passwd x/plan.json && cd x && tar -czf ../bad.tar.gz "
      "manifest.json plan.json runs components");
  const Finished refused = shell("./isoline report bad.tar.gz");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(contains(refused.err, "plan.json is no plain file")) << refused.err;
}

TEST(Exchange, AnImportedCurveStandsInTheTablesAndIsNeverVerified) {
  const Shell shell;
  shell(kRun + "results");
  shell("printf 'f,nfev\\n24.2,1\\n1,2\\n1e-12,3\\n' > c.csv");
  shell(
      "echo '{\"schema\": \"isoline.import/1\", \"problem\": \"rosenbrock\", \"optimizer\": \"theirs\", "
      "\"seed\": 0, \"source\": \"a paper\", \"date\": \"2026-01-31\", \"columns\": {\"loss\": \"f\", "
      "\"forward\": \"nfev\"}}' > c.json");
  const Finished imported = shell("./isoline import c.csv --out results");
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_TRUE(contains(imported.out, "imported, never verified")) << imported.out;
  const Finished table = shell("./isoline report results");
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_TRUE(contains(table.out, "theirs §")) << table.out;
  EXPECT_TRUE(contains(table.out, "§: imported from others")) << table.out;
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
  for (const std::string format : {"csv", "bencher"}) {
    const std::string command = "./isoline export results --format " + format + " --out ";
    EXPECT_EQ(shell(command + "deep/a && " + command + "b && cmp deep/a b").exit_code, 0) << format;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
