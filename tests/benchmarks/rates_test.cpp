// The rates of the tree: what they promise of themselves.
#include "benchmarks/plan/rates.h"

#include <algorithm>
#include <map>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/tune.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/json_view.h"
#include "core/spec.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {

using optimizers::OptimizerEntry;
using problems::Batch;
namespace {

// What a value within another says of modes is no mode of the problem.
TEST(Rates, AreForTheDefaultModeWhateverNestedOptionsSay) {
  const Rates rates = Rates::from_json(
      {{"rows",
        {{{"problem", "sine"}, {"optimizer", "gd"}, {"options", {{"rate", 0.5}}}},
         {{"problem", "sine[mode=learn]"}, {"optimizer", "gd"}, {"options", {{"rate", 0.25}}}}}}},
      "here");
  const auto rate = [&](const std::string& spec) {
    const Rates::Row* row = rates.find(complete_problem(catalog(), parse_spec(spec)), "gd");
    return row ? row->options.number("rate", 0) : 0;
  };
  EXPECT_EQ(rate("sine"), 0.5);
  EXPECT_EQ(rate("sine[xi=3]"), 0.5);
  EXPECT_EQ(rate("sine[mode=learn]"), 0.25);
  EXPECT_EQ(rate("sine[network=mine[mode=odd]]"), 0.5);  // of a network that direct never makes
}

void expect_row_is_sound(const Json& row) {
  const std::string text =
      row.at("problem").get<std::string>() + " × " + row.at("optimizer").get<std::string>();
  const Spec problem = parse_spec(row.at("problem").get<std::string>());
  EXPECT_NO_THROW(complete_problem(catalog(), problem)) << text;
  EXPECT_NO_THROW(
      complete_optimizer(catalog(), row.at("optimizer"), option_values_from(row.at("options"))))
      << text;
  const Json& source = row.at("source");
  EXPECT_TRUE(source.contains("paper") || source.contains("grid")) << text;
  if (!source.contains("grid")) return;
  for (const auto& [option, values] : source.at("grid").items()) {
    EXPECT_GE(values.size(), 5U) << text;
    EXPECT_EQ(source.at(source.contains("families") ? "mean_score" : "score").size(), values.size())
        << text;
    if (!row.at("options").contains(option)) continue;  // it is the rate of a nested optimizer
    EXPECT_NE(std::ranges::find(values, row.at("options").at(option)), values.end()) << text;
  }
}

TEST(Rates, OfTheTreeNameWhatExistsWithinItsRangesAndSaysWhereEachValueIsFrom) {
  for (const auto& [name, text] : builtin_rates()) {
    const Json table = parse_json(std::string(text), name);
    EXPECT_EQ(schema_violations(table, schema("rates")), std::vector<std::string>{}) << name;
    if (table.contains("grid")) {
      EXPECT_EQ(table.at("grid").at("seeds"), "100..102");  // apart from those that judge
    }
    for (const Json& row : table.at("rows")) expect_row_is_sound(row);
  }
}

// Equal tuning: every method that has something to tune was, on every problem that it can treat.
TEST(Rates, CoverEveryTunableMethodOnEveryProblemOfQuick) {
  std::set<std::string> seen;
  for (const Request& cell : cells_of("quick")) {
    const OptimizerEntry& entry = catalog().optimizers.at(cell.optimizer.name);
    const std::string text = cell.problem.spec + " × " + entry.name;
    const bool is_published = cell.problem.spec.find("mode=learn") != std::string::npos;
    if (entry.tunable.option.empty() || is_published || !seen.insert(text).second) continue;
    const Problem problem = make_problem(catalog(), cell.problem, 0);
    if (!why_inapplicable(entry, cell.optimizer.options, problem).empty()) continue;
    EXPECT_TRUE(cell.rates == "direct.json" || cell.rates == "physics.json") << text;
  }
  EXPECT_GT(seen.size(), 400U);
}

TEST(Rates, OfQuickWereEachChosenFromSevenValuesOfTheMethodsOwnOptionAndAFewBeyondAnEdge) {
  const Json table = parse_json(std::string(builtin_rates().at("direct")), "direct");
  EXPECT_EQ(table["grid"]["points"], kGridValues);
  for (const Json& row : table["rows"]) {
    const std::string text =
        row["problem"].get<std::string>() + " × " + row["optimizer"].get<std::string>();
    const Component problem =
        complete_problem(catalog(), parse_spec(row["problem"].get<std::string>()));
    const auto knob = knob_of(catalog(), row["optimizer"], problem, {});
    ASSERT_TRUE(knob.has_value()) << text;
    ASSERT_TRUE(row["source"]["grid"].contains(knob->option)) << text;
    const std::size_t values = row["source"]["grid"][knob->option].size();
    EXPECT_GE(values, std::size_t{kGridValues}) << text;
    EXPECT_LE(values, std::size_t{kGridValues + 2 * kMostExtensions}) << text;
    EXPECT_EQ(row["source"]["best_of"].size(), values) << text;
  }
}

// One grid for all problems, and no look at the family itself.
TEST(Rates, OfPhysicsAreChosenOnTheOtherFamiliesFromOneGridPerMethod) {
  std::map<std::string, Json> grids;
  for (const char* name : {"physics", "physics-tuned"}) {
    const Json table = parse_json(std::string(builtin_rates().at(name)), name);
    for (const Json& row : table["rows"]) {
      const std::string problem = row["problem"], optimizer = row["optimizer"];
      const Json& source = row["source"];
      const Json& grid = grids.try_emplace(optimizer, source["grid"]).first->second;
      EXPECT_EQ(source["grid"], grid) << problem << " × " << optimizer;
      EXPECT_EQ(grid.begin()->size(), std::size_t{kGridValues}) << optimizer;
      EXPECT_EQ(source.contains("families"), name == std::string("physics"));
      const Json families = source.value("families", Json::array());
      EXPECT_EQ(std::ranges::count(families, Json(problem)), 0) << optimizer;
    }
  }
  EXPECT_GT(grids.size(), 30U);
}

TEST(Rates, GiveWayToExplicitOptions) {
  const Suite suite{.name = "mine",
                    .title = "",
                    .blocks = {{.problems = {"beale"}, .optimizers = {"gd", "gd[lr=0.5]"}}}};
  const std::vector<Request> cells = expand(catalog(), suite, Rates::builtin());
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_NE(cells[0].optimizer.options.at("rate"), OptionValue(0.5));
  EXPECT_EQ(cells[1].optimizer.options.at("rate"), OptionValue(0.5));
}

// --- The best losses known: who has them, who may lower them, and what follows for a run.

Component problem(const std::string& text) { return complete_problem(catalog(), parse_spec(text)); }

Record record_of(const std::string& text, std::uint64_t seed, Real loss) {
  Record record;
  record.request.problem = problem(text);
  record.request.optimizer.spec = "adam";
  record.request.seed = seed;
  record.status = Status::budget;
  record.summary.best_loss = loss;
  return record;
}

TEST(Best, KeepsTheLesserOfTwoBySeedAndBySetOfOptions) {
  BestLosses best;
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=10]", 0, 5)));
  EXPECT_FALSE(best.add(record_of("brown-dennis[m=10]", 0, 6)));
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=10]", 0, 4)));
  EXPECT_TRUE(best.add(record_of("brown-dennis[m=11]", 0, 9)));
  EXPECT_FALSE(best.add(record_of("brown-dennis[m=10]", 1, std::nan(""))));
  EXPECT_EQ(best.find(problem("brown-dennis[m=10]"), 0), 4);
  EXPECT_EQ(best.find(problem("brown-dennis[m=11]"), 0), 9);
  EXPECT_FALSE(best.find(problem("brown-dennis[m=10]"), 1).has_value());
  const BestLosses read = BestLosses::from_json(best.to_json(), "here");
  EXPECT_EQ(read.to_json(), best.to_json());
  EXPECT_EQ(read.find(problem("brown-dennis[m=11]"), 0), 9);
  EXPECT_THROW(BestLosses::from_json({{"schema", "isoline.best/1"}}, "here"), UsageError);
  EXPECT_THROW(BestLosses::from_json({{"schema", "isoline.rates/1"}, {"rows", Json::array()}}, "x"),
               UsageError);
}

// The learned problems of `quick`: no network attains 0.
TEST(Best, AreFLOfTheProblemsThatDeclareNone) {
  for (const char* text : {"sine[mode=learn,xi=32]", "exponential[mode=learn]"})
    for (const std::uint64_t seed : {0U, 1U, 2U}) {
      const std::optional<Real> known = BestLosses::builtin().find(problem(text), seed);
      ASSERT_TRUE(known.has_value()) << text << ", seed " << seed;
      EXPECT_GT(*known, 0);
      EXPECT_EQ(make_problem(catalog(), problem(text), seed).minimum(), known);
      EXPECT_FALSE(declares_minimum(catalog(), problem(text), seed));
    }
  EXPECT_EQ(make_problem(catalog(), problem("rosenbrock"), 0).minimum(), 0);
  EXPECT_FALSE(make_problem(catalog(), problem("brown-dennis[m=10]"), 0).minimum().has_value());
}

TEST(Best, GiveRunsWithoutADeclaredMinimumHitsThatAreExact) {
  const Request request =
      cell_of("exponential[mode=learn]", "sip", {.iterations = 200, .target = 0});
  const Record record = executed(catalog(), request);
  ASSERT_TRUE(record.hits.has_value());
  EXPECT_EQ(record.minimum, BestLosses::builtin().find(request.problem, 0));
  Batch validation;
  make_problem(catalog(), request.problem, 0).draw_validation(validation);
  const Real silent = 0.5 * validation.target.squaredNorm() / 1024;  // L at y = 0
  EXPECT_NEAR(*record.scale, std::min(silent, record.summary.start_loss - *record.minimum), 1e-15);
}

TEST(Best, ArePartOfTheDigestOfTheirProblem) {
  const Component learned = problem("exponential[mode=learn]");
  EXPECT_NE(BestLosses::builtin().losses_text(learned), "");
  EXPECT_NE(learned.sources, problem("exponential").sources);
  EXPECT_EQ(problem("exponential").sources, tree_sources().at("problems/exponential.cpp"));
}

}  // namespace
}  // namespace isoline::benchmarks
