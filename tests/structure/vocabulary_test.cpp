// Texts for readers use the words that CONTRIBUTING.md lists ("English"): none of the phrases below
// occurs in the pages or in the folders that are named here. Tests do not quote those texts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
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
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root() / "docs"))
    if (entry.is_regular_file()) all.push_back(std::filesystem::relative(entry.path(), root()));
  return all;
}

// Folders whose sources are held to kArchaic.
constexpr const char* kFolders[] = {
    "cmake",           "clients",          "core",         "networks",
    "problems",        "optimizers",       "benchmarks",   "reports/compare",
    "reports/formats", "reports/sections", "reports/words"};

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
  static const std::regex quoted("`[^`]*(`|$)|\"[^\"]*(\"|$)");
  return lower(std::regex_replace(line, quoted, ""));
}

// The string literals and the comment of a line of C or C++.
std::string strings_and_comment(const std::string& line) {
  static const std::regex part(R"re("((?:[^"\\]|\\.)*)"|(//.*))re");
  std::string text;
  for (std::sregex_iterator it(line.begin(), line.end(), part), end; it != end; ++it)
    text += (*it)[1].str() + ' ' + (*it)[2].str();
  return text;
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
  static const std::regex relative(" *// (What|Who|Of) [^?]*");
  return std::regex_match(line, relative);
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
    for (const std::string& line : lines_of(read_text(root() / page))) {
      if (line.starts_with("```")) is_code = !is_code;
      if (is_code) continue;
      const std::string text = prose(line);
      EXPECT_EQ(avoidable(text, kArchaic), "") << page << ": " << line;
      EXPECT_EQ(avoidable(text, kReplaced), "") << page << ": " << line;
    }
  }
}

TEST(Vocabulary, OfLauncherAndScriptsIsPlain) {
  for (const char* file : {"isoline", "CMakeLists.txt", "CMakePresets.json", ".ci/run",
                           ".ci/compare", ".github/workflows/ci.yml", "CITATION.cff"}) {
    const std::vector<std::string> lines = lines_of(read_text(root() / file));
    EXPECT_FALSE(lines.empty()) << file;
    for (const std::string& line : lines)
      EXPECT_EQ(avoidable(lower(line), kArchaic), "") << file << ": " << line;
  }
}

TEST(Vocabulary, TheGlossaryHasAtMostTwentyFiveTerms) {
  const std::vector<std::string> lines = lines_of(read_text(root() / "docs/glossary.md"));
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
      for (const std::string& line : lines_of(read_text(entry.path()))) {
        if (extension == ".py" && line.find("None") != std::string::npos) continue;  // "is None"
        const std::string text = is_code ? prose(strings_and_comment(line)) : lower(line);
        EXPECT_EQ(avoidable(text, kArchaic), "") << entry.path() << ": " << line;
        EXPECT_FALSE(is_code && begins_with_a_relative(line))
            << entry.path() << ": begin with a noun: " << line;
      }
    }
}

// --- tests, which quote at most four successive words of a text of the product

// Separated by bars; a literal at the end of a line goes on in the next.
std::string literals_of(const std::filesystem::path& file) {
  static const std::regex literal(R"re("((?:[^"\\]|\\.)*)"|'((?:[^'\\]|\\.)*)'|//.*)re");
  std::string text;
  if (file.extension() == ".txt") return read_text(file);  // reports/words
  for (const std::string& line : lines_of(read_text(file)))
    for (std::sregex_iterator it(line.begin(), line.end(), literal), end; it != end; ++it)
      text += (*it)[1].str() + (*it)[2].str() + (it->suffix().length() == 0 ? " " : " | ");
  return text;
}

// All five successive words. Numbers and placeholders do not separate them; options and code do.
std::set<std::string> phrases_of(const std::string& text) {
  static const std::regex word(R"re([.,:;()'`]*([a-z]+(?:['-][a-z]+)*)[.,:;()'`?!]*)re"),
      number(R"re([\d.,:×%]+|\{\S*)re");
  std::vector<std::string> last;
  std::set<std::string> phrases;
  std::istringstream tokens(lower(text));
  std::smatch match;
  for (std::string token; tokens >> token;) {
    if (std::regex_match(token, number)) continue;
    const bool is_word = std::regex_match(token, match, word);
    last.push_back(is_word ? match[1].str() : "");
    if (!is_word) last.clear();
    if (last.size() < 5) continue;
    std::string phrase;
    for (const std::string& each : last) phrase += each + ' ';
    phrases.insert(phrase);
    last.erase(last.begin());
  }
  return phrases;
}

std::set<std::string> phrases_below(const char* folder) {
  std::set<std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root() / folder))
    if (std::set<std::string>{".cpp", ".h", ".py", ".txt"}.contains(entry.path().extension()))
      all.merge(phrases_of(literals_of(entry.path())));
  return all;
}

TEST(Quotations, OfTextsInTestsHaveAtMostFourWords) {
  EXPECT_EQ(phrases_of("{}: one of 3 is at `least`.").count("one of is at least "), 1U);
  const std::set<std::string> tests = phrases_below("tests");
  for (const char* folder :
       {"core", "networks", "problems", "optimizers", "benchmarks", "reports", "clients"})
    for (const std::string& phrase : phrases_below(folder))
      EXPECT_FALSE(tests.contains(phrase)) << folder << " has the words: " << phrase;
}

}  // namespace
}  // namespace isoline
