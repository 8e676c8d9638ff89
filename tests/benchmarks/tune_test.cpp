// Tuning: every method's one option, on an equal number of values, scored by what a problem's user
// wants.
#include "benchmarks/run/tune.h"

#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/run/sheets.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using optimizers::Tunable;
namespace {

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
      ++without;
      EXPECT_EQ(name, "ceres-gauss-newton");
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
  EXPECT_EQ(best_of({3, 1, 2}), (std::vector<Real>{2, 4.0 / 3, 1})) << "from the mean to the least";
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
  all.problems.add(problem_entry({.name = "steep", .title = "Steep"}, make_steep));
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
  EXPECT_EQ(source["best_of"].size(), 10U);
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
  const Rates rates = Rates::from_json(table, "physics.json");
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
}

}  // namespace
}  // namespace isoline::benchmarks
