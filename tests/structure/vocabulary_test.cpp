// Texts for readers use the words that CONTRIBUTING.md lists ("English"): none of the phrases below
// occurs in the pages or in the folders that are named here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "tests/structure/sources.h"

namespace isoline {
namespace {

struct Phrase {
  std::string_view avoid, write;
};

// In pages and in source files.
constexpr Phrase kArchaic[] = {
    {"who", "a noun: a user, a method"},
    {"whoever", "anyone, every user"},
    {"nobody", "no user, no method"},
    {"anew", "again"},
    {"is told", "is reported"},
    {"are told", "are reported"},
    {"is none", "does not exist, is not"},
    {"of no", "without"},
    {"was given", "was run on, received"},
    {"were given", "were run on, received"},
    {"so much holds", "a plain statement"},
};

// In pages only: parts of the code still have these names.
constexpr Phrase kReplaced[] = {
    {"door", "adapter"},
    {"doors", "adapters"},
    {"room", "module"},
    {"rooms", "modules"},
    {"yardstick", "metric"},
    {"told", "reported"},
    {"tells", "prints, reports"},
    {"settled", "statistically significant"},
    {"not settled", "not significant"},
    {"told from", "differs significantly from"},
    {"stands first", "ranks first"},
    {"standings", "ranking"},
    {"× least", "median slowdown"},
    {"asks for", "requires"},
    {"privilege", "extra information"},
    {"privileges", "extra information"},
    {"privileged", "with extra information"},
    {"declared work", "nominal cost"},
    {"declared price", "nominal cost"},
    {"declared prices", "nominal costs"},
    {"measured price", "measured cost"},
    {"measured prices", "measured costs"},
    {"sheet", "component metadata"},
    {"sheets", "component metadata"},
    {"sought", "unknown"},
    {"kinks", "nondifferentiable points"},
    {"chamber", "verifier"},
    {"exhibit", "snapshots"},
    {"drawn", "sampled, plotted"},
};

std::vector<std::filesystem::path> pages() {
  std::vector<std::filesystem::path> all = {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"};
  for (const auto& entry : std::filesystem::directory_iterator(root() / "docs"))
    all.push_back(std::filesystem::relative(entry.path(), root()));
  return all;
}

// Folders whose sources are held to kArchaic.
constexpr const char* kFolders[] = {"cmake",
                                    "clients",
                                    "networks",
                                    "problems",
                                    "optimizers",
                                    "core",
                                    "benchmarks/plan",
                                    "benchmarks/run",
                                    "reports/compare",
                                    "reports/formats",
                                    "reports/read",
                                    "reports/sections",
                                    "benchmarks/shard",
                                    "benchmarks/merge",
                                    "benchmarks/audit",
                                    "benchmarks/cli",
                                    "benchmarks/verbs",
                                    "benchmarks/schemas",
                                    "benchmarks/suites",
                                    "benchmarks/micro"};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char letter) { return std::tolower(letter); });
  return text;
}

bool is_letter(const std::string& text, std::size_t at) {
  return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 ||
                              text[at] == '_' || text[at] == '-');
}

bool has_phrase(const std::string& text, std::string_view phrase) {
  for (std::size_t at = text.find(phrase); at != std::string::npos; at = text.find(phrase, at + 1))
    if ((at == 0 || !is_letter(text, at - 1)) && !is_letter(text, at + phrase.size())) return true;
  return false;
}

// Without code and quotations, which name a word and do not use it.
std::string prose(const std::string& line) {
  std::string rest;
  char quote = 0;
  for (const char letter : line) {
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '`' || letter == '"') {
      quote = letter;
    } else {
      rest += letter;
    }
  }
  return lower(rest);
}

// The comment and the string literals of a line of C or C++.
std::string comment_and_strings(const std::string& line) {
  std::string rest;
  bool is_string = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!is_string && line.compare(i, 2, "//") == 0) return rest + ' ' + line.substr(i);
    if (line[i] == '"' && (i == 0 || line[i - 1] != '\\')) {
      is_string = !is_string;
      rest += ' ';
    } else if (is_string) {
      rest += line[i];
    }
  }
  return rest;
}

template <std::size_t N>
std::string avoidable(const std::string& text, const Phrase (&phrases)[N]) {
  if (text.find('?') != std::string::npos) return "";  // a question may ask who
  for (const Phrase& phrase : phrases)
    if (has_phrase(text, phrase.avoid))
      return "'" + std::string(phrase.avoid) + "': write " + std::string(phrase.write);
  return "";
}

// Whether a comment begins with a relative clause, as "What a run keeps." does.
bool begins_with_a_relative(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  if (begin == std::string::npos || line.find('?') != std::string::npos) return false;
  for (const char* word : {"// What ", "// Who ", "// Of "})
    if (line.compare(begin, std::string_view(word).size(), word) == 0) return true;
  return false;
}

TEST(Vocabulary, APhraseIsFoundAsAWordAndOutsideCode) {
  EXPECT_NE(avoidable(prose("Whoever runs it is told so."), kArchaic), "");
  EXPECT_NE(avoidable(prose("A door to FFTW."), kReplaced), "");
  EXPECT_EQ(avoidable(prose("Who wins?"), kArchaic), "");
  EXPECT_TRUE(begins_with_a_relative("  // What a run keeps."));
  EXPECT_FALSE(begins_with_a_relative("// What does a run keep?"));
  EXPECT_EQ(avoidable(prose("The whole; `--sheets`, \"doors\", outdoors, in-door."), kReplaced),
            "");
}

TEST(Vocabulary, OfPagesIsPlain) {
  for (const std::filesystem::path& page : pages()) {
    bool is_code = false;
    int number = 0;
    for (const std::string& line : lines_of(file_text(root() / page))) {
      ++number;
      if (line.starts_with("```")) is_code = !is_code;
      if (is_code) continue;
      const std::string text = prose(line);
      EXPECT_EQ(avoidable(text, kArchaic), "") << page << ":" << number << ": " << line;
      EXPECT_EQ(avoidable(text, kReplaced), "") << page << ":" << number << ": " << line;
    }
  }
}

TEST(Vocabulary, OfLauncherAndScriptsIsPlain) {
  for (const char* file : {"isoline", "CMakeLists.txt", "CMakePresets.json", ".ci/run",
                           ".ci/compare", ".github/workflows/ci.yml", "CITATION.cff"}) {
    const std::vector<std::string> lines = lines_of(file_text(root() / file));
    EXPECT_FALSE(lines.empty()) << file;
    for (const std::string& line : lines)
      EXPECT_EQ(avoidable(lower(line), kArchaic), "") << file << ": " << line;
  }
}

TEST(Vocabulary, TheGlossaryHasAtMostTwentyFiveTerms) {
  const std::vector<std::string> lines = lines_of(file_text(root() / "docs/glossary.md"));
  const auto rows =
      std::ranges::count_if(lines, [](const std::string& line) { return line.starts_with("| "); });
  EXPECT_GT(rows, 10);
  EXPECT_LE(rows - 1, 25) << "without the header";
}

TEST(Vocabulary, OfSourcesIsPlain) {
  constexpr std::string_view kCode[] = {".h", ".cpp", ".c"};
  constexpr std::string_view kText[] = {".json", ".js", ".css", ".cmake", ".txt", ".html", ".py"};
  for (const char* folder : kFolders)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root() / folder)) {
      const std::string extension = entry.path().extension();
      const bool is_code = std::ranges::find(kCode, extension) != std::end(kCode);
      if (!is_code && std::ranges::find(kText, extension) == std::end(kText)) continue;
      int number = 0;
      for (const std::string& line : lines_of(file_text(entry.path()))) {
        ++number;
        if (extension == ".py" && line.find("None") != std::string::npos) continue;  // "is None"
        const std::string text = is_code ? prose(comment_and_strings(line)) : lower(line);
        EXPECT_EQ(avoidable(text, kArchaic), "") << entry.path() << ":" << number << ": " << line;
        EXPECT_FALSE(is_code && begins_with_a_relative(line))
            << entry.path() << ":" << number << ": begin with a noun: " << line;
      }
    }
}

}  // namespace
}  // namespace isoline
