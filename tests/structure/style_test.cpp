// The rules of style that can be measured, over every source file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <regex>
#include <set>

#include "tests/structure/code.h"

namespace isoline {
namespace {

// At 250 lines the question is whether a file holds two ideas; these hold one, and why. 400 is the
// wall.
const std::map<std::string, std::string> kLongFiles = {};

TEST(Style, FilesOverTheQuestionOf250LinesHaveAnAnswerAndNoneIsOver400) {
  for (const Source& source : sources()) {
    EXPECT_LE(source.lines.size(), 400U) << source.path;
    if (source.lines.size() > 250) {
      EXPECT_TRUE(kLongFiles.contains(source.path))
          << source.path << " has " << source.lines.size()
          << " lines: does it hold two ideas? If one, name it in kLongFiles with the reason";
    } else {
      EXPECT_FALSE(kLongFiles.contains(source.path)) << source.path << " needs no answer any more";
    }
  }
  for (const auto& [path, reason] : kLongFiles)
    EXPECT_TRUE(std::filesystem::exists(root() / path)) << path;
}

// Two files that are open at once are told apart by their names.
TEST(Style, NoTwoFilesOfAKindShareTheirName) {
  std::map<std::string, std::string> seen;
  for (const Source& source : sources()) {
    if (source.is_test()) continue;
    const std::string name = source.path.substr(source.path.rfind('/') + 1);
    const auto [at, is_new] = seen.emplace(name, source.path);
    EXPECT_TRUE(is_new) << source.path << " and " << at->second;
  }
}

TEST(Style, LineOneSaysWhatTheFileIs) {
  constexpr std::size_t kWords = 10;  // "// " and at least a few words
  for (const Source& source : sources()) {
    EXPECT_TRUE(source.lines.at(0).starts_with("// ")) << source.path;
    EXPECT_GE(source.lines.at(0).size(), kWords) << source.path;
  }
}

// UTF-8: neither the rest of a character nor, as in x̃, a mark above one (U+0300 to U+036F).
bool takes_a_column(unsigned char byte) {
  return (byte & 0xC0U) != 0x80U && byte != 0xCCU && byte != 0xCDU;
}

// Texts are written whole, however long: what stands between quotes is not counted.
TEST(Style, LinesHaveAtMost100ColumnsAndNoTabs) {
  static const std::regex quoted(R"re("([^"\\]|\\.)*")re");
  for (const Source& source : sources())
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      const std::string& line = source.lines[i];
      const std::string code = std::regex_replace(line, quoted, "");
      const auto columns = std::count_if(code.begin(), code.end(), takes_a_column);
      EXPECT_LE(columns, 100) << source.path << ":" << i + 1;
      EXPECT_EQ(line.find('\t'), std::string::npos) << source.path << ":" << i + 1;
    }
}

TEST(Style, HeadersSayPragmaOnceAndNoFileDefinesAMacro) {
  static const std::regex macro(R"(^\s*#\s*(define|undef)\b)");
  for (const Source& source : sources()) {
    const bool is_guarded = source.text.find("\n#pragma once\n") != std::string::npos;
    EXPECT_EQ(is_guarded, source.is_header()) << source.path;
    for (const std::string& line : source.lines)
      EXPECT_FALSE(std::regex_search(line, macro)) << source.path << ": " << line;
  }
}

// Words of an identifier: "LossHandler" and "loss_handler" both contain "handler".
std::vector<std::string> words_of(const std::string& identifier) {
  std::vector<std::string> words(1);
  for (const char c : identifier) {
    if (c == '_' || c == '.' || c == '/' || c == '-' || std::isupper(c) || std::isdigit(c))
      words.emplace_back();
    if (std::isalpha(c)) words.back() += static_cast<char>(std::tolower(c));
  }
  return words;
}

bool is_banned(const std::string& word) {
  static const std::set<std::string> banned = {"manager", "helper",  "util",  "base",
                                               "impl",    "handler", "utils", "handlers",
                                               "helpers", "managers"};
  return banned.contains(word);
}

// Names that others gave: members of libraries and of the operating system.
bool is_given(const std::string& identifier) {
  static const std::set<std::string> given = {"sa_handler", "set_new_handler", "error_handler_t"};
  return given.contains(identifier);
}

TEST(Style, NoNameHasABannedWord) {
  static const std::regex identifier("[A-Za-z_][A-Za-z0-9_]*");
  for (const Source& source : sources()) {
    for (const std::string& word : words_of(source.path))
      EXPECT_FALSE(is_banned(word)) << source.path;
    const std::string code = code_of(source.text);
    for (std::sregex_iterator it(code.begin(), code.end(), identifier), end; it != end; ++it) {
      if (is_given(it->str())) continue;
      for (const std::string& word : words_of(it->str()))
        EXPECT_FALSE(is_banned(word)) << source.path << ": " << it->str();
    }
  }
}

// Lines of each function, found by clang-format's indentation: a body opens at the end of a line
// and closes at a brace of the same depth.
TEST(Style, FunctionsHaveAtMost45Lines) {
  static const std::regex opening(
      R"re(^( {0,4})[A-Za-z~].*\)( const)?( override| final| noexcept)*( -> [^{]*)? \{$)re");
  static const std::regex other(
      R"re(^\s*(namespace|class|struct|enum|union|for|if|while|switch)\b)re");
  std::size_t count = 0;
  for (const Source& source : sources())
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      std::smatch match;
      if (!std::regex_match(source.lines[i], match, opening)) continue;
      if (std::regex_search(source.lines[i], other)) continue;
      const std::string closing = match[1].str() + "}";
      std::size_t end = i + 1;
      while (end < source.lines.size() && !source.lines[end].starts_with(closing)) ++end;
      EXPECT_LE(end - i + 1, 45U) << source.path << ":" << i + 1;
      ++count;
    }
  EXPECT_GT(count, 500U) << "the functions were not found";
}

// --- statements

// What follows the labels and conditions that a statement begins with.
std::string without_conditions(std::string text) {
  static const std::regex label(
      R"re(^(else|do)\b ?|^(case [^:]*|default|public|private|protected): ?)re");
  static const std::regex condition(R"re(^(if constexpr|if|for|while|switch) ?\()re");
  for (std::smatch match; true;) {
    if (std::regex_search(text, match, label)) {
      text = text.substr(std::size_t(match.length()));
    } else if (std::regex_search(text, match, condition)) {
      std::size_t at = text.find('('), depth = 0;
      for (; at < text.size(); ++at) {
        depth += text[at] == '(';
        if (text[at] == ')' && --depth == 0) break;
      }
      if (at == text.size()) return text;
      text = text.substr(text.find_first_not_of(' ', at + 1) == std::string::npos
                             ? text.size()
                             : text.find_first_not_of(' ', at + 1));
    } else {
      return text;
    }
  }
}

std::string without_template_arguments(std::string text) {
  static const std::regex arguments(R"re((\w)<[^<>;=()]*>)re");
  for (std::string before; before != text;) {
    before = text;
    text = std::regex_replace(text, arguments, "$1");
  }
  return text;
}

// What stands before the first comma outside of brackets; nothing where there is none.
std::string before_comma(const std::string& text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    depth += text[i] == '(' || text[i] == '[';
    depth -= text[i] == ')' || text[i] == ']';
    if (text[i] == ',' && depth == 0) return text.substr(0, i);
  }
  return "";
}

// "a = 1, b = 2", "f(), g()" and "return a, b" are; a declaration has a blank between type and
// name, and Eigen's "v << a, b" is its way to fill an array.
bool is_comma_statement(const std::string& statement) {
  static const std::regex assignment(R"re(^[\w.:>\-\[\]*()+]+ ?([-+*/%|&^]|<<|>>)?=[^=].*)re");
  static const std::regex call(R"re(^[\w.:>\-]+\(.*\)$)re");
  static const std::regex count(R"re(^(\+\+|--).*|^\S+(\+\+|--)$)re");
  const std::string first = before_comma(without_template_arguments(without_conditions(statement)));
  if (std::regex_match(first, call)) return first.find(") << ") == std::string::npos;
  return std::regex_match(first, assignment) || std::regex_match(first, count) ||
         first.starts_with("return ");
}

TEST(Style, AStatementSaysOneThing) {
  for (const char* two : {"a = 1, b = 2", "if (x) a += f<int, 2>(x), ++n", "f(), g(1, 2)",
                          "return f(), true", "else ++i, ++j", "x[0] = y, z[1] = 2"})
    EXPECT_TRUE(is_comma_statement(two)) << two;
  for (const char* one : {"int a = 1, b = 2", "a = std::map<int, int>()", "v << 1, 2", "f(a, b)",
                          "v.col(0) << f(1), 2", "for (int i = 0, j = 1", "return {a, b}",
                          "using A = std::map<int, int>", "const auto [a, b] = f()"})
    EXPECT_FALSE(is_comma_statement(one)) << one;
  std::size_t statements = 0;
  for (const Source& source : sources())
    for (const Statement& statement : statements_of(code_of(source.text))) {
      ++statements;
      EXPECT_FALSE(is_comma_statement(statement.text))
          << source.path << ":" << statement.line << ": " << statement.text;
    }
  EXPECT_GT(statements, 5000U) << "the statements were not found";
}

// A view of an array that dies or changes before the view is read: write the type.
TEST(Style, AutoHoldsNoExpressionOfEigen) {
  static const std::string views =
      "array|matrix|col|row|block|segment|head|tail|transpose|cwise\\w+|colwise|rowwise|reshaped|"
      "diagonal|(left|right|middle)Cols|(top|bottom|middle)Rows|replicate|asDiagonal|noalias|"
      "unaryExpr|binaryExpr|triangularView|selfadjointView";
  static const std::string numbers =
      "eval|size|rows|cols|sum|norm|squaredNorm|dot|maxCoeff|minCoeff|mean|prod|any|all|count|"
      "allFinite|hasNaN|data|value";
  static const std::regex expression(R"re(\bauto&{0,2} \w+ = [^;\[]*\.()re" + views +
                                     R"re()(<\w+>)?\()re");
  static const std::regex number(R"re(\.()re" + numbers + R"re()(<[\w:]+>)?\([^()]*\)$)re");
  for (const Source& source : sources())
    for (const Statement& statement : statements_of(code_of(source.text))) {
      if (!std::regex_search(statement.text, expression)) continue;
      EXPECT_TRUE(std::regex_search(statement.text, number))
          << source.path << ":" << statement.line << ": " << statement.text;
    }
}

// The tracked entries at the top, or nothing where this is no clone.
std::set<std::string> top_entries() {
  const std::string command = "git -C '" + root().string() + "' ls-files 2>/dev/null";
  std::set<std::string> entries;
  FILE* files = popen(command.c_str(), "r");
  std::array<char, 4096> line{};
  while (std::fgets(line.data(), line.size(), files) != nullptr) {
    const std::string path(line.data());
    entries.insert(path.substr(0, path.find_first_of("/\n")));
  }
  pclose(files);
  return entries;
}

TEST(Style, TheTopHasTheRoomsAndTheUsualFilesAlone) {
  const std::set<std::string> known = {"core",
                                       "networks",
                                       "problems",
                                       "optimizers",
                                       "benchmarks",
                                       "reports",
                                       "clients",
                                       "docs",
                                       "tests",
                                       "cmake",
                                       ".ci",
                                       ".github",
                                       "isoline",
                                       "README.md",
                                       "LICENSE",
                                       "CHANGELOG.md",
                                       "CONTRIBUTING.md",
                                       "CMakeLists.txt",
                                       "CMakePresets.json",
                                       ".clang-format",
                                       ".clang-tidy",
                                       ".gitignore",
                                       ".gitattributes",
                                       ".editorconfig"};
  const std::set<std::string> entries = top_entries();
  if (entries.empty()) GTEST_SKIP() << "not a clone: what belongs to the tree cannot be told";
  for (const std::string& entry : entries) EXPECT_TRUE(known.contains(entry)) << entry;
  for (const char* room : {"core", "networks", "problems", "optimizers", "benchmarks", "reports"})
    EXPECT_TRUE(entries.contains(room)) << room;
}

}  // namespace
}  // namespace isoline
