// The suites of the tree, and plans in shards.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>
#include <set>
#include <tuple>

#include "benchmarks/run/progress.h"
#include "benchmarks/shard/split.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/random.h"
#include "core/records/json_view.h"
#include "core/records/naming.h"
#include "core/records/request.h"
#include "core/spec.h"
#include "core/text.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
using optimizers::OptimizerEntry;

namespace {

Suite suite_of(const std::string& problems, const std::string& optimizers,
               const char* seeds = "1") {
  const MatrixBlock block{
      .problems = {problems}, .optimizers = {optimizers}, .seeds = parse_seeds(seeds)};
  return {.name = "own", .title = "", .blocks = {block}};
}

// Each kind of violation, in words of ours and at its place.
TEST(Schemas, SayInOwnWordsWhatADocumentViolates) {
  const Json form =
      Json::parse(R"({"type": "object", "required": ["name"], "additionalProperties": false,
    "properties": {"name": {"type": "string", "maxLength": 3, "pattern": "^a*$"},
                   "kind": {"enum": ["x", "y"]}, "schema": {"const": "s/1"},
                   "size": {"type": "integer", "minimum": 2, "maximum": 5},
                   "both": {"anyOf": [{"type": "number"}, {"type": "boolean"}]},
                   "list": {"type": "array", "minItems": 2, "items": {"type": "number"}}}})");
  const std::pair<const char*, const char*> cases[] = {
      {"{}", "'name' is missing"},
      {R"({"name": 1})", "of another type"},
      {R"({"name": "b"})", "[name]: it does not"},
      {R"({"name": "aaaa"})", "4 bytes; at most 3"},
      {R"({"name": "a", "other": 1})", "unknown member 'other'"},
      {R"({"name": "a", "kind": "z"})", "among the known"},
      {R"({"name": "a", "schema": "s/2"})", "another text is"},
      {R"({"name": "a", "size": 1})", "at least 2"},
      {R"({"name": "a", "size": 6})", "at most 5"},
      {R"({"name": "a", "both": "c"})", "of another form"},
      {R"({"name": "a", "list": [1]})", "too long or"},
      {R"({"name": "a", "list": [1, 2, "c"]})", "[list][2]: a value"},
      {"[]", "of another type"}};
  for (const auto& [text, part] : cases) {
    const std::vector<std::string> found = schema_violations(Json::parse(text), form);
    ASSERT_FALSE(found.empty()) << text;
    EXPECT_TRUE(std::ranges::any_of(found, [&](const std::string& one) {
      return one.find(part) != one.npos;
    })) << found[0];
    for (const std::string& one : found)
      for (const char* theirs : {"constraint", "Failed", "Expected", "property", "permitted"})
        EXPECT_EQ(one.find(theirs), one.npos) << one;
  }
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

// Optimizers are not part of the version: "*" selects new ones, too.
TEST(Suites, WhoseSettingsChangeHaveANewVersion) {
  for (const auto& [name, text] : builtin_suites()) {
    const Json suite = parse_json(std::string(text), name);
    std::set<std::string> settings;
    for (Request cell : cells_of(name)) {
      cell.optimizer = {};
      settings.insert(cell_digest(cell));
    }
    std::string all = read_suite(name).label();
    for (const std::string& setting : settings) all += "\n" + setting;
    EXPECT_EQ(suite.value("settings", ""), digest(all))
        << name << ": its settings changed; raise \"version\", then set \"settings\"";
  }
}

TEST(Suites, OfTwoVersionsAreNotCombined) {
  std::vector<std::string> suites = {"quick", "nist@3"};
  add_suite(suites, "quick@1");
  add_suite(suites, "notebook@1");
  add_suite(suites, part_of_suite("nist@3"));
  EXPECT_EQ(suites, (std::vector<std::string>{"quick@1", "nist@3", "notebook@1"}));
  EXPECT_THROW(add_suite(suites, part_of_suite("nist@2")), UsageError);
  const std::string reason = refusal([&] { add_suite(suites, "nist@4"); });
  EXPECT_NE(reason.find("nist@3 and nist@4"), reason.npos) << reason;
  EXPECT_NE(refusal([&] { add_suite(suites, "nist"); }), "") << "it is version 1";
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
  const Json defaults{{"schema", "isoline.suite/1"}, {"name", "it"}, {"rates", "none"}};
  for (const char* name : {"it", "no-such-suite"}) {
    Json other = defaults;
    other["cells_of"] = name;
    EXPECT_THROW(suite_from_json(other, "it"), UsageError) << name;
  }
  EXPECT_THROW(suite_from_json(defaults, "it"), UsageError) << "neither a matrix nor cells";
  empty["matrix"][0]["optimizers"] = {"@no-such-family"};
  EXPECT_THROW(expand(catalog(), suite_from_json(empty, "here"), {}), UsageError);
}

TEST(Suites, OfOtherOptimizersHaveTheProblemsOfTheFirst) {
  std::map<std::string, std::set<std::string>> problems;
  for (const char* name : {"contest", "contest-others", "contest-sip"})
    for (const Request& cell : cells_of(name)) {
      problems[name].insert(cell.problem.spec);
      if (name != std::string("contest")) {
        EXPECT_NE(cell.optimizer.name, "adam");
        EXPECT_EQ(cell.optimizer.name == "sip", name == std::string("contest-sip"));
      }
    }
  EXPECT_EQ(problems["contest-others"], problems["contest"]);
  EXPECT_EQ(problems["contest-sip"], problems["contest"]);
}

bool is_learned(const Request& cell) {
  return cell.problem.spec.find("mode=learn") != std::string::npos;
}

// Four methods take too long from 64 unknowns on, and those that factorize a matrix on 64 × 64.
TEST(Quick, MeetsEveryProblemWithEveryOptimizerOnThreeSeedsUnlessItLearns) {
  std::map<std::pair<std::string, std::string>, std::set<std::uint64_t>> seeds;
  const std::vector<Request> cells = cells_of("quick");
  for (const Request& cell : cells) {
    if (is_learned(cell)) continue;
    seeds[{cell.problem.name, cell.optimizer.name}].insert(cell.seed);
    EXPECT_LE(cell.budget.work, 8000) << cell.problem.spec << " × " << cell.optimizer.spec;
  }
  const std::set<std::string> slow = {"nlopt-slsqp", "nlopt-bobyqa", "nlopt-cobyla", "shampoo"},
                              large = {"poisson", "heat"};
  for (const auto& [problem, sought] : catalog().problems)
    for (const auto& [optimizer, entry] : catalog().optimizers)
      if (sought.in_all && entry.in_all && !(slow.contains(optimizer) && large.contains(problem))) {
        EXPECT_EQ((seeds[{problem, optimizer}]), (std::set<std::uint64_t>{0, 1, 2}))
            << problem << " × " << optimizer;
      }
  EXPECT_GE(cells.size(), 3000U);
}

// What a report of these records ranks: see core/results/ranking.h.
TEST(Quick, RanksSixteenSettingsOfSixFamiliesOfPhysics) {
  std::set<std::string> specs, families;
  for (const Request& cell : cells_of("quick")) {
    if (is_learned(cell) || cell.optimizer.name != "gd" ||
        catalog().problems.at(cell.problem.name).group != problems::Group::physics ||
        !specs.insert(cell.problem.spec).second)
      continue;
    int ill_posed = 0;  // seeds
    for (const std::uint64_t seed : {0, 1, 2}) {
      const Problem problem = make_problem(catalog(), cell.problem, seed);
      const auto& batch = problem.batch();
      ill_posed +=
          problem.aim() == Aim::x && 1.1 * problem.x_floor(batch) > 0.1 * problem.x_scale(batch);
    }
    if (ill_posed > 1)
      specs.erase(cell.problem.spec);
    else
      families.insert(cell.problem.name);
  }
  EXPECT_GE(specs.size(), 16U);
  EXPECT_GE(families.size(), 6U);
  EXPECT_FALSE(families.contains("heat")) << "even the best inverse is far off";
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

// Features of a suite that a problem refuses would end the whole run.
TEST(Suites, OfRealProblemsCanBeMadeWhole) {
  std::map<std::string, problems::Problem> made;
  for (const Request& cell : cells_of("real"))
    if (const std::string& spec = cell.problem.spec; !made.contains(spec))
      made.emplace(spec, make_problem(catalog(), cell.problem, cell.seed));
  EXPECT_GT(made.size(), 30U);
  for (const auto& [spec, problem] : made) {
    EXPECT_EQ(spec.find("noise=") != std::string::npos, problem.noise_level().has_value()) << spec;
    EXPECT_EQ(spec.find("bounds=active") != std::string::npos, problem.bounds() != nullptr) << spec;
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

TEST(Suites, ASelectorMayStandBesideNames) {
  const auto cells = [](const char* optimizers) {
    return expand(catalog(), suite_of("square", optimizers), Rates()).size();
  };
  EXPECT_EQ(cells("gd[rate=0.3],*"), cells("*") + 1);
  EXPECT_EQ(cells("*,gd"), cells("*"));
  EXPECT_EQ(cells("@first-order,gd[rate=0.3|0.4],@first-order"), cells("@first-order") + 2);
}

TEST(Suites, AMisspeltNameIsAnErrorWithASuggestion) {
  EXPECT_NE(refusal([] { read_suite("quik"); }).find("'quick'"), std::string::npos);
}

// The name of a cell that commit a8bb05c gave it: its record is found again.
TEST(Suites, NameACellAsEarlierVersionsDid) {
  Suite suite = suite_of("sine", "newton");
  suite.blocks[0].budget = {.iterations = 100'000, .work = 2000};
  EXPECT_EQ(expand(catalog(), suite, {}).at(0).cell, "c4d2483d8cf9f7d5");
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
  EXPECT_TRUE(too_large(size, 1000).ends_with(" 1,000: 50,000 seeds × 8 settings of sine"));
  const Suite wide = suite_of("sine[xi=1|2|3],square", "gd,newton", "2");
  EXPECT_TRUE(
      size_of(catalog(), wide).largest.starts_with("2 seeds × 4 settings of 2 problems, 3 "));
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

// A plan in shards: the same division in every process, of about equal times, by predictions that
// are written once.

namespace fs = std::filesystem;

std::vector<Request> requests_of(std::size_t count) {
  std::vector<Request> requests(count);
  for (std::size_t i = 0; i < count; ++i) requests[i].cell = digest(std::to_string(i));
  return requests;
}

// Times over four decades, as cells have them: 10^U(−2, 2) seconds.
std::vector<double> times_of(std::size_t count) {
  RandomStream random(1, "split", "test");
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(std::pow(10, 4 * random.uniform() - 2));
  return times;
}

TEST(Split, GivesShardsOfTheSamePredictedTime) {
  for (const std::size_t count : {1, 3, 16, 64}) {
    const auto weights = times_of(5000);
    const auto shards = split(requests_of(5000), weights, count);
    std::vector<double> loads(count);
    for (std::size_t i = 0; i < shards.size(); ++i) loads.at(shards[i]) += weights[i];
    const auto [least, most] = std::ranges::minmax(loads);
    EXPECT_LE(most, 1.2 * least) << count;
    EXPECT_NEAR(std::accumulate(loads.begin(), loads.end(), 0.0),
                std::accumulate(weights.begin(), weights.end(), 0.0), 1e-6);
  }
}

TEST(Split, DoesNotDependOnTheOrderOfThePlan) {
  const auto requests = requests_of(300);
  auto weights = times_of(300);
  for (std::size_t i = 0; i < 100; ++i) weights[i] = 1;  // equal ones too
  std::vector<Request> reversed(requests.rbegin(), requests.rend());
  const std::vector<double> weights_reversed(weights.rbegin(), weights.rend());
  const auto forth = split(requests, weights, 7), back = split(reversed, weights_reversed, 7);
  for (std::size_t i = 0; i < requests.size(); ++i)
    EXPECT_EQ(forth[i], back[requests.size() - 1 - i]) << i;
}

TEST(Split, GivesEveryCellToOneShardAndLeavesSomeEmptyOfFewerCells) {
  const auto requests = requests_of(100);
  const auto shards = split(requests, std::vector<double>(100, 1), 8);
  std::map<std::string, int> seen;
  for (std::size_t index = 1; index <= 8; ++index)
    for (const Request& request : part_of(requests, shards, {index, 8})) ++seen[request.cell];
  ASSERT_EQ(seen.size(), 100U);
  for (const auto& [cell, times] : seen) EXPECT_EQ(times, 1) << cell;
  const auto few = split(requests_of(2), {1, 1}, 5);
  EXPECT_NE(few[0], few[1]);
}

// --- which shard is asked for

Environment environment_of(const std::map<std::string, std::string>& variables) {
  return [variables](const char* name) {
    const auto at = variables.find(name);
    return at == variables.end() ? "" : at->second;
  };
}

TEST(Shard, IsReadAsAFractionAndAsTheTaskOfAnArray) {
  EXPECT_EQ(shard_of("3/16").text(), "3/16");
  EXPECT_EQ(shard_of("3/16").folder("out"), fs::path("out/shards/3-of-16"));
  const auto slurm = [](const char* id, const char* least, const char* count, const char* step) {
    return shard_of("auto", environment_of({{"SLURM_ARRAY_TASK_ID", id},
                                            {"SLURM_ARRAY_TASK_MIN", least},
                                            {"SLURM_ARRAY_TASK_COUNT", count},
                                            {"SLURM_ARRAY_TASK_STEP", step}}))
        .text();
  };
  EXPECT_EQ(slurm("3", "1", "16", ""), "3/16");
  EXPECT_EQ(slurm("0", "0", "4", "1"), "1/4");
  EXPECT_EQ(slurm("14", "10", "3", "2"), "3/3");
  EXPECT_THROW(slurm("13", "10", "3", "2"), UsageError);
  EXPECT_THROW(slurm("9", "1", "3", "1"), UsageError) << "an array with gaps";
  EXPECT_EQ(
      shard_of("auto", environment_of({{"ISOLINE_SHARD", "2/5"}, {"SLURM_ARRAY_TASK_ID", "1"}}))
          .text(),
      "2/5");
}

// Each with its own variables; PBS and Kubernetes do not set the number of tasks.
TEST(Shard, IsTheTaskOfAnArrayOfAnyScheduler) {
  const auto shard = [](const std::map<std::string, std::string>& variables) {
    return shard_of("auto", environment_of(variables)).text();
  };
  EXPECT_EQ(shard({{"PBS_ARRAY_INDEX", "4"}, {"ISOLINE_SHARDS", "4"}}), "4/4");
  EXPECT_EQ(shard({{"PBS_ARRAYID", "1"}, {"ISOLINE_SHARDS", "4"}}), "1/4");
  EXPECT_EQ(shard({{"LSB_JOBINDEX", "5"}, {"LSB_JOBINDEX_END", "9"}, {"LSB_JOBINDEX_STEP", "2"}}),
            "3/5");
  EXPECT_EQ(shard({{"SGE_TASK_ID", "12"},
                   {"SGE_TASK_FIRST", "10"},
                   {"SGE_TASK_LAST", "13"},
                   {"SGE_TASK_STEPSIZE", "2"}}),
            "2/2");
  EXPECT_EQ(shard({{"_CONDOR_PROCNO", "0"}, {"_CONDOR_NPROCS", "4"}}), "1/4");
  EXPECT_EQ(shard({{"JOB_COMPLETION_INDEX", "3"}, {"ISOLINE_SHARDS", "4"}}), "4/4");
  EXPECT_EQ(shard({{"LSB_JOBINDEX", "0"},
                   {"SGE_TASK_ID", "undefined"},
                   {"JOB_COMPLETION_INDEX", "0"},
                   {"ISOLINE_SHARDS", "2"}}),
            "1/2")
      << "jobs of LSF and SGE that are not arrays have these values";
}

TEST(Shard, IsNotGuessedFromTwoSchedulersOrWithoutTheNumberOfTasks) {
  const auto complaint = [](const std::map<std::string, std::string>& variables) {
    return refusal([&] { shard_of("auto", environment_of(variables)); });
  };
  const std::string two =
      complaint({{"PBS_ARRAY_INDEX", "1"}, {"SGE_TASK_ID", "2"}, {"ISOLINE_SHARDS", "4"}});
  EXPECT_NE(two.find("PBS_ARRAY_INDEX=1, SGE_TASK_ID=2"), two.npos) << two;
  const std::string uncounted = complaint({{"PBS_ARRAY_INDEX", "1"}});
  EXPECT_NE(uncounted.find("set ISOLINE_SHARDS"), uncounted.npos) << uncounted;
  EXPECT_NE(complaint({{"PBS_ARRAY_INDEX", "0"}, {"ISOLINE_SHARDS", "4"}}), "");
  EXPECT_NE(complaint({{"JOB_COMPLETION_INDEX", "4"}, {"ISOLINE_SHARDS", "4"}}), "");
  EXPECT_NE(complaint({{"SGE_TASK_ID", "1"}, {"SGE_TASK_LAST", "4"}}), "");
}

TEST(Shard, ThatDoesNotExistIsRefused) {
  for (const char* text : {"", "3", "0/4", "5/4", "a/4", "1/", "/4", "1/0", "-1/4", "1/1000000",
                           "1/4 ", "99999999999/99999999999"})
    EXPECT_THROW(shard_of(text), UsageError) << text;
  EXPECT_THROW(shard_of("auto", environment_of({})), UsageError);
  EXPECT_THROW(shard_of("auto", environment_of({{"ISOLINE_SHARD", "7/3"}})), UsageError);
}

// --- predictions

Preview preview_of(const std::vector<Request>& requests, double seconds) {
  Preview shown;
  for (const Request& request : requests)
    shown.cells.push_back({.request = &request, .seconds = seconds});
  return shown;
}

TEST(Predictions, AreWrittenOnceAndTakeThePlaceOfLaterOnes) {
  const TemporaryFolder folder;
  const auto requests = requests_of(4);
  Preview shown = preview_of(requests, 2.5);
  EXPECT_EQ(keep_predictions(folder.path(), shown), Weights::written);
  const std::string text = read_text(predicted_file(folder.path()));
  Preview later = preview_of(requests, 7);
  EXPECT_EQ(keep_predictions(folder.path(), later), Weights::kept);
  EXPECT_EQ(read_text(predicted_file(folder.path())), text);
  EXPECT_EQ(later.cells[0].seconds, 2.5);
  EXPECT_EQ(weights_of(requests, folder.path()), std::vector<double>(4, 2.5));
}

// A busy machine makes the clock of a cell run on, but not its processor's.
TEST(Predictions, AreProcessorTimesOfCellsThatComputeAlone) {
  const auto predicted = [](int threads, bool is_foreign) {
    const TemporaryFolder folder;
    Request request = cell_of("rosenbrock", "gd", {.iterations = 3});
    request.threads = threads;
    Record record = executed(catalog(), request);
    record.summary.processor_seconds = 2;
    record.summary.wall_seconds = 9;
    Json json = to_json(record);
    if (is_foreign) json["foreign"] = Json::object();
    std::filesystem::create_directories(folder.path() / "runs");
    write_text(folder.path() / "runs" / record.file_name(), json_text(json));
    std::vector<results::Unreadable> unreadable;
    return EarlierTimes(record_outlines({folder.path()}, unreadable)).of(request);
  };
  EXPECT_EQ(predicted(1, false), 2);
  EXPECT_EQ(predicted(2, false), 9);
  EXPECT_EQ(predicted(1, true), 9);
}

TEST(Predictions, OfAnotherPlanAreRefused) {
  const TemporaryFolder folder;
  const auto few = requests_of(3), more = requests_of(5);
  Preview shown = preview_of(few, 1);
  keep_predictions(folder.path(), shown);
  EXPECT_THROW(weights_of(more, folder.path()), UsageError);
  EXPECT_EQ(weights_of({few.begin(), few.begin() + 2}, folder.path()).size(), 2U);
  write_text(predicted_file(folder.path()), R"({"schema": "isoline.predicted/1", "cells": [7]})");
  EXPECT_THROW(weights_of(few, folder.path()), UsageError);
}

// Shards that were run without predictions were divided by declared work: they stay so.
TEST(Predictions, AreNotWrittenWhereShardsWereRunWithout) {
  const TemporaryFolder folder;
  fs::create_directories(Shard{1, 2}.folder(folder.path()) / "runs");
  auto requests = requests_of(2);
  requests[0].budget.iterations = 10;
  requests[1].budget.work = 7;
  Preview shown = preview_of(requests, 1);
  EXPECT_EQ(keep_predictions(folder.path(), shown), Weights::declared);
  EXPECT_FALSE(is_there(predicted_file(folder.path())));
  EXPECT_EQ(weights_of(requests, folder.path()), (std::vector<double>{30, 7}));
}

TEST(Predictions, KeepEveryBit) {
  const std::vector<PredictedCell> cells = {{digest("a"), 0.1}, {digest("b"), 1.0 / 3e5}};
  const std::string text = file_text(cells);
  const auto read = predicted_from_text(text, "it");
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(read[i].seconds, cells[i].seconds);
  EXPECT_TRUE(predicted_from_text(file_text({}), "it").empty());
}

// --- progress

std::string shown(Progress& progress) {
  testing::internal::CaptureStderr();
  progress.show(true);
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, CountsCellsAndPromisesNoTime) {
  Progress progress(Progress::Style::plain, "cells", 10, 2);
  const std::regex counts("cells \\d+/10  [^ ]+/s\n");
  for (int done = 3; done < 10; ++done) {
    progress.finished();
    const std::string text = shown(progress);
    EXPECT_TRUE(std::regex_match(text, counts)) << text;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
