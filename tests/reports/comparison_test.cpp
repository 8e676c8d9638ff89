// Comparison of result folders: denominators, missing cells, builds, broken files, criteria.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/results/ranking.h"
#include "core/results/study.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

TEST(Study, AnInvalidRecordIsListedAndNotFatal) {
  const ResultFolder folder;
  folder.add(record_of({}));
  folder.add_file("runs/torn.json", R"({"schema": "isoline.run/1", "cell": "a)");
  folder.add_file("runs/other.json", R"({"schema": "something else"})");
  Json uneven = to_json(record_of({.seed = 1}));
  uneven["curve"]["loss"].push_back(1.0);
  folder.add_file("runs/uneven.json", uneven.dump());
  folder.add_file("components/empty.json", "");
  const Study study = read_study({folder.path()});
  EXPECT_EQ(study.runs.size(), 1U);
  ASSERT_EQ(study.unreadable.size(), 4U);
  for (const Unreadable& file : study.unreadable) EXPECT_FALSE(file.reason.empty());
  EXPECT_THROW(read_study({"/no/such/folder"}), UsageError);
}

TEST(Study, TheNewestBuildAnswersForACell) {
  const ResultFolder one, other;
  one.add(record_of({.work_per_hit = 4, .started = "2026-01-01T00:00:00Z", .build = "b0"}));
  one.add(record_of({.work_per_hit = 2, .started = "2026-03-01T00:00:00Z", .build = "b1"}));
  other.add(record_of({.work_per_hit = 8, .started = "2026-02-01T00:00:00Z", .build = "b2"}));
  const Study study = read_study({one.path(), other.path()});
  ASSERT_EQ(study.runs.size(), 1U);
  EXPECT_EQ(study.runs[0].build, "b1");
  EXPECT_EQ(study.superseded, 2U);
  EXPECT_NE(remarks(compare_optimizers(study)).front().find("2 older results"), std::string::npos);
}

TEST(Study, FoldersAreUnited) {
  const ResultFolder one, other;
  const Record a = record_of({}), b = record_of({.seed = 1});
  one.add(a);
  one.add(plan_of({a, b}));
  other.add(b);
  other.add(plan_of({b}));
  const Study study = read_study({one.path(), other.path()});
  EXPECT_EQ(study.runs.size(), 2U);
  EXPECT_EQ(study.plan.cells.size(), 2U);
}

TEST(Comparison, APartialPlanSaysWhatIsMissing) {
  const ResultFolder folder;
  const Record a = record_of({}), b = record_of({.optimizer = "adam", .seed = 3});
  folder.add(a);
  folder.add(plan_of({a, b}));
  const Study study = read_study({folder.path()});
  EXPECT_TRUE(missing_text(compare_optimizers(study)).starts_with("1 of 2 cells, "));
  EXPECT_TRUE(missing_text(compare_optimizers(study)).ends_with("square / adam / seed 3"));
}

// Work to 1e-6 is 30 · work_per_hit: 60, 120, 60 reached; two runs reach 1e-3 at most, one of them
// crashed. Sorted: 60 60 120 ∞ ∞.
TEST(Comparison, FailuresStayInTheDenominator) {
  const Compared comparison({record_of({.seed = 0}), record_of({.seed = 1, .work_per_hit = 4}),
                             record_of({.seed = 2}),
                             record_of({.seed = 3, .hits = 20, .status = Status::budget}),
                             record_of({.seed = 4, .hits = 3, .status = Status::crashed})});
  const Cell& cell = comparison.cell(0, 0);
  EXPECT_EQ(cell.headline[kTightest].median, 120);
  EXPECT_EQ(cell.headline[1].unsolved, 1U);  // 1e-3 is index 15
  EXPECT_EQ(cell.failed, 1U);
  EXPECT_EQ(count_text(cell, kTightest), "3/5, 1 failed");
  EXPECT_EQ(status_text(cell.statuses), "target 3, budget 1, crashed 1");
}

TEST(Comparison, TheLeastMedianWorkIsBestAndTiesAllAre) {
  const Compared comparison({record_of({.optimizer = "a"}), record_of({.optimizer = "b"}),
                             record_of({.optimizer = "c", .work_per_hit = 3})});
  std::map<std::string, bool> best;
  for (std::size_t s = 0; s < 3; ++s)
    best[comparison.optimizers[s].label] = comparison.cell(0, s).is_best[kTightest];
  EXPECT_EQ(best, (std::map<std::string, bool>{{"a", true}, {"b", true}, {"c", false}}));
}

TEST(Comparison, AnInapplicableCellIsNoFailure) {
  const Compared comparison(
      {record_of({.optimizer = "a"}), record_of({.optimizer = "b",
                                                 .hits = 0,
                                                 .status = Status::inapplicable,
                                                 .message = "needs a Hessian"})});
  EXPECT_TRUE(comparison.failures.empty());
  EXPECT_EQ(comparison.cell(0, 1).inapplicable, "needs a Hessian");
  EXPECT_EQ(comparison.optimizers[1].applicable, 0U);
  EXPECT_EQ(comparison.profiles[kTightest].share(1, 1e9), 0);
}

// b is worse on the problem both have, and alone on its other: a was never asked there, and neither
// is judged by it.
TEST(Comparison, AProblemNeverPlannedDoesNotCountAgainstAMethod) {
  const Compared comparison({record_of({.problem = "heat", .optimizer = "a"}),
                             record_of({.problem = "heat", .optimizer = "b", .work_per_hit = 4}),
                             record_of({.problem = "wood", .optimizer = "b"})});
  EXPECT_EQ(comparison.optimizers[0].label, "a");
  EXPECT_EQ(comparison.optimizers[0].planned, 1U);
  EXPECT_EQ(comparison.optimizers[0].tightest().solved, 1U);
  EXPECT_EQ(comparison.profiles[kTightest].share(0, 1), 1);
  EXPECT_EQ(comparison.profiles[kTightest].share(1, 1), 0) << "compared where both were asked";
  EXPECT_TRUE(has(remarks(comparison).front(), "wood: 1"));
}

TEST(Comparison, ThePrivilegedLeadOnlyAmongAll) {
  Study study;
  for (const char* problem : {"beale", "heat", "sine", "wood"})
    for (const auto& [optimizer, work] :
         {std::pair{"seer", 1}, std::pair{"fair", 3}, std::pair{"slow", 9}})
      study.runs.push_back(
          record_of({.problem = problem, .optimizer = optimizer, .work_per_hit = work}));
  for (Record& record : study.runs)
    if (record.request.optimizer.name == "seer") record.privileges = {"the solution"};
  const Compared c(study);
  EXPECT_EQ(c.optimizers[c.decision->places[0].method].label, "seer");
  EXPECT_EQ(c.optimizers[c.open_decision->places[0].method].label, "fair");
  EXPECT_EQ(c.open_decision->places[0].share_first, 1);  // on every problem, so in every draw
  // the decision, its group, what is solved, its robustness, that of the others, the limit
  EXPECT_EQ(verdict(c).size(), 6U);
}

// Two methods over three seeds on two problems; b misses seed 2 of q, which was planned.
TEST(Table, SelectsGroupsAggregatesJoinsAndPivots) {
  Study study;
  for (const char* problem : {"p", "q"})
    for (const char* optimizer : {"a", "b"})
      for (const std::uint64_t seed : {0, 1, 2})
        study.runs.push_back(record_of({.problem = problem,
                                        .optimizer = optimizer,
                                        .seed = seed,
                                        .work_per_hit = static_cast<std::int64_t>(seed + 1)}));
  study.plan = plan_of(study.runs);
  study.runs.pop_back();
  const results::Table table = table_of(study);
  ASSERT_EQ(table.runs.size(), 11U);
  ASSERT_EQ(table.absent.size(), 1U);
  EXPECT_EQ(table.absent[0].seed, 2U);
  EXPECT_EQ(table.absent[0].record, nullptr);
  Rows all(table.runs.size());
  std::iota(all.begin(), all.end(), 0);
  const auto cell_of = [&](std::size_t p, std::size_t s) {
    return table.where(
        all, [=](const reports::Run& run) { return run.problem == p && run.optimizer == s; });
  };
  EXPECT_EQ(cell_of(1, 1).size(), 2U);
  const auto by_seed = table.group(all, [](const reports::Run& run) { return run.seed; });
  EXPECT_EQ(by_seed.at(0).size(), 4U);
  EXPECT_EQ(by_seed.at(2).size(), 3U);
  const auto work = [](const reports::Run& run) { return run.taken(Measure::work, 30); };
  EXPECT_EQ(table.aggregate(cell_of(0, 0), work).median, 60);
  EXPECT_EQ(table.aggregate(cell_of(1, 1), work, 1).unsolved, 1U);
  const auto pairs =
      table.join(cell_of(1, 0), cell_of(1, 1), [](const reports::Run& run) { return run.seed; });
  EXPECT_EQ(pairs.size(), 2U) << "seed 2 has no partner";
  const Pivot cells = pivot(table, {});
  EXPECT_EQ(cells[1][1].runs, cell_of(1, 1));
  EXPECT_EQ(cells[1][1].planned, 3U);
  EXPECT_EQ(cells[0][0].median(Measure::work, 30), 60);
}

// From f₀ = 1 with f_L = 0.5 declared, the curve 10^(−j/5) has half of its descent left at 0.75.
TEST(Curves, TheGapIsWhatIsLeftOfTheDescent) {
  Record record = record_of({.hits = 2});
  record.minimum = 0.5;
  record.curve.loss = {1, 0.75};
  const Compared c({record});
  EXPECT_EQ(median_curve(c, c.cell(0, 0), 10).gap, (std::vector<Real>{1, 0.5}));
}

TEST(Comparison, TwoGridsOfOneEquationAreOneProblem) {
  EXPECT_TRUE(has(headline(Compared(
                      {record_of({.problem = "heat[N=8]"}), record_of({.problem = "heat[N=16]"})})),
                  "1 problem (2 settings), 1 seed"));
  EXPECT_TRUE(has(headline(Compared({record_of({}), record_of({.problem = "heat"}),
                                     record_of({.problem = "heat", .seed = 1})})),
                  "up to 2 seeds"));
}

// "sine-x" sorts between "sine" and "sine[xi=32]", which are of one name all the same. On sine the
// two are even, on sine-x a is ahead: one draw in four has sine alone, where they share the lead,
// so a keeps 7/8. Were the settings of sine drawn apart, it would keep 17/27.
TEST(Comparison, SettingsOfOneProblemAreDrawnTogetherWhateverStandsBetweenThem) {
  const Compared c(study_of({{"sine", "a", 1},
                             {"sine", "b", 100},
                             {"sine-x", "a", 1},
                             {"sine-x", "b", 2},
                             {"sine[xi=32]", "a", 100},
                             {"sine[xi=32]", "b", 1}}));
  EXPECT_EQ(c.names, 2U);
  EXPECT_EQ(c.optimizers[c.decision->places[0].method].label, "a");
  // Four standard errors of 1,000 draws.
  EXPECT_NEAR(c.decision->places[0].share_first, 0.875, 0.03);
}

TEST(Comparison, RatesFromAFileDoNotSplitAMethod) {
  Record tuned = record_of({.problem = "heat", .optimizer = "gd[rate=0.5]"});
  Record other = record_of({.problem = "square", .optimizer = "gd[rate=0.1]"});
  tuned.request.rates = other.request.rates = "benchmarks/rates/gd.json";
  const Compared comparison({tuned, other});
  ASSERT_EQ(comparison.optimizers.size(), 1U);
  EXPECT_EQ(comparison.optimizers[0].label, "gd");
  EXPECT_EQ(comparison.optimizers[0].method, "gd");
}

// The best of both ends at 0.01: nothing says that it is a minimum.
TEST(Comparison, WithoutAKnownLeastLossNothingIsSolvedAndLossesAreCompared) {
  Record a = record_of({.optimizer = "a", .hits = 11}),
         b = record_of({.optimizer = "b", .hits = 6});
  for (Record* record : {&a, &b}) {
    record->hits.reset();
    record->minimum.reset();
  }
  Study study;
  study.runs = {a, b};
  EXPECT_NEAR(BestKnown(study).minimum(b), 0.01, 1e-15);
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(c.problems[0].lacks_least_loss());
  EXPECT_TRUE(c.order.settings.empty());
  for (const auto& run : c.runs) EXPECT_EQ(c.taken(run, Measure::work, 0), kNever);
  const Document document = document_of(c);
  const Section& standings = document.section("standings");
  ASSERT_EQ(standings.tables.size(), 1U);
  EXPECT_EQ(at(standings.tables[0], "a", "square"), "0.01 (+0 %)");
  EXPECT_EQ(at(standings.tables[0], "b", "square"), "0.1 (+9 %)");  // 0.09 of 1 − 0.01
  EXPECT_TRUE(has(standings.readings.at(0).text, "0.01 (not")) << standings.readings[0].text;
  EXPECT_FALSE(has(terminal_table(document), "/1"));
  Study larger;
  for (int i = 0; i < 40; ++i)
    for (const Record& record : study.runs) {
      larger.runs.push_back(record);
      larger.runs.back().request.optimizer.name += std::to_string(i);
      larger.runs.back().request.optimizer.spec = larger.runs.back().request.optimizer.name;
    }
  const std::string matrix = terminal_table(document_of(compare_optimizers(larger)));
  EXPECT_TRUE(has(matrix, "a39")) << matrix;
  EXPECT_FALSE(has(matrix, "\nSmallest median")) << matrix;
  // One that knows f_L, as of a later table of best losses, is not enough; a cell that failed
  // before it had any loss takes nothing away.
  study.runs[0].minimum = 0.01;
  EXPECT_TRUE(compare_optimizers(study).problems[0].lacks_least_loss());
  study.runs[1].summary.best_loss = NAN;
  study.runs[1].status = Status::failed;
  EXPECT_FALSE(compare_optimizers(study).problems[0].lacks_least_loss());
}

// One cell at 10 and at 1,000 iterations: two rows; another method and problem keep theirs.
TEST(Comparison, BudgetsOfOneCellHaveRowsOfTheirOwn) {
  Study study;
  for (const std::int64_t iterations : {10, 1000}) {
    Record record = record_of({.optimizer = "gd", .hits = iterations == 10 ? 6U : 51U});
    record.request.budget.iterations = iterations;
    record.cell = cell_digest(record.request);
    study.runs.push_back(record);
  }
  study.runs.push_back(record_of({.optimizer = "adam"}));
  study.plan = plan_of(study.runs);
  const Comparison c = compare_optimizers(study);
  ASSERT_EQ(c.optimizers.size(), 3U);
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(c.cell(0, s).runs.size(), 1U) << c.optimizers[s].label;
    EXPECT_EQ(c.optimizers[s].has_budgets, c.optimizers[s].method == "gd");
  }
  const std::string sentences = joined(remarks(c));
  EXPECT_TRUE(has(sentences, "--iterations 10)") && has(sentences, "--iterations 1000)"))
      << sentences;
}

TEST(Comparison, AnImportedCurveLacksNoSeedOfOthers) {
  std::vector<Record> records{record_of({.optimizer = "theirs"})};
  records[0].imported = Imported{.source = "a paper", .program = "p", .curve = "c", .sha256 = ""};
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    for (const char* optimizer : {"gd", "adam"})
      records.push_back(record_of({.optimizer = optimizer, .seed = seed}));
  const Compared c(records);
  for (std::size_t s = 0; s < 3; ++s)
    EXPECT_EQ(c.cell(0, s).planned, c.optimizers[s].is_imported ? 1U : 3U);
}

// Beyond the end of the profile both scores are 0.
TEST(Comparison, AMethodThatSolvesSharesNoPlaceWithOneThatDoesNot) {
  const Compared c(study_of({{"p", "a", 1}, {"p", "b", 204}, {"p", "c", 0}, {"p", "d", 0}}));
  const Document document = document_of(c);
  const Table& table = document.section("standings").tables.at(0);
  std::vector<std::string> places;
  for (const auto& row : table.rows) places.push_back(row[0].text + row[1].text);
  EXPECT_EQ(places, (std::vector<std::string>{"1a", "2b", "3c", "3d"}));
}

TEST(Comparison, AnImportedRunIsMarkedAndMovesNobodysTargets) {
  Study study;
  study.runs = {record_of({.optimizer = "gd"}), record_of({.optimizer = "theirs"})};
  for (Record& record : study.runs) record.minimum.reset();
  const Real ours = study.runs[0].summary.best_loss;
  study.runs[1].imported =
      Imported{.source = "a paper", .program = "p", .curve = "c", .sha256 = ""};
  study.runs[1].summary.best_loss = ours - 5;
  const Comparison c = compare_optimizers(study);
  ASSERT_EQ(c.optimizers.size(), 2U);
  for (const OptimizerAxis& axis : c.optimizers)
    EXPECT_EQ(axis.is_imported, axis.method == "theirs") << axis.method;
  EXPECT_EQ(c.runs[0].minimum, ours);
  study.runs[1].imported.reset();
  EXPECT_EQ(compare_optimizers(study).runs[0].minimum, ours - 5) << "as a run of ours it would";
}

// Criteria: the scale of a loss, the two kinds of success, other tolerances.

// From 1e107 down to 1e91, sixteen decades: a start that was drawn badly makes nothing solved.
TEST(Yardstick, AHugeStartMakesNoLossSmall) {
  Record record = record_of({.hits = 2, .status = Status::budget});
  record.hits.reset();
  record.minimum = 0.062;
  record.scale = 1;
  record.curve.loss = {1.6e107, 1.6e91};
  record.summary.start_loss = 1.6e107;
  record.summary.loss = record.summary.best_loss = 1.6e91;
  const Compared c({record});
  EXPECT_EQ(c.taken(c.runs[0], Measure::work, 0), kNever);
  EXPECT_EQ(c.optimizers[0].standings[0].solved, 0U);
}

// The loss falls ten decades, the error in x to a third at most.
Record lost_in_x() {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  for (Real& error : record.curve.x_error) error = std::max(error, 0.35);
  record.summary.x_error = 0.35;
  return record;
}

// A method that reports the solution and returns another point.
TEST(Yardstick, ARunThatReturnsABadPointHasNotReachedTheTolerance) {
  Record record = record_of({.status = Status::unconfirmed});
  record.summary.loss = 0.5;
  const Compared c({record});
  EXPECT_EQ(c.runs[0].loss_met, 51U);
  EXPECT_EQ(c.optimizers[0].standings[0].reached, 0U);
}

TEST(Yardstick, AProblemThatWantsXIsNotSolvedByASmallLoss) {
  const Compared c({lost_in_x()});
  const reports::Run& run = c.runs[0];
  EXPECT_EQ(run.loss_met, 51U);
  EXPECT_EQ(run.x_met, 3U);  // 0.4 is met, 0.35 is the floor
  EXPECT_EQ(c.taken(run, Measure::work, 0), kNever);
  EXPECT_EQ(c.problems[0].aim, Aim::x);
  EXPECT_EQ(c.optimizers[0].standings[0].solved, 0U);
  EXPECT_FALSE(c.decision.has_value());
}

// The curve 10^(−j/10) meets 1e-1 at its tenth point, after 20 forwards.
TEST(Yardstick, XIsFoundWhereItsErrorIsATenthOfTheSolution) {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  const Compared c({record});
  EXPECT_EQ(c.taken(c.runs[0], Measure::work, 0), 20);
  EXPECT_EQ(c.taken(c.runs[0], Measure::iterations, 0), 10);
  EXPECT_FALSE(c.cell(0, 0).is_bound[0]) << "no point was skipped";
}

TEST(Yardstick, NoDataGiveMoreThanTheirFloor) {
  Record record = lost_in_x();
  record.x_floor = 0.32;  // 1.1 times that is 0.352
  Study study;
  study.runs = {record};
  EXPECT_GT(compare_optimizers(study).runs[0].targets.size(), kTolerances[kTightest].rung);
}

TEST(Yardstick, BetweenKeptPointsAFigureIsABound) {
  Record record = record_of({});
  record.aim = Aim::x;
  record.x_scale = 1;
  for (std::size_t i = 10; i < record.curve.iteration.size(); ++i) record.curve.iteration[i] += 5;
  const Compared c({record});
  EXPECT_TRUE(c.runs[0].targets[kTolerances[0].rung].is_bound);
  EXPECT_TRUE(c.cell(0, 0).is_bound[0]);
}

TEST(Yardstick, BetweenRungsTheNextStricterHolds) {
  EXPECT_EQ(tolerance_at(1e-4).name, "1e-4");
  EXPECT_EQ(tolerance_at(1e-4).rung, 20U);
  EXPECT_EQ(tolerance_at(2e-4).rung, 19U);
  EXPECT_LE(tolerance_at(2e-4).tau, 2e-4);
  EXPECT_EQ(tolerance_at(2e-4).name, "1.6e-4");
}

TEST(Yardstick, AnotherHeadlineKeepsTheLooserTolerancesLooser) {
  const Yardstick usual = yardstick_at(Measure::work, 1e-4),
                  loose = yardstick_at(Measure::work, 0.1);
  EXPECT_EQ(usual.tolerances[1].name, "1e-3");
  EXPECT_EQ(usual.tightest().name, "1e-4");
  for (const Yardstick& each : {usual, loose, yardstick_at(Measure::time, 1e-10)})
    for (std::size_t t = 1; t < kTolerances.size(); ++t)
      EXPECT_LT(each.tolerances[t - 1].rung, each.tolerances[t].rung);
}

// `a` takes fewer forwards, `b` fewer iterations to 1e-4: 40 and 100 forwards, 20 and 10 steps.
TEST(Yardstick, WhatIsCountedDecidesWhoIsBest) {
  Record a = record_of({.optimizer = "a"}), b = record_of({.optimizer = "b", .work_per_hit = 5});
  for (auto* steps : {&b.hits->iteration, &b.curve.iteration})
    for (std::int64_t& step : *steps) step /= 2;
  const Compared by_work({a, b}, yardstick_at(Measure::work, 1e-4)),
      by_steps({a, b}, yardstick_at(Measure::iterations, 1e-4));
  EXPECT_EQ(by_work.optimizers[0].label, "a");
  EXPECT_EQ(by_work.cell(0, 0).headline[kTightest].median, 40);
  EXPECT_EQ(by_steps.optimizers[0].label, "b");
  EXPECT_EQ(by_steps.cell(0, 0).headline[kTightest].median, 10);
  EXPECT_EQ(median_costs(by_steps, kTightest, Measure::work)[0][0], 100);
}

// a takes fewer forward solves, b fewer iterations and less time, on each of five problems.
Study crossed() {
  Study study;
  for (const char* problem : {"p", "q", "r", "s", "t"}) {
    Record a = record_of({.problem = problem, .optimizer = "a", .work_per_hit = 1});
    Record b = record_of({.problem = problem, .optimizer = "b", .work_per_hit = 8});
    for (auto& seconds : a.hits->wall_seconds) seconds *= 100;
    for (auto& iteration : a.hits->iteration) iteration *= 3;
    for (Record* record : {&a, &b}) {
      record->provenance.run.is_exclusive = true;
      record->provenance.run.concurrent_jobs = 1;
      study.runs.push_back(*record);
    }
  }
  return study;
}

// To 1e-4, the 20th target, b takes 8 · 20 = 160 forward solves and 1.6 ms.
TEST(OtherYardsticks, EveryFormatTellsItsMeasureAndItsTolerance) {
  const Study study = crossed();
  const Document work = document_of(compare_optimizers(study, yardstick_at(Measure::work, 1e-4)));
  const Document time = document_of(compare_optimizers(study, yardstick_at(Measure::time, 1e-4)));
  for (const auto text : {readable_html, markdown_report, latex_report, terminal_table}) {
    EXPECT_TRUE(has(text(work), "1e-4"));
    EXPECT_TRUE(has(text(work), "160"));
    EXPECT_FALSE(has(text(work), "Median wall time"));
    EXPECT_TRUE(has(text(time), "wall time"));
    EXPECT_TRUE(has(text(time), "1.6"));
  }
  EXPECT_TRUE(has(csv_report(work), ",work_to_1e-4"));
  const Json json = parse_json(json_report(time), "report");
  EXPECT_EQ(json["yardstick"]["by"], "time");
  EXPECT_EQ(json["yardstick"]["tolerances"][2]["name"], "1e-4");
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/report.json");
  EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>());
}

TEST(OtherYardsticks, ThePageStartsAtTheTolerancesOfTheReport) {
  const Study study = crossed();
  const Document document =
      document_of(compare_optimizers(study, yardstick_at(Measure::iterations, 1e-4)));
  const std::string data = page_data(document, all_found_fields(document.comparison));
  EXPECT_TRUE(has(data, "\"by\":\"iterations\"")) << "what its scripts count";
  EXPECT_TRUE(has(data, "\"rungs\":[5,15,20]"));
  EXPECT_TRUE(has(readable_html(document), "<output id=\"tau\">1e-4</output>"));
}

TEST(OtherYardsticks, TimesTakenBesideOtherRunsAreMarked) {
  Study study = crossed();
  for (Record& record : study.runs) record.provenance.run.concurrent_jobs = 2;
  for (Record& record : study.runs) record.provenance.run.is_exclusive = false;
  const Document document =
      document_of(compare_optimizers(study, yardstick_at(Measure::time, 1e-6)));
  EXPECT_TRUE(has(markdown_report(document), "2.4≈"));
  EXPECT_TRUE(has(terminal_table(document), "≈"));
}

}  // namespace
}  // namespace isoline::reports
