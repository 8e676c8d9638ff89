// The suites of the tree: what they promise of themselves.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/spec.h"
#include "core/text.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {

using optimizers::OptimizerEntry;
namespace {

Suite suite_of(const std::string& problems, const std::string& optimizers,
               const char* seeds = "1") {
  const MatrixBlock block{
      .problems = {problems}, .optimizers = {optimizers}, .seeds = parse_seeds(seeds)};
  return {.name = "own", .title = "", .blocks = {block}};
}

TEST(Suites, OfTheTreeAreWellFormedAndPlanEachCellOnceByWorkAndIterations) {
  EXPECT_GE(builtin_suites().size(), 3U);
  for (const auto& [name, text] : builtin_suites()) {
    SCOPED_TRACE(name);
    const Json suite = parse_json(std::string(text), name);
    EXPECT_EQ(schema_violations(suite, schema("suite")), std::vector<std::string>{});
    EXPECT_EQ(suite.at("name"), name);
    EXPECT_FALSE(read_suite(name).title.empty());
    std::set<std::string> digests;
    const std::vector<Request> cells = cells_of(name);
    EXPECT_FALSE(cells.empty());
    for (const Request& cell : cells) {
      EXPECT_TRUE(digests.insert(cell_digest(cell)).second) << cell.problem.spec;
      EXPECT_TRUE(std::isinf(cell.budget.seconds)) << cell.problem.spec;
    }
  }
}

Json good_suite() {
  return {{"schema", "isoline.suite/1"},
          {"name", "mine"},
          {"matrix", {{{"problems", {"square"}}, {"optimizers", {"gd"}}}}}};
}

TEST(Suites, WithNumbersThatNoTypeHoldsUnknownKeysOrEmptySelectionsAreRefused) {
  for (const char* budget :
       {R"({"iterations": 99999999999999999999999})", R"({"iterations": 9223372036854775808})",
        R"({"work": 1e15})", R"({"work": 2000000000000000})", R"({"iterations": 0})",
        R"({"seconds": 1e300})", R"({"target": 2})"}) {
    Json suite = good_suite();
    suite["matrix"][0]["budget"] = parse_json(budget, "budget");
    EXPECT_THROW(suite_from_json(suite, "it"), UsageError) << budget;
  }
  EXPECT_NO_THROW(suite_from_json(good_suite(), "it"));
  Json threads = good_suite(), unknown = good_suite(), empty = good_suite();
  threads["matrix"][0]["threads"] = std::int64_t{1} << 40;
  EXPECT_THROW(suite_from_json(threads, "it"), UsageError);
  unknown["matrix"][0]["sedes"] = "3";
  EXPECT_THROW(suite_from_json(unknown, "here"), UsageError);
  Json crossed = good_suite();
  crossed["matrix"][0]["instances"] = "2";
  crossed["matrix"][0]["starts"] = "0..1";
  EXPECT_EQ(suite_from_json(crossed, "it").blocks[0].seeds, crossed_seeds("2", "2"));
  crossed["matrix"][0]["seeds"] = "3";
  EXPECT_THROW(suite_from_json(crossed, "it"), UsageError);
  empty["matrix"][0]["optimizers"] = {"@no-such-family"};
  EXPECT_THROW(expand(catalog(), suite_from_json(empty, "here"), {}), UsageError);
}

TEST(Quick, MeetsEveryProblemWithEveryOptimizerOnThreeSeedsFor2000UnitsOfWorkUnlessItLearns) {
  std::map<std::pair<std::string, std::string>, std::set<std::uint64_t>> seeds;
  const std::vector<Request> cells = cells_of("quick");
  for (const Request& cell : cells) {
    seeds[{cell.problem.name, cell.optimizer.name}].insert(cell.seed);
    if (cell.problem.spec.find("mode=learn") != std::string::npos) continue;
    EXPECT_LE(cell.budget.work, 2000) << cell.problem.spec << " × " << cell.optimizer.spec;
  }
  for (const auto& [problem, sought] : catalog().problems)
    for (const auto& [optimizer, entry] : catalog().optimizers)
      EXPECT_EQ((seeds[{problem, optimizer}]),
                (sought.in_all && entry.in_all ? std::set<std::uint64_t>{0, 1, 2}
                                               : std::set<std::uint64_t>()))
          << problem << " × " << optimizer;
  EXPECT_GE(cells.size(), 1500U);
}

// The order of all methods keeps its differential equations: everyone is asked 8 × 8.
TEST(Quick, GivesEveryMethodTheSmallestGridsAndEachTheLargestThatItCanTreat) {
  std::map<std::string, std::set<Index>> sides;
  for (const Request& cell : cells_of("quick"))
    if (cell.problem.name == "poisson" || cell.problem.name == "heat")
      sides[cell.problem.name + " " + cell.optimizer.name].insert(
          std::get<Index>(cell.problem.options.at("N")));
  for (const char* problem : {"poisson", "heat"})
    for (const auto& [name, entry] : catalog().optimizers.ready()) {
      if (!entry.in_all) continue;
      const std::set<Index>& asked = sides[std::string(problem) + " " + name];
      EXPECT_TRUE(asked.contains(8)) << name;
      const bool is_too_slow = name == "nlopt-slsqp";  // a fifth of the whole suite at 16 × 16
      const bool has_larger = !is_selected(entry, "@derivative-free") && !is_too_slow;
      EXPECT_EQ(asked.size(), has_larger ? 2U : 1U) << name;
      EXPECT_EQ(asked.contains(16), is_selected(entry, "@factorizing") && !is_too_slow) << name;
      EXPECT_EQ(asked.contains(64), is_selected(entry, "@matrix-free")) << name;
    }
}

TEST(Full, CrossesTenInstancesWithThreeStartsOnEachSettingOfPhysics) {
  std::map<std::string, std::set<std::uint64_t>> seeds;
  for (const Request& cell : cells_of("full")) {
    seeds[cell.problem.spec + cell.optimizer.spec].insert(cell.seed);
    EXPECT_EQ(catalog().problems.at(cell.problem.name).group, problems::Group::physics);
  }
  for (const auto& [name, own] : seeds) {
    EXPECT_EQ(own.size(), 30U) << name;
    EXPECT_TRUE(own.contains(1'009'001)) << name;
  }
}

TEST(Defaults, AreTheCellsOfQuickWithEveryMethodAtItsDefaults) {
  using Cell = std::tuple<std::string, std::string, std::uint64_t, std::int64_t, std::int64_t>;
  const auto asked = [](const std::string& suite) {
    std::multiset<Cell> cells;
    for (const Request& cell : cells_of(suite))
      cells.insert({cell.problem.spec, cell.optimizer.name, cell.seed, cell.budget.work,
                    cell.budget.iterations});
    return cells;
  };
  EXPECT_EQ(asked("defaults"), asked("quick"));
  for (const Request& cell : cells_of("defaults")) {
    EXPECT_EQ(cell.optimizer.spec, cell.optimizer.name);
    EXPECT_EQ(cell.rates, "");
  }
}

// What would take too long, or lacks an argument, joins the registries and not the suites.
TEST(Suites, PassOverWhatItsEntryKeepsOutOfAll) {
  Catalog all = builtin_catalog();
  problems::ProblemEntry slow = all.problems.at("square");
  slow.name = "slow";
  slow.in_all = false;
  all.problems.add(slow);
  OptimizerEntry odd = all.optimizers.at("gd");
  odd.name = "odd";
  odd.in_all = false;
  all.optimizers.add(odd);
  const auto names_something = [&](const std::string& problem, const std::string& optimizer) {
    return std::ranges::any_of(expand(all, suite_of(problem, optimizer), {}),
                               [](const Request& cell) {
                                 return cell.problem.name == "slow" || cell.optimizer.name == "odd";
                               });
  };
  EXPECT_FALSE(names_something("*", "*"));
  EXPECT_FALSE(names_something("*", "@first-order"));
  EXPECT_TRUE(names_something("slow", "gd"));
  EXPECT_TRUE(names_something("square", "odd"));
}

TEST(Suites, AMisspeltNameIsAnErrorWithASuggestion) {
  try {
    read_suite("quik");
    FAIL() << "no such suite";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("'quick'"), std::string::npos) << error.what();
  }
}

// The name of a cell that commit a8bb05c gave it: its record is found again.
TEST(Suites, NameACellAsEarlierVersionsDid) {
  Suite suite = suite_of("sine", "gauss-newton");
  suite.blocks[0].budget = {.iterations = 100'000, .work = 2000};
  EXPECT_EQ(expand(catalog(), suite, {}).at(0).cell, "3b96b1326330f75a");
}

// --- filters

std::set<std::string> left_by(const std::string& problems, const std::string& optimizers) {
  const Suite suite = suite_of("sine[xi=1|32],square", "gd,adam[rate=0.1],newton", "2");
  std::set<std::string> left;
  for (const Request& cell :
       filtered(catalog(), expand(catalog(), suite, {}), problems, optimizers))
    left.insert(cell.problem.spec + " x " + cell.optimizer.spec);
  return left;
}

TEST(Filters, LeaveTheCellsOfWhatIsNamed) {
  using Set = std::set<std::string>;
  EXPECT_EQ(left_by("", "").size(), 9U);
  EXPECT_EQ(left_by("square", "gd,newton"), (Set{"square x gd", "square x newton"}));
  EXPECT_EQ(left_by("sine", "newton"), (Set{"sine[xi=1] x newton", "sine[xi=32] x newton"}));
  EXPECT_EQ(left_by("sine[xi=32.0]", "adam"), (Set{"sine[xi=32] x adam[rate=0.1]"}));
  EXPECT_EQ(left_by("square", "@first-order"), (Set{"square x gd", "square x adam[rate=0.1]"}));
  EXPECT_EQ(left_by("square", "adam[lr=0.1]"), (Set{"square x adam[rate=0.1]"}));
}

TEST(Filters, ThatLeaveNothingOrNameWhatIsUnknownAreErrors) {
  EXPECT_THROW(left_by("square", "adam[rate=0.2]"), UsageError);
  EXPECT_THROW(left_by("heat", ""), UsageError);
  EXPECT_THROW(left_by("", "adm"), UsageError);
  EXPECT_THROW(left_by("sine[xii=1]", ""), UsageError);
}

// Charts colour by the one, tables stand together by the other.
TEST(Registries, SayTheKindOfEachMethodAndTheGroupOfEachProblem) {
  for (const auto& [name, entry] : catalog().optimizers.ready())
    EXPECT_NE(entry.kind, optimizers::Kind::other) << name;
  for (const auto& [name, entry] : catalog().problems.ready())
    EXPECT_NE(entry.group, problems::Group::other) << name;
}

// --- How large a plan is, is known before anything of it is made.

TEST(PlanSizes, AreWhatExpansionGives) {
  for (const auto& [problems, optimizers] : std::vector<std::pair<std::string, std::string>>{
           {"sine[xi=1|2|3],square", "gd[rate=1|2],newton"}, {"*", "@matrix-free"}}) {
    const Suite suite = suite_of(problems, optimizers, "3");
    const std::vector<Request> cells = expand(catalog(), suite, {});
    EXPECT_EQ(size_of(catalog(), suite).cells, cells.size()) << problems;
    for (const Request& cell : cells) EXPECT_EQ(cell.cell, cell_digest(cell));
  }
}

TEST(PlanSizes, SayWhatMakesThemSoLarge) {
  const Suite suite = suite_of("sine[xi=1|2|3|4,phi=1|2]", "gd", "50000");
  const PlanSize size = size_of(catalog(), suite);
  EXPECT_EQ(size.cells, 400'000U);
  EXPECT_EQ(too_large(size, 1000),
            "the plan has 400,000 cells, more than 1,000: 50,000 seeds × 8 settings of sine");
  const Suite wide = suite_of("sine[xi=1|2|3],square", "gd,newton", "2");
  EXPECT_EQ(size_of(catalog(), wide).largest,
            "2 seeds × 4 settings of 2 problems, 3 of them of sine × 2 optimizers");
}

TEST(PlanSizes, OverAMillionAreRefusedBeforeAnythingIsMade) {
  EXPECT_THROW(expand(catalog(), suite_of("*", "*", "0..999999"), {}), UsageError);
  std::string values = "1";
  for (int i = 1; i < 1000; ++i) values += "|" + std::to_string(i);
  const std::string sweep = "sine[xi=" + values + ",phi=" + values + ",gamma=" + values + "]";
  EXPECT_EQ(size_of(catalog(), suite_of(sweep, sweep, "1000000")).cells, kUncountable);
  EXPECT_THROW(expand(catalog(), suite_of(sweep, "gd", "1"), {}), UsageError);
  EXPECT_THROW(expand(catalog(), suite_of("square", "gd", "11"), {}, 10), UsageError);
}

}  // namespace
}  // namespace isoline::benchmarks
