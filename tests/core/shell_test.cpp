// A command that a record keeps means the same when it is typed again; and the processor time of a
// program that computes for this one counts as this one's.
#include "core/shell.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "core/errors.h"
#include "core/foreign/foreign.h"

namespace isoline {
namespace {

std::string shell_command(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += (command.empty() ? "" : " ") + shell_word(word);
  return command;
}

TEST(Shell, WordsAreQuotedOnlyWhereTheyMustBe) {
  EXPECT_EQ(shell_word("--out=results/a.b"), "--out=results/a.b");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  EXPECT_EQ(shell_word("sine[xi=1|3]"), "'sine[xi=1|3]'");
}

TEST(Shell, WordsOfACommandAreSplitAsAShellSplitsThem) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(shell_words("python3  mine.py\t-x\n"), (Words{"python3", "mine.py", "-x"}));
  EXPECT_EQ(shell_words(R"(a' b 'c"d \e\"f" \g '' $HOME *)"),
            (Words{"a b cd \\e\"f", "g", "", "$HOME", "*"}));
  for (const char* open : {"", "  ", "a 'b", "a \"b", "a \\"})
    EXPECT_THROW(shell_words(open), UsageError) << open;
}

// What `sh` makes of it, each word on a line of its own.
std::string read_back(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("printf '<%s>' " + command).c_str(), "r"),
                                                   pclose);
  std::string text;
  for (int letter = std::fgetc(pipe.get()); letter != EOF; letter = std::fgetc(pipe.get()))
    text += static_cast<char>(letter);
  return text;
}

TEST(Shell, ReadsEveryWordBackAsItWas) {
  const std::vector<std::string> words = {"it's", "a b", "$HOME", "`date`",    "\\", "\"",
                                          "*",    "~",   "a;b",   "#",         "",   "–ξ’",
                                          "'",    "!x",  "(a|b)", "two\nlines"};
  std::string expected;
  for (const std::string& word : words) expected += "<" + word + ">";
  EXPECT_EQ(read_back(shell_command(words)), expected);
  EXPECT_EQ(shell_words(shell_command(words)), words);
}

// Beside that of this process itself.
double counted_beside() {
  timespec own{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
  return processor_seconds() - static_cast<double>(own.tv_sec) -
         1e-9 * static_cast<double>(own.tv_nsec);
}

TEST(CountedProcess, ItsTimeIsThatOfWhomItComputesForAndStaysWhenItHasGone) {
  constexpr double kEnough = 0.05;  // seconds, much more than two clocks read in turn differ by
  const double before = counted_beside();
  double counted = 0;
  {
    const ChildProgram busy({.command = "sh -c 'while :; do :; done'"});
    for (int look = 0; look < 6000 && counted < kEnough; ++look) {
      poll(nullptr, 0, 5);
      counted = counted_beside() - before;
    }
    EXPECT_GE(counted, kEnough);
  }
  EXPECT_GE(counted_beside() - before, 0.9 * counted);
  const pid_t forked = fork();  // who counts nobody itself
  if (forked == 0) _exit(counted_beside() < 0.9 * kEnough ? 0 : 1);
  int status = 1;
  waitpid(forked, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace isoline
