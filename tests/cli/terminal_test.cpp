// What a person at a terminal reads: summaries first, short lists, how long it took, and what to do
// after a crash.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

TEST(Terminal, ARunSaysHowLongItTook) {
  const Finished result =
      Shell()("./isoline run --problem square --optimizer newton --no-report --out out");
  EXPECT_TRUE(std::regex_search(
      result.out, std::regex(R"(^1 cell: 1 run, 0 reused \(1 [a-z]+\) in \d+\.\d s\n)")))
      << result.out;
}

TEST(Terminal, AnOptionOfSpecificationsMayBeRepeated) {
  const std::string once = "./isoline run --problem square,scaling --optimizer gd,adam --dry-run";
  const Shell shell;
  const Finished twice = shell(
      "./isoline run --problem square --problem scaling --optimizer gd --optimizer adam --dry-run");
  EXPECT_TRUE(twice.out.starts_with("4 cells")) << twice.out;
  EXPECT_EQ(twice.out, shell(once).out);
}

TEST(Terminal, ClaimsAreCountedThenListedTwentyAtMost) {
  const Shell shell;
  const std::string few = shell("./isoline claims --list").out;
  EXPECT_TRUE(std::regex_search(few, std::regex(R"(^\d+ claims in \d+ groups: )"))) << few;
  EXPECT_LE(count_lines(few), 30U) << "twenty claims, their groups and the summary";
  EXPECT_TRUE(few.ends_with("more; --all lists them\n")) << few;
  EXPECT_GT(count_lines(shell("./isoline claims --list --all").out), 100U);
}

TEST(Terminal, VerdictsOnClaimsAreCountedThenListedTwentyAtMost) {
  const Shell shell;
  shell("./isoline run --problem square --optimizer gd --no-report --quiet --out out");
  const Finished few = shell("./isoline claims --no-run --out out");
  EXPECT_TRUE(std::regex_search(few.out, std::regex(R"(^\d+ facts in \d+ claims: )"))) << few.out;
  EXPECT_LE(count_lines(few.out), 30U) << few.out;
  EXPECT_TRUE(contains(few.out, "more; --all lists them\n")) << few.out;
  EXPECT_GT(count_lines(shell("./isoline claims --no-run --all --out out").out), 200U);
}

TEST(Terminal, AnAuditSaysWhatItFoundThenTwentyLines) {
  const Shell shell;
  const Finished few = shell("./isoline audit gd adam sip newton gauss-newton ceres-lm");
  EXPECT_TRUE(few.out.starts_with("Scaling: ")) << few.out;
  EXPECT_TRUE(contains(few.out, "… and 4 more; --all lists them\n")) << few.out;
  const Finished all = shell("./isoline audit gd adam sip newton gauss-newton ceres-lm --all");
  EXPECT_FALSE(contains(all.out, "more; --all")) << all.out;
  EXPECT_GT(count_lines(all.out), count_lines(few.out));
}

TEST(Terminal, ATuningIsATableWithBarsAndJsonOnRequest) {
  const Shell shell;
  const std::string tune = "./isoline tune square --optimizer gd --work 50 --out t ";
  const Finished table = shell.expect(tune, {.out = {"█"}});
  EXPECT_TRUE(table.out.starts_with("1 pair tuned: ")) << table.out;
  const Json rows = parse_json(shell(tune + "--json").out, "rows");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("optimizer"), "gd");
}

TEST(Terminal, ATuningSaysEdgesAndTies) {
  const Shell shell;
  const std::string tune = "./isoline tune square --work 60 --tuning-seeds =100 --out t ";
  shell.expect(tune + "--optimizer gd --grid rate=1e-9..1e-7x3",
               {.out = {"1 with the best at the edge of the grid, 0 with a tie",
                        "at the edge: the highest value tried"}});
  shell.expect(tune + "--optimizer levenberg-marquardt --grid initial-damping=1e-300..1e-299x2",
               {.out = {"0 with the best at the edge of the grid, 1 with a tie", "ties with "}});
}

TEST(Terminal, CellsRunInOneProcessForADebuggerAndLeaveNoRecord) {
  const Shell shell;
  shell.expect("./isoline run --problem square --optimizer newton,gd --in-process",
               {.out = {"square × newton, seed 0: ", "no record was written"}});
  EXPECT_FALSE(std::filesystem::exists(shell.folder() / "results"));
}

TEST(Terminal, ACrashSaysHowToDebugItAndTheCommandCrashesAgain) {
  const Shell shell;
  const Finished result =
      shell.expect(OWN_BINARY " run --problem aborter --optimizer gd --out out --no-report",
                   {.exit_code = 2,
                    .err = {"crashed: signal 6", "\"message\" is the cause", "gdb --args ",
                            "ulimit -c unlimited"}});
  std::smatch found;
  ASSERT_TRUE(std::regex_search(result.err, found, std::regex(R"(record +(out/runs/\S+\.json):)")))
      << result.err;
  EXPECT_TRUE(std::filesystem::exists(shell.folder() / found[1].str())) << found[1];
  ASSERT_TRUE(std::regex_search(result.err, found, std::regex(R"(alone +(.*--in-process)\n)")))
      << result.err;
  const Finished again = shell("ulimit -c 0; " + found[1].str());
  EXPECT_NE(again.exit_code, 0);
  EXPECT_FALSE(contains(again.out, "no record was written")) << "it ended before";
}

TEST(Terminal, AComparisonBeginsWithItsVerdictAndIsShort) {
  const Shell shell;
  const std::string run = "./isoline run --problem square,sine --no-report --quiet --seeds 4 ";
  shell(run + "--optimizer @matrix-free --iterations 20 --out a");
  shell(run + "--optimizer @matrix-free --iterations 30 --out b");
  const Finished result =
      shell.expect("./isoline compare a b",
                   {.exit_code = 2, .out = {"with another budget or other threads in NEW"}});
  EXPECT_TRUE(result.out.starts_with("Comparison: worse: NEW lacks ")) << result.out;
  EXPECT_FALSE(contains(result.out, "Only in NEW")) << "the same cells are not listed twice";
  EXPECT_LE(count_lines(result.out), 30U) << result.out;
}

}  // namespace
}  // namespace isoline::benchmarks
