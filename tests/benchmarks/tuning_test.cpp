// The rates of the tree, and tuning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/sheets.h"
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
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
using optimizers::OptimizerEntry;
using optimizers::Tunable;
using problems::Batch;

namespace {

// What a value within another says of modes is no mode of the problem.
TEST(Rates, AreForTheDefaultModeWhateverNestedOptionsSay) {
  const Rates rates = Rates::from_text(
      R"({"rows": [{"problem": "sine", "optimizer": "gd", "options": {"rate": 0.5}},
                   {"problem": "sine[mode=learn]", "optimizer": "gd", "options": {"rate": 0.25}}]})",
      "here");
  const auto rate = [&](const std::string& spec) {
    const Rates::Row* row = rates.find(complete_problem(catalog(), parse_spec(spec)), "gd");
    return row ? row->options.number("rate", 0) : 0;
  };
  EXPECT_EQ(rate("sine"), 0.5);
  EXPECT_EQ(rate("sine[xi=3]"), 0.5);
  EXPECT_EQ(rate("sine[mode=learn]"), 0.25);
  EXPECT_THROW(rate("sine[network=mine[mode=odd]]"), UsageError);  // which direct never makes
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
// Certified regressions are run at the default options.
TEST(Rates, CoverEveryTunableMethodOnEveryProblemOfQuick) {
  std::set<std::string> seen;
  for (const Request& cell : cells_of("quick")) {
    const OptimizerEntry& entry = catalog().optimizers.at(cell.optimizer.name);
    const std::string text = cell.problem.spec + " × " + entry.name;
    const bool is_published = cell.problem.spec.find("mode=learn") != std::string::npos;
    if (entry.tunable.option.empty() || is_published || cell.problem.name == "nist" ||
        !seen.insert(text).second)
      continue;
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

// --- The best losses known: which problems have them, which runs may lower them, and what follows
// for a run.

Component problem(const std::string& text) { return complete_problem(catalog(), parse_spec(text)); }

Record scored_record(const std::string& text, std::uint64_t seed, Real loss) {
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
  EXPECT_TRUE(best.add(scored_record("brown-dennis[m=10]", 0, 5)));
  EXPECT_FALSE(best.add(scored_record("brown-dennis[m=10]", 0, 6)));
  EXPECT_TRUE(best.add(scored_record("brown-dennis[m=10]", 0, 4)));
  EXPECT_TRUE(best.add(scored_record("brown-dennis[m=11]", 0, 9)));
  EXPECT_FALSE(best.add(scored_record("brown-dennis[m=10]", 1, std::nan(""))));
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
      const std::optional<Real> known = BestLosses::known().find(problem(text), seed);
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
  EXPECT_EQ(record.minimum, BestLosses::known().find(request.problem, 0));
  Batch validation;
  make_problem(catalog(), request.problem, 0).draw_validation(validation);
  const Real silent = 0.5 * validation.target.squaredNorm() / 1024;  // L at y = 0
  EXPECT_NEAR(*record.scale, std::min(silent, record.summary.start_loss - *record.minimum), 1e-15);
}

TEST(Best, AreAPartOfTheBuildBesideTheSourcesOfTheirProblem) {
  const auto parts_of = [](const std::string& spec) { return build_parts(cell_of(spec, "gd")); };
  const BuildParts learned = parts_of("exponential[mode=learn]"), direct = parts_of("exponential");
  EXPECT_EQ(learned.at("best"),
            digest(BestLosses::known().losses_text(problem("exponential[mode=learn]"))));
  EXPECT_FALSE(direct.contains("best"));
  for (const BuildParts& parts : {learned, direct})
    EXPECT_EQ(parts.at("problem"), tree_sources().at("problems/exponential.cpp"));
}

// Tuning: one option per method, on an equal number of values, scored by the criterion of the
// problem.

constexpr Real kNever = std::numeric_limits<Real>::infinity();

Component problem_of(const std::string& spec) {
  return complete_problem(catalog(), parse_spec(spec));
}

// --- which option

// The radius of ceres-gauss-newton is what makes it Gauss-Newton; with another it is ceres-lm.
TEST(Tuning, OfEveryMethodIsOneNumberOfItsOwn) {
  std::size_t without = 0;
  for (const auto& [name, entry] : catalog().optimizers.ready()) {
    if (entry.tunable.option.empty()) {
      without += entry.in_all;
      EXPECT_TRUE(!entry.in_all || name == "ceres-gauss-newton") << name;
      continue;
    }
    const Component problem = problem_of(name == "supervised" ? "hig-toy" : "rosenbrock");
    const auto knob = knob_of(catalog(), name, problem, {});
    ASSERT_TRUE(knob.has_value()) << name;
    EXPECT_GT(knob->standard, 0) << name;
    EXPECT_NO_THROW(complete_optimizer(catalog(), name, with_value(*knob, {}, knob->standard)));
    const Sheet sheet = optimizer_sheet(catalog(), complete_optimizer(catalog(), name, {}));
    EXPECT_EQ(sheet_from_json(to_json(sheet)).tunable, entry.tunable.option) << name;
  }
  EXPECT_EQ(without, 1U);
}

TEST(Tuning, OfWhatTrainsANetworkIsTheRateOfItsNetworksOptimizer) {
  const auto spec = [](const std::string& optimizer, const std::string& problem) {
    const auto knob = knob_of(catalog(), optimizer, problem_of(problem), {});
    return complete_optimizer(catalog(), optimizer, with_value(*knob, {}, 0.25)).spec;
  };
  EXPECT_EQ(spec("sip", "sine"), "sip[step=0.25]");
  EXPECT_EQ(spec("sip", "hig-toy"), "sip[network-optimizer=adam[rate=0.25]]");
  EXPECT_EQ(spec("rescaled", "sine"), "rescaled[network-optimizer=gd[rate=0.25]]");
  EXPECT_EQ(spec("nlopt-lbfgs", "sine"), "nlopt-lbfgs[loss-scale=0.25]");
  const OptionValues whole = with_value({.option = "memory", .is_whole = true}, {}, 0.25);
  EXPECT_EQ(whole.at("memory"), OptionValue(Index{0}));
}

// --- which values

TEST(TuningGrids, AreSevenValuesOfWhichOneIsTheDefaultWhereItLiesWithin) {
  for (const auto& [name, entry] : catalog().optimizers.ready()) {
    const auto knob = knob_of(catalog(), name, problem_of("hig-toy"), {});
    if (!knob || knob->tunable.unit == Tunable::Unit::cauchy) continue;
    const std::vector<Real> values = grid_of(*knob, knob->standard);
    EXPECT_EQ(values.size(), 7U) << name;
    EXPECT_TRUE(std::ranges::is_sorted(values)) << name;
    EXPECT_EQ(std::ranges::count(values, knob->standard), 1) << name;
  }
  // Of steps along the gradient they are in Cauchy steps.
  const auto knob = knob_of(catalog(), "gd", problem_of("sine"), {});
  ASSERT_EQ(knob->tunable.unit, Tunable::Unit::cauchy);
  const std::vector<Real> near = grid_of(*knob, 0.2), far = grid_of(*knob, 1e-6);
  EXPECT_EQ(near.size(), 7U);
  EXPECT_EQ(std::ranges::count(near, knob->standard), 1);
  EXPECT_EQ(far.size(), 7U);
  EXPECT_LT(far.back(), knob->standard);
}

TEST(TuningGrids, CommonToAllProblemsAreSevenAbsoluteValuesForEveryMethod) {
  for (const auto& [name, entry] : catalog().optimizers.ready()) {
    const auto knob = knob_of(catalog(), name, problem_of("rosenbrock"), {});
    if (!knob) continue;
    const std::vector<Real> values = common_grid_of(*knob);
    EXPECT_EQ(values.size(), 7U) << name;
    EXPECT_EQ(std::ranges::count(values, knob->standard), 1) << name;
    EXPECT_EQ(values, common_grid_of(*knob_of(catalog(), name, problem_of("sine"), {}))) << name;
    const bool is_share = knob->range.high <= 1;  // of a slope: no decades below 1
    for (std::size_t i = 1; i < values.size() && !is_share; ++i)
      EXPECT_GE(values[i] / values[i - 1], 9) << name;
  }
  const auto gd = knob_of(catalog(), "gd", problem_of("sine"), {});
  EXPECT_EQ(common_grid_of(*gd), (std::vector<Real>{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1}));
}

TEST(TuningGrids, EndWhereTheOptionDoes) {
  Knob knob{.option = "memory", .standard = 100, .range = between(0, 1000), .is_whole = true};
  knob.tunable = {.option = "memory", .below = 4};
  const std::vector<Real> values = grid_of(knob, 100);
  EXPECT_EQ(values, (std::vector<Real>{1, 3, 10, 32, 100, 316, 1000}));
  EXPECT_FALSE(value_beyond(knob, values, true).has_value());
  EXPECT_FALSE(value_beyond(knob, values, false).has_value());  // 0 would mean something else
  EXPECT_EQ(value_beyond({.standard = 1, .range = above(0)}, {0.0316, 0.1}, false), 0.01);
  EXPECT_EQ(value_beyond({.standard = 1, .range = above(0)}, {0.1, 0.316}, true), 1);
}

// --- which is best

Record run_of(Aim aim, std::int64_t hit, Real loss, Real x_error) {
  Record record;
  record.status = Status::budget;
  record.aim = aim;
  record.hits.emplace();
  record.hits->work.assign(51, hit);
  record.x_scale = 10;
  record.curve.work = {0, 40, 80};
  record.curve.x_error = {10, 1, x_error};
  record.summary.loss = loss;
  record.summary.x_error = x_error;
  return record;
}

TEST(TuningScores, CountWorkUntilWhatTheProblemsUserWants) {
  EXPECT_EQ(score_of({run_of(Aim::loss, 30, 1e-9, 5)}), (TuningScore{30, 1e-9}));
  EXPECT_EQ(score_of({run_of(Aim::x, 30, 1e-9, 5)}), (TuningScore{kNever, 5}));
  EXPECT_EQ(score_of({run_of(Aim::x, -1, 1, 9e-6)}), (TuningScore{80, 9e-6}));  // 1e-6 of ‖x*‖
  Record floored = run_of(Aim::x, -1, 1, 0.5);
  floored.x_floor = 0.6;
  EXPECT_EQ(score_of({floored}), (TuningScore{80, 0.5}));
}

TEST(TuningScores, AreMediansAndNothingWhereASeedDiverged) {
  const auto run = [](std::int64_t hit, Real loss) { return run_of(Aim::loss, hit, loss, 1); };
  EXPECT_EQ(score_of({run(30, 1), run(10, 3), run(-1, 2)}), (TuningScore{30, 2}));
  std::vector<Record> runs{run(30, 1), run(10, 3), run(20, 2)};
  runs[1].status = Status::diverged;
  EXPECT_EQ(score_of(runs), TuningScore{});
}

TEST(TuningScores, OfATieGoToTheDefaultOrToWhatIsNearest) {
  const std::vector<Real> values{0.01, 0.1, 1, 10};
  const TuningScore good{10, 1e-9}, bad{kNever, 1};
  EXPECT_EQ(best_value(values, {good, good, good, good}, 1), 2U);
  EXPECT_EQ(best_value(values, {bad, bad, bad, bad}, 0.1), 1U);
  EXPECT_EQ(best_value(values, {good, bad, bad, good}, 1), 3U);
  EXPECT_EQ(best_value(values, {bad, bad, good, bad}, 0.01), 2U);
  EXPECT_EQ(best_value(values, {{10, 2}, {10, 1}, bad, bad}, 10), 1U);
}

// --- leaving a family out

// One setting, with the work of each value.
TunedOption trials(const std::string& family, const std::vector<Real>& work) {
  TunedOption tuned{.problem = family, .optimizer = "gd", .option = "rate"};
  tuned.values = {0.01, 0.1, 1, 10, 100};
  for (const Real each : work) tuned.scores.push_back({each, 1});
  tuned.family = family;
  tuned.standard = 1;
  tuned.work = 1000;
  return tuned;
}

LeftOut row_of(const std::vector<LeftOut>& all, const std::string& family) {
  return *std::ranges::find(all, family, &LeftOut::family);
}

TEST(LeaveOneOut, NeverLooksAtTheFamilysOwnScores) {
  const std::vector<Real> low{5, 10, 20, 40, kNever}, high{kNever, kNever, kNever, 600, 3};
  const std::vector<TunedOption> odd{trials("a", low), trials("b", low), trials("odd", high)},
      alike{trials("a", low), trials("b", low), trials("odd", low)};
  const std::vector<LeftOut> rows = leave_one_out(odd);
  ASSERT_EQ(rows.size(), 3U);
  const LeftOut own = row_of(rows, "odd");
  EXPECT_EQ(own.best, 0U) << "odd itself needs 100";
  EXPECT_EQ(own.scores, row_of(leave_one_out(alike), "odd").scores);
  EXPECT_EQ(own.chosen_on, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(own.is_at_edge);
  EXPECT_EQ(own.work, 3000);
  EXPECT_NE(row_of(rows, "a").scores, row_of(leave_one_out(alike), "a").scores);
}

TEST(LeaveOneOut, AveragesOverSettingsFirstAndThenOverFamilies) {
  // At 8 times the least work: 1 − 3/6. At 64 times, or unsolved: 0.
  const std::vector<LeftOut> rows = leave_one_out(
      {trials("a", {1, 8, kNever, 64, 640}), trials("a", {kNever, 1, 1, 1, 1}),
       trials("b", {kNever, kNever, 1, kNever, kNever}), trials("c", {1, 1, 1, 1, 1})});
  EXPECT_EQ(row_of(rows, "c").scores, (std::vector<Real>{0.25, 0.375, 0.75, 0.25, 0.25}));
  EXPECT_EQ(row_of(rows, "c").best, 2U);
  EXPECT_FALSE(row_of(rows, "c").is_at_edge);
}

TEST(LeaveOneOut, OfATieTakesTheDefaultOrWhatIsNearest) {
  const std::vector<Real> all(5, 7), none(5, kNever), ends{7, kNever, kNever, 7, kNever};
  for (const auto& work : {all, none})
    EXPECT_EQ(row_of(leave_one_out({trials("a", work), trials("b", work)}), "a").best, 2U);
  EXPECT_EQ(row_of(leave_one_out({trials("a", all), trials("b", ends)}), "a").best, 3U);
}

// --- the whole

// y = s x: gradient descent on ½(s x)² solves it in one step at the rate 1/s².
struct SteepOptions {
  Real slope = 1, start = 1;
};
void fields(SteepOptions& o, auto& field) {
  field("slope", o.slope, above(0), "s");
  field("start", o.start, above(0), "x at the start");
}

problems::ProblemParts make_steep(const SteepOptions& o, const Draw& draw) {
  const auto slope = [s = o.slope](VectorRef) { return Matrix::Constant(1, 1, s).eval(); };
  return {.physics = physics_of(
              1, 1, [s = o.slope](VectorRef x) -> Vector { return s * x; }, slope),
          .start = draw.start(Vector::Constant(1, o.start)),
          .target = Vector::Zero(1),
          .minimum = 0};
}

Catalog with_steep() {
  Catalog all = builtin_catalog();
  all.problems.add(
      problem_entry({.name = "steep", .title = "Steep", .family = "slopes"}, make_steep));
  return all;
}

Json rows_of(const Catalog& all, const std::string& problem, const std::string& optimizer,
             std::int64_t iterations) {
  const TemporaryFolder folder;
  const TuningPlan plan{.pairs = {{.problem = complete_problem(all, parse_spec(problem)),
                                   .optimizer = optimizer,
                                   .budget = {.iterations = iterations, .work = 400}}},
                        .seeds = {100, 101, 102}};
  return *tune(all, plan, folder.path(), {.jobs = 2}).rows;
}

// A step of adam is as long as its rate: of a million, the longest goes the farthest.
TEST(Tuning, GoesOnBeyondAnEdgeThatIsBestAndMarksWhereItStops) {
  const Json row = rows_of(with_steep(), "steep[start=1e6]", "adam", 1).at(0);
  const Json& source = row["source"];
  EXPECT_EQ(source["grid"]["rate"].size(), 10U);  // seven, and three beyond
  EXPECT_EQ(row["options"]["rate"], source["grid"]["rate"][9]);
  EXPECT_EQ(source["edge"], true);
  EXPECT_EQ(source["score"].size(), 10U);
}

// Cauchy's step, 1/s², solves it at once.
TEST(Tuning, StopsAtSevenValuesWhereTheBestIsAmongThemAndLeavesOutWhatIsInapplicable) {
  const Json row = rows_of(with_steep(), "steep[slope=1e-4]", "gd", 100).at(0);
  EXPECT_EQ(row["source"]["grid"]["rate"].size(), 7U);
  EXPECT_EQ(row["options"]["rate"], 1e8);
  EXPECT_FALSE(row["source"].contains("edge"));
  EXPECT_EQ(rows_of(catalog(), "rosenbrock", "kfac", 10).size(), 0U);
}

// gd solves steep at 1/s², far from what square needs.
TEST(Tuning, OfFamiliesLeftOutIsATableThatRunsUse) {
  const Catalog all = with_steep();
  const TemporaryFolder folder;
  TuningPlan plan{.seeds = {100, 101, 102}, .is_common = true};
  for (const char* problem : {"steep[slope=1e-2]", "steep[slope=1e-3]", "square"})
    for (const char* optimizer : {"gd", "ceres-lm"})
      plan.pairs.push_back({.problem = complete_problem(all, parse_spec(problem)),
                            .optimizer = optimizer,
                            .budget = {.iterations = 40, .work = 100}});
  const TuningResult result = tune(all, plan, folder.path(), {.jobs = 2});
  EXPECT_EQ(result.outcome.run, 3 * 2 * 7 * 3) << "equal trials, and no extensions";
  ASSERT_EQ(result.left_out_rows->size(), 4U);
  const Json table{{"schema", "isoline.rates/1"}, {"rows", *result.left_out_rows}};
  EXPECT_EQ(schema_violations(table, schema("rates")), std::vector<std::string>{});
  const Rates rates = Rates::from_text(json_text(table), "physics.json");
  const Component steep = complete_problem(all, parse_spec("steep[slope=0.5]"));
  const Rates::Row* row = rates.find(steep, "gd", "physics");
  ASSERT_NE(row, nullptr);
  const Json source = parse_json(row->source, "source");
  EXPECT_EQ(source["families"], Json({"square"}));
  EXPECT_EQ(source["grid"]["rate"].size(), 7U);
  EXPECT_GT(source["spent"], 0);
}

TEST(UsedRates, StandBesideThePlanWithTheTableTheyAreFrom) {
  const TemporaryFolder folder;
  const Suite suite{.name = "mine",
                    .title = "",
                    .blocks = {{.problems = {"rosenbrock", "sine[mode=learn,xi=32]"},
                                .optimizers = {"adam", "ceres-gauss-newton"}}}};
  const Rates rates = Rates::builtin();
  Store store(folder.path());
  write_used_rates(rates, expand(catalog(), suite, rates), store);
  write_used_rates(rates, {}, store);  // another plan of the folder uses none
  const Json table = read_json(folder.path() / "rates.json");
  EXPECT_EQ(schema_violations(table, schema("rates")), std::vector<std::string>{});
  ASSERT_EQ(table["rows"].size(), 2U);
  EXPECT_EQ(table["rows"][0]["file"], "direct.json");
  EXPECT_TRUE(table["rows"][0]["source"].contains("grid"));
  EXPECT_EQ(table["rows"][1]["file"], "learn.json");
  EXPECT_TRUE(table["rows"][1]["source"].contains("paper"));
  for (const Json& row : table["rows"]) EXPECT_FALSE(row.contains("setting")) << row;
}

TEST(UsedRates, AreThoseOfNoTableWhereTheTextOfTheOptimizerSetsThem) {
  const Suite suite{.name = "mine",
                    .title = "",
                    .blocks = {{.problems = {"sine"}, .optimizers = {"adam", "adam[rate=0.25]"}}}};
  const std::vector<Request> cells = expand(catalog(), suite, Rates::builtin());
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_NE(cells[0].rates, "");
  EXPECT_EQ(cells[1].rates, "");
}

// The rates of the sine are tuned at its defaults.
TEST(UsedRates, OfAnotherSettingNameTheSettingThatTheyWereTunedOn) {
  const TemporaryFolder folder;
  const Suite suite{.name = "mine",
                    .title = "",
                    .blocks = {{.problems = {"sine[xi=20]"}, .optimizers = {"adam"}}}};
  const Rates rates = Rates::builtin();
  Store store(folder.path());
  write_used_rates(rates, expand(catalog(), suite, rates), store);
  const Json table = read_json(folder.path() / "rates.json");
  EXPECT_EQ(schema_violations(table, schema("rates")), std::vector<std::string>{});
  ASSERT_EQ(table["rows"].size(), 1U);
  EXPECT_EQ(table["rows"][0]["setting"], "sine");
}

}  // namespace
}  // namespace isoline::benchmarks
