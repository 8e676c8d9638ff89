// The examples in the help of each verb are commands that the program reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "benchmarks/cli/verb.h"
#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

// Words as a shell has them, as far as the examples go: single quotes, and no others. What follows
// two blanks or more tells what the command is for.
std::vector<std::string> example_words(const std::string& line) {
  static const std::regex word("(?:'[^']*'|[^ '])+");
  const std::string command = line.substr(0, std::min(line.find("  "), line.find(" > ")));
  std::vector<std::string> words;
  for (std::sregex_iterator it(command.begin(), command.end(), word), end; it != end; ++it)
    std::erase(words.emplace_back(it->str()), '\'');
  return words;
}

std::vector<std::string> examples_in(const std::string& help) {
  std::vector<std::string> examples;
  std::istringstream text(help);
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("  isoline ")) examples.push_back(line.substr(2));
  return examples;
}

void expect_read(const std::string& example) {
  std::vector<std::string> words = example_words(example);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  try {
    parse_only("isoline", static_cast<int>(arguments.size()), arguments.data());
  } catch (const UsageError& error) {
    ADD_FAILURE() << example << ": " << error.what();
  }
}

TEST(Examples, InTheHelpOfEveryVerbAreRead) {
  const std::vector<Verb> verbs = all_verbs();
  EXPECT_GT(verbs.size(), 15U);
  for (const Verb& verb : verbs) {
    const std::vector<std::string> examples = examples_in(verb.examples);
    EXPECT_FALSE(examples.empty()) << verb.name;
    for (const std::string& example : examples) expect_read(example);
  }
  for (const std::string& example : examples_in(program_examples())) expect_read(example);
}

}  // namespace
}  // namespace isoline::benchmarks
