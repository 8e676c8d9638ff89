// The instructions of the README and the guide: their commands run, their two examples compile and
// run. CITATION.cff names this very version, in the form that CFF 1.2.0 has.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.h"
#include "core/records/provenance.h"
#include "core/status.h"
#include "problems/conformance.h"
#include "tests/benchmarks/matrix.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {

// Generated from the examples.
Catalog catalog_with_readme_examples();
std::vector<std::string> readme_problems();  // their names
std::vector<std::string> readme_optimizers();

using problems::examine;
using problems::Finding;
using problems::Problem;
namespace {

const std::filesystem::path kTree = ISOLINE_SOURCE_DIR;

// The README and the guide, from the root of the tree.
std::vector<std::string> pages() {
  std::vector<std::string> all = {"README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(kTree / "docs"))
    if (entry.path().extension() == ".md")
      all.push_back("docs/" + entry.path().filename().string());
  std::ranges::sort(all);
  return all;
}

std::vector<std::string> lines_of_page(const std::string& page) {
  std::vector<std::string> lines;
  std::istringstream text(read_text(kTree / page));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

// The lines of every block of commands. A fence without a language holds what is only shown.
std::vector<std::string> commands(const std::string& page) {
  std::vector<std::string> all;
  bool is_inside = false;
  for (const std::string& line : lines_of_page(page)) {
    if (line.starts_with("```"))
      is_inside = line == "```sh" || line == "```bash";
    else if (is_inside && !line.empty() && !line.starts_with('#'))
      all.push_back(line);
  }
  return all;
}

// The scripts of a page, by the names in their first lines.
std::map<std::string, std::string> scripts(const std::string& page) {
  std::map<std::string, std::string> all;
  std::string* script = nullptr;
  bool begins = false;
  for (const std::string& line : lines_of_page(page)) {
    if (begins) script = line.starts_with("# ") ? &all[line.substr(2)] : nullptr;
    begins = line == "```python";
    if (begins || line == "```") script = nullptr;
    if (script != nullptr) *script += line + "\n";
  }
  return all;
}

// These two need the whole machine; continuous integration runs them from a clean clone.
const std::vector<std::string> kMainCommands = {"./isoline run", "./isoline test"};

TEST(Readme, BeginsWithTheTwoCommands) {
  std::vector<std::string> first = commands("README.md");
  first.resize(kMainCommands.size());
  EXPECT_EQ(first, kMainCommands);
}

class Page : public testing::TestWithParam<std::string> {};

// A page needs no other: its commands run in a folder of its own.
TEST_P(Page, EveryCommandRunsInTheOrderOfThePage) {
  const Shell shell;
  std::filesystem::create_directory_symlink(kTree / "clients", shell.folder() / "clients");
  for (const auto& [name, text] : scripts(GetParam())) write_text(shell.folder() / name, text);
  std::string printed;
  for (const std::string& command : commands(GetParam())) {
    if (std::ranges::find(kMainCommands, command) != kMainCommands.end()) continue;
    const std::string out = shell.expect(command).out;
    EXPECT_NE(out, "") << command;
    printed += out;
  }
  // The blocks of output have the shape of what was printed; numbers differ between processors.
  write_text(shell.folder() / "printed", printed);
  shell.expect(fmt::format("python3 {} printed --printed --shape {}",
                           (kTree / "docs/outputs.py").string(), GetParam()));
}

// The row of a name in what `score` prints: runs of 4 digits, of 6, the mean digits, the calls.
void expect_scored(const std::string& text, const std::string& name, Real least_digits) {
  const std::size_t at = text.find("\n" + name + " ");
  ASSERT_NE(at, std::string::npos) << text;
  std::istringstream row(text.substr(at + 1 + name.size()));
  std::string solved, precise;
  Real digits = 0, calls = 0;
  row >> solved >> precise >> digits >> calls;
  EXPECT_EQ(solved, "1/1") << text;
  EXPECT_EQ(precise, "1/1") << text;
  EXPECT_GE(digits, least_digits) << text;
  EXPECT_GT(calls, 5) << text;
}

// The data set of the page is Misra1a from its first start, with derivatives by differences.
TEST(Guide, ADataSetOfOnesOwnHasTheDigitsOfTheSameOneOfNist) {
  const std::string page = "docs/bring-a-simulator.md";
  const Shell shell;
  std::filesystem::create_directory_symlink(kTree / "clients", shell.folder() / "clients");
  for (const auto& [name, text] : scripts(page)) write_text(shell.folder() / name, text);
  std::string own;
  for (const std::string& command : commands(page))
    if (contains(command, "misra1a")) own = shell.expect(command).out;
  const std::string nist =
      shell
          .expect(
              "./isoline run nist --problem nist --instead ceres-lm,minpack-lmder --view digits")
          .out;
  for (const char* name : {"ceres-lm", "minpack-lmder"}) {
    expect_scored(own, name, 6);
    expect_scored(nist, name, 8);
  }
  shell.expect("./isoline run --problem more-wild --optimizer ceres-lm --view digits",
               {.exit_code = 1, .err = {"argument truth"}});
}

TEST_P(Page, LinksToFilesOfTheTreeThatExist) {
  const std::string text = read_text(kTree / GetParam());
  const std::filesystem::path folder = (kTree / GetParam()).parent_path();
  for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
    const std::string target = text.substr(at + 2, text.find_first_of(")#", at) - at - 2);
    if (target.empty() || target.find("://") != std::string::npos) continue;
    EXPECT_TRUE(std::filesystem::exists(folder / target)) << target;
  }
}

std::string name_of_page(const testing::TestParamInfo<std::string>& page) {
  std::string name = std::filesystem::path(page.param).stem();
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Guide, Page, testing::ValuesIn(pages()), name_of_page);

TEST(Readme, LinksEveryPageOfTheGuide) {
  const std::string readme = read_text(kTree / "README.md");
  std::size_t count = 0;
  for (const std::string& page : pages()) {
    count += commands(page).size();
    if (page == "README.md") continue;
    EXPECT_NE(readme.find("](" + page + ")"), std::string::npos) << page;
  }
  EXPECT_GE(count, 25U) << "the commands were not found";
}

TEST(Guide, DefinesEveryStatus) {
  std::string page;
  for (const std::string& line : lines_of_page("docs/reading-a-report.md")) page += line + "\n";
  for (const std::string_view name : kStatusNames)
    EXPECT_EQ(page.find(fmt::format("| `{}` | ", name)) != page.npos, name != "running") << name;
}

TEST(Readme, IsAScreenAndAHalf) { EXPECT_LE(lines_of_page("README.md").size(), 100U); }

// Whatever is said has one home: no line of prose stands on two pages.
TEST(Readme, NothingIsSaidTwice) {
  constexpr std::size_t kProse = 50;
  std::map<std::string, std::string> said;
  std::vector<std::string> all = pages();
  all.push_back("CONTRIBUTING.md");
  for (const std::string& page : all)
    for (const std::string& line : lines_of_page(page)) {
      if (line.size() < kProse) continue;
      const auto [at, is_new] = said.emplace(line, page);
      EXPECT_TRUE(is_new || at->second == page) << page << " and " << at->second << ": " << line;
    }
}

// --- CITATION.cff

// The members of the document itself, as far as they stand on one line: those within lists and
// folded texts are indented.
std::map<std::string, std::string> citation() {
  std::map<std::string, std::string> all;
  static const std::regex member(R"re(^([a-z-]+):(?: (.+))?$)re");
  std::smatch match;
  for (const std::string& line : lines_of_page("CITATION.cff")) {
    if (line.starts_with(' ')) continue;
    EXPECT_TRUE(std::regex_match(line, match, member)) << line;
    EXPECT_TRUE(all.emplace(match[1], match[2]).second) << line << " stands twice";
  }
  return all;
}

TEST(Citation, IsOfThisVersion) { EXPECT_EQ(citation()["version"], version()); }

// The schema of CFF 1.2.0: what it requires, and all that it allows of what we use.
TEST(Citation, HasTheMembersThatTheFormatRequires) {
  const auto all = citation();
  for (const char* required : {"authors", "cff-version", "message", "title"})
    EXPECT_TRUE(all.contains(required)) << required;
  EXPECT_EQ(all.at("cff-version"), "1.2.0");
  EXPECT_EQ(all.at("type"), "software");
  EXPECT_EQ(all.at("license"), "MIT");
  std::istringstream words(
      "abstract authors cff-version commit contact date-released doi identifiers keywords license "
      "license-url message preferred-citation references repository repository-artifact "
      "repository-code title type url version");
  const std::set<std::string> allowed{std::istream_iterator<std::string>(words), {}};
  for (const auto& [name, value] : all) EXPECT_TRUE(allowed.contains(name)) << name;
}

// --- the worked examples, cut from the pages when the build is configured

TEST(ReadmeExamples, AreOneProblemAndOneOptimizer) {
  EXPECT_EQ(readme_problems().size(), 1U);
  EXPECT_EQ(readme_optimizers().size(), 1U);
}

TEST(ReadmeExamples, TheProblemHoldsWhatEveryProblemMust) {
  const Catalog catalog = catalog_with_readme_examples();
  for (const std::string& name : readme_problems()) {
    const Problem problem =
        make_problem(catalog, complete_problem(catalog, name, OptionValues()), 0);
    RandomStream stream(0, name, "check");
    for (const Finding& finding : examine(problem, stream))
      EXPECT_TRUE(finding.holds()) << name << ": " << finding.property << " " << finding.figure;
  }
}

Suite suite_of(const std::vector<std::string>& problems,
               const std::vector<std::string>& optimizers) {
  return {.name = "readme",
          .title = "",
          .blocks = {{.problems = problems,
                      .optimizers = optimizers,
                      .except_problems = {"poisson", "heat"},
                      .except_optimizers = {},
                      .seeds = {0},
                      .budget = {.iterations = 2000, .work = 4000}}}};
}

TEST(ReadmeExamples, RunWithEverythingElseInTheCatalog) {
  const Catalog catalog = catalog_with_readme_examples();
  const FinishedMatrix row(catalog, suite_of(readme_problems(), {"*"}), {});
  const FinishedMatrix column(catalog, suite_of({"*"}, readme_optimizers()), {});
  const auto is_in_all = [](const auto& known) { return known.second.in_all; };
  EXPECT_EQ(std::ssize(row.records), std::ranges::count_if(catalog.optimizers, is_in_all));
  EXPECT_EQ(std::ssize(column.records), std::ranges::count_if(catalog.problems, is_in_all) - 2);
  EXPECT_EQ(row.outcome.failures, std::vector<std::string>{});
  EXPECT_EQ(column.outcome.failures, std::vector<std::string>{});
  const auto is_solved = [](const Record& r) { return r.verified.at("1e-6") == true; };
  EXPECT_GE(std::ranges::count_if(row.records, is_solved), 12) << "of the methods, on the example";
  EXPECT_GE(std::ranges::count_if(column.records, is_solved), 4) << "problems, by the example";
}

}  // namespace
}  // namespace isoline::benchmarks
