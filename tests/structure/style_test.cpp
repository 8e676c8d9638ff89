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
const std::map<std::string, std::string> kLongFiles = {
    {"benchmarks/audit/audit_problems.cpp", "one family of problems: links, chained in every way"},
    {"benchmarks/cli/command_line.cpp", "a library: its call and its complaints, in our words"},
    {"benchmarks/cli/verb_arguments.cpp", "one list: what each verb is given, as its help says"},
    {"core/spec.cpp", "one grammar: specifications, their sweeps, seeds and times"},
    {"problems/problem.cpp", "one chain: network, physics and loss, forward and back"},
    {"problems/conformance.cpp", "one examination: a law a function, at the same point"},
    {"optimizers/process.cpp", "one conversation: its questions, their answers, its end"},
    {"optimizers/ceres.cpp",
     "one library: its callbacks, its solve and the list of its algorithms"},
    {"optimizers/nlopt.cpp", "one library: its call, its checks and the list of its algorithms"},
    {"reports/formats/terminal.cpp", "all that a terminal shows: tables, sections, a claim"},
    {"reports/page/svg.cpp", "one drawing of every kind of plot"},
    {"tests/benchmarks/fields_test.cpp", "one promise a test, over the same small runs"},
    {"tests/benchmarks/foreign_cells_test.cpp", "one promise a test, over cells behind one door"},
    {"tests/benchmarks/merge_test.cpp", "one law of unions a test, over the same folders"},
    {"tests/cli/run_test.cpp", "one verb as a user meets it"},
    {"tests/cli/usage_test.cpp", "every mistake at a command line, in one table"},
    {"tests/networks/layer_moments_test.cpp", "one network, computed once more pixel by pixel"},
    {"tests/reports/claims_test.cpp", "one law of verdicts a test, over the same two optimizers"},
    {"tests/reports/claim_evidence_test.cpp", "one claim's evidence in every format"}};

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

// A door that leads to problems and to optimizers has the one name that users give it.
const std::set<std::string> kDoorsOfBoth = {"problems/process.cpp", "optimizers/process.cpp"};

// Two files that are open at once are told apart by their names.
TEST(Style, NoTwoFilesOfAKindShareTheirName) {
  std::map<std::string, std::string> seen;
  for (const Source& source : sources()) {
    if (source.is_test() || kDoorsOfBoth.contains(source.path)) continue;
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
  static const std::set<std::string> given = {
      "sa_handler",        "set_new_handler",         "error_handler_t",
      "set_error_handler", "set_pre_routing_handler", "HandlerResponse"};
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
                                       "CITATION.cff",
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
