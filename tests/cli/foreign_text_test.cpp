// Text that others wrote reaches a user's terminal without its control sequences, and paths of any
// bytes are paths.
#include <gtest/gtest.h>

#include "core/text.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kEscape = "\x1b";

// A shell that knows no $'…' makes the bytes by printf.
TEST(ForeignText, AFolderWhoseNameIsNoUtf8IsAFolder) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd --iterations 3 --quiet "
      "--out \"$(printf 'x\\377')\"");
  EXPECT_EQ(count_records(shell.folder() / "x\xff"), 1U);
  const Finished again = shell.expect(
      "./isoline report \"$(printf 'x\\377')\" && ./isoline validate \"$(printf 'x\\377')\"");
  EXPECT_EQ(valid_utf8(again.out), again.out);
}

TEST(ForeignText, NoControlSequenceOfAFileOrAnArgumentReachesTheTerminal) {
  const Shell shell;
  write_text(shell.folder() / "schema.json", R"({"schema": "isoline.\u001b[2Jrun/1"})");
  write_text(shell.folder() / "numbers.csv", "1,2\n3,\x1b]0;owned\x07\n");
  for (const char* command :
       {"./isoline validate schema.json", "./isoline describe \"$(printf '\\033[31mred')\"",
        "./isoline run --dry-run --problem \"$(printf 'sine[\\033[2J=1]')\" --optimizer gd",
        "./isoline infer --model none.json --input numbers.csv --output out.csv",
        "./isoline report \"$(printf 'no\\033[1mfolder')\""}) {
    const Finished run = shell(command);
    EXPECT_NE(run.exit_code, 0) << command;
    EXPECT_FALSE(contains(run.out + run.err, kEscape)) << command;
    EXPECT_NE(run.out + run.err, "") << command;
  }
  EXPECT_TRUE(contains(shell("./isoline validate schema.json").out, "\\u001b[2J"));
}

TEST(ForeignText, ARecordsMessageIsShownAsTextAndKeptAsItIs) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd --iterations 3 --quiet --no-report --out r");
  const std::string change =
      "sed -i 's/\"status\":\"[a-z]*\"/\"status\":\"failed\"/;"
      "s/\"message\":\"[^\"]*\"/\"message\":\"\\\\u001b[2J\"/' r/runs/*.json && ";
  const Finished report = shell(change + "./isoline report r");
  EXPECT_FALSE(contains(report.err, kEscape)) << report.err;
  const Finished printed = shell.expect("./isoline report r");
  EXPECT_FALSE(contains(printed.out + printed.err, kEscape));
}

}  // namespace
}  // namespace isoline::benchmarks
