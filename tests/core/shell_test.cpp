// A command that a record keeps means the same when it is typed again.
#include "core/shell.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "core/errors.h"

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

TEST(Shell, WordsComeBackFromACommandMadeOfThem) {
  const std::vector<std::string> words = {"it's", "a b", "$HOME", "\\", "\"", "", "two\nlines"};
  EXPECT_EQ(shell_words(shell_command(words)), words);
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
}

}  // namespace
}  // namespace isoline
