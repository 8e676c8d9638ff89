// What the README tells a reader to do works: its commands run, its two examples compile and run.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "problems/conformance.h"
#include "tests/benchmarks/matrix.h"
#include "tests/cli/readme_examples.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {

using problems::examine;
using problems::Finding;
using problems::Problem;
namespace {

std::string readme() { return read_text(std::filesystem::path(ISOLINE_SOURCE_DIR) / "README.md"); }

// The lines of every block that is fenced as `language`.
std::vector<std::string> fenced_lines(const std::string& language) {
  std::vector<std::string> lines;
  bool is_inside = false;
  std::istringstream text(readme());
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```"))
      is_inside = line == "```" + language;
    else if (is_inside && !line.empty() && !line.starts_with('#'))
      lines.push_back(line);
  }
  return lines;
}

// These two need the whole machine; continuous integration runs them from a clean clone.
const std::vector<std::string> kMainCommands = {"./isoline run", "./isoline test"};

std::vector<std::string> commands() {
  std::vector<std::string> all = fenced_lines("sh");
  for (const std::string& line : fenced_lines("bash")) all.push_back(line);
  return all;
}

TEST(Readme, ShowsTheTwoCommands) {
  const std::vector<std::string> all = commands();
  for (const std::string& command : kMainCommands)
    EXPECT_NE(std::ranges::find(all, command), all.end()) << command;
}

TEST(Readme, EveryOtherCommandRunsInTheOrderOfThePage) {
  const Shell shell;
  std::size_t count = 0;
  for (const std::string& command : commands()) {
    if (std::ranges::find(kMainCommands, command) != kMainCommands.end()) continue;
    const Finished result = shell(command);
    EXPECT_EQ(result.exit_code, 0) << command << "\n" << result.err;
    EXPECT_NE(result.out, "") << command;
    ++count;
  }
  EXPECT_GE(count, 5U);
}

// --- its worked examples, cut from the page when the build is configured

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
  EXPECT_EQ(row.records.size(), catalog.optimizers.size());
  EXPECT_GE(column.records.size(), catalog.problems.size() - 2);
  EXPECT_EQ(row.outcome.failures, std::vector<std::string>{});
  EXPECT_EQ(column.outcome.failures, std::vector<std::string>{});
  const auto is_solved = [](const Record& r) { return r.verified.at("1e-6") == true; };
  EXPECT_GE(std::ranges::count_if(row.records, is_solved), 12) << "of the methods, on the example";
  EXPECT_GE(std::ranges::count_if(column.records, is_solved), 4) << "problems, by the example";
}

TEST(Readme, LinksToFilesOfTheTreeThatExist) {
  const std::string text = readme();
  for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
    const std::string target = text.substr(at + 2, text.find_first_of(")#", at) - at - 2);
    if (target.empty() || target.find("://") != std::string::npos) continue;
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(ISOLINE_SOURCE_DIR) / target))
        << target;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
