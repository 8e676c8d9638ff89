// Tables of statistics, costs, amortized training and the audit: cases computed by hand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/results/study.h"
#include "core/seeds.h"
#include "reports/page/page.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Work 30, 300 and never: a third within 100, two thirds within 1000.
TEST(Tables, DataProfileCountsForwardSolvesAndKeepsFailures) {
  const Table table =
      data_profile_table(Compared(study_of({{"p", "a", 1}, {"q", "a", 10}, {"r", "a", 0}})));
  EXPECT_EQ(at(table, "a", "≤ 10"), "0 %");
  EXPECT_EQ(at(table, "a", "≤ 100"), "33 %");
  EXPECT_EQ(at(table, "a", "≤ 1000"), "67 %");
  EXPECT_EQ(at(table, "a", "n problems"), "3");
}

// Calls of 60 in batches beside 30 one after the other; a method without rounds stays out.
TEST(Tables, RoundsChangeTheWinnerWithTheNumberOfWorkers) {
  const auto run_of = [](const char* optimizer, std::int64_t per_hit, bool is_at_once) {
    Record record = record_of({.problem = "p", .optimizer = optimizer, .work_per_hit = per_hit});
    for (const std::int64_t workers : {8, 64})
      for (const std::int64_t work : record.curve.work)
        record.curve.rounds[std::to_string(workers)].push_back(
            is_at_once ? (work + workers - 1) / workers : work);
    return record;
  };
  const Record plain = record_of({.problem = "p", .optimizer = "gd"});
  const Record batches = run_of("batches", 2, true), single = run_of("single", 1, false);
  const Table table = rounds_table(Compared({batches, single, plain}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(at(table, "batches", "calls"), "60");
  EXPECT_EQ(at(table, "batches", "1 worker"), multiple(2));
  EXPECT_EQ(at(table, "single", "1 worker"), multiple(1));
  EXPECT_EQ(at(table, "batches", "8 workers"), multiple(1));
  EXPECT_EQ(at(table, "single", "8 workers"), multiple(30.0 / 8));
  EXPECT_EQ(at(table, "single", "64 workers"), multiple(30));
  EXPECT_EQ(rounds_table(Compared({single, plain})).id, "") << "none shares rounds";
}

Record regression_of(const char* optimizer, const char* dataset, Index start, Real x_error) {
  Record record = record_of({.problem = "nist", .optimizer = optimizer});
  record.request.problem.options = {{"dataset", std::string(dataset)}, {"start", start}};
  record.request.problem.spec = fmt::format("nist[dataset={},start={}]", dataset, start);
  record.cell = digest(record.request.problem.spec + optimizer);
  record.summary.x_error = x_error;
  return record;
}

// Digits 8, 5 and 3 by one method, 9 and of an error above 1 by the other; eleven are certified.
TEST(Tables, CertifiedDigitsAreThoseOfTheWorstParameter) {
  const Compared c({regression_of("lm", "Rat42", 1, 1e-8), regression_of("lm", "Rat42", 2, 1e-5),
                    regression_of("lm", "BoxBOD", 1, 1e-3), regression_of("gd", "Rat42", 1, 7),
                    regression_of("gd", "BoxBOD", 2, 1e-13)});
  const Table table = certified_table(c);
  EXPECT_EQ(at(table, "lm", "mean LRE"), "5.33");
  EXPECT_EQ(at(table, "lm", "solved"), "2");
  EXPECT_EQ(at(table, "lm", "accurate"), "1");
  EXPECT_EQ(at(table, "lm", "Rat42"), "8.0 / 5.0");
  EXPECT_EQ(at(table, "gd", "mean LRE"), "5.50");
  EXPECT_EQ(at(table, "gd", "BoxBOD"), "11.0");
  EXPECT_EQ(table.rows[0][0].text, "gd");
  EXPECT_EQ(table.rows.size(), 2U + 6);
  EXPECT_EQ(certified_table(Compared(study_of({{"p", "a", 1}}))).id, "");
}

TEST(Tables, StandardDeviationsAreOfTheBestRunOfAProblem) {
  Record best = record_of({.problem = "square", .optimizer = "gd"});
  best.minimum = 1e-30;
  best.uncertainty = {.x = {1, 2},
                      .standard_deviation = {0.1, 0.2},
                      .correlation = {{1, -0.5}, {-0.5, 1}},
                      .variance = 4,
                      .degrees_of_freedom = 7,
                      .condition = 3};
  Record other = record_of({.problem = "square", .optimizer = "adam", .work_per_hit = 9});
  other.uncertainty = best.uncertainty;
  other.uncertainty->x = {5, 6};
  const std::vector<Table> tables = uncertainty_tables(Compared({best, other}));
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(at(tables[0], "x1", "x"), "1");
  EXPECT_EQ(at(tables[0], "x2", "standard deviation"), "0.2");
  EXPECT_EQ(at(tables[0], "x2", "strongest correlation"), "-0.5 with x1");
  EXPECT_EQ(record_from_text(file_text(best), "").uncertainty->correlation,
            best.uncertainty->correlation);
  Record exact = best;
  exact.minimum = 0;
  EXPECT_TRUE(uncertainty_tables(Compared({exact})).empty()) << "the residual is rounding";
  best.answer = AnswerPoints{.unknowns = 2,
                             .names = {"k", "c"},
                             .units = {"N/m", ""},
                             .points = {kReturned},
                             .x = {{1, 2}}};
  const std::vector<Table> named = uncertainty_tables(Compared({best}));
  EXPECT_EQ(at(named[0], "k [N/m]", "x"), "1");
  EXPECT_EQ(at(named[0], "c", "strongest correlation"), "-0.5 with k");
  best.uncertainty->x.pop_back();
  EXPECT_THROW(record_from_text(file_text(best), ""), UsageError);
}

// A loss from −1 to −5 with f_L = −5, read off the curve, as of records without hits.
TEST(Tables, ProfilesAreRightForNegativeLosses) {
  Study study = study_of({{"p", "a", 2}});
  Record& record = study.runs[0];
  record.hits.reset();
  record.minimum = -5;
  for (Real& loss : record.curve.loss) loss = -5 + 4 * loss;  // 1 … 1e-10 before
  record.summary.start_loss = -1;
  record.summary.loss = record.summary.best_loss = -5;
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 100"), "100 %");
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 10"), "0 %");
}

// One of two seeds gets there, after 60 of 102 spent in all by each... the other spends its 20.
TEST(Tables, ExpectedRunningTimeCountsWhatFailedRunsSpent) {
  const Table table = restart_table(
      Compared({record_of({.seed = 0, .work_per_hit = 2}),
                record_of({.seed = 1, .hits = 10, .work_per_hit = 2, .status = Status::budget})}));
  EXPECT_EQ(at(table, "gd", "square"), "78 (1/2)") << "two runs have no interval";
}

// Work 60, 90 and so on: the range of five runs, of twelve the middle 80 % of simulations.
TEST(Tables, ExpectedRunningTimeHasTheRangeOfFewRunsAndAnIntervalOfSix) {
  const auto text_of = [](std::uint64_t runs) {
    std::vector<Record> records;
    for (std::uint64_t seed = 0; seed < runs; ++seed)
      records.push_back(record_of({.seed = seed, .work_per_hit = 2 + std::int64_t(seed)}));
    return at(restart_table(Compared(std::move(records))), "gd", "square");
  };
  EXPECT_EQ(text_of(5), "120 [60–180] (5/5)");
  EXPECT_EQ(text_of(12), "225 [90–360] (12/12)");
}

// log2 of work is a constant + 2 instance + start, of which a plain design has no table.
TEST(Tables, VariationIsDividedBetweenInstancesAndStarts) {
  std::vector<Record> records;
  for (const std::uint64_t instance : {0U, 1U})
    for (const std::uint64_t start : {0U, 1U}) {
      const std::int64_t work = std::int64_t{2} << (2 * instance + start);
      records.push_back(record_of({.seed = seed_of(instance, start), .work_per_hit = work}));
      records.push_back(record_of({.optimizer = "other",
                                   .seed = seed_of(instance, start),
                                   .hits = instance == start ? 51U : 10U}));
    }
  const Table table = variation_table(Compared(records));
  EXPECT_EQ(at(table, "gd", "instances"), "80 %");  // variances 2 and 1/2
  EXPECT_EQ(at(table, "gd", "starts"), "20 %");
  EXPECT_EQ(at(table, "gd", "deviation"), "1.581");
  EXPECT_EQ(at(table, "other", "left out"), "1");
  EXPECT_TRUE(
      variation_table(Compared({record_of({.seed = 0}), record_of({.seed = 1})})).id.empty());
}

TEST(Tables, NobodyHasTheLargestAreaWhereAllAreZero) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s"})
    for (const char* optimizer : {"a", "b"})
      study.runs.push_back(record_of(
          {.problem = problem, .optimizer = optimizer, .hits = 1, .status = Status::budget}));
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(has(profile_table(c).reading, "No method solves any")) << profile_table(c).reading;
  const Document document = document_of(compare_optimizers(study));
  for (const Plot& plot : document.section("statistics").plots)
    if (plot.id != "plot-runtime") {  // whose first target is the start, which all meet
      EXPECT_FALSE(has(plot.reading, "a and 1 more")) << plot.id << ": " << plot.reading;
    }
}

// Two sizes of one problem are two settings of it: a count of rows says so.
TEST(Tables, CountsOfSettingsAreNotCalledProblems) {
  const Compared c(study_of({{"p[N=8]", "a", 1}, {"p[N=16]", "a", 1}}));
  EXPECT_EQ(at(data_profile_table(c), "a", "n settings"), "2");
  EXPECT_EQ(std::ranges::count(data_profile_table(c).columns, "n problems"), 0);
}

// Loss 10^(−j/5) at the j-th point, 1 at the start; its error in x is that to the power, of a
// solution of norm 1.
Record run_of(const char* problem, const char* optimizer, Real power, std::size_t points = 51) {
  Record record = record_of({.problem = problem, .optimizer = optimizer, .hits = points});
  record.minimum = 0;
  record.scale = record.x_scale = 1;
  for (std::size_t j = 0; j < points; ++j)
    record.curve.x_error[j] = std::pow(record.curve.loss[j], power);
  record.summary.x_error = record.curve.x_error.back();
  return record;
}

Sheet sheet_of(const char* problem, Real condition) {
  Sheet sheet{.kind = "problem", .name = problem, .spec = problem, .options_text = "[]"};
  sheet.unknowns = 2;
  sheet.condition = condition;
  return sheet;
}

// With n = 2, 10 (n + 1) are 30 forward solves; work to 1e-5 and 1e-7 is 25 and 35 on p and ten
// times that on q; r reaches neither.
TEST(Tables, TheProfileOfMoreAndWildCountsMultiplesOfTheUnknowns) {
  Study study = study_of({{"p", "a", 1}, {"q", "a", 10}, {"r", "a", 0}});
  for (const char* problem : {"p", "q", "r"}) study.sheets.push_back(sheet_of(problem, 1));
  const Table table = simplex_profile_table(Compared(study));
  for (const auto& [column, share] : std::map<std::string, std::string>{{"1e-5, 10", "33 %"},
                                                                        {"1e-5, 100", "67 %"},
                                                                        {"1e-7, 10", "0 %"},
                                                                        {"1e-7, 100", "33 %"},
                                                                        {"1e-7, 1000", "67 %"},
                                                                        {"n problems", "3"}})
    EXPECT_EQ(at(table, "a", column), share) << column;
  study.sheets.pop_back();
  EXPECT_TRUE(simplex_profile_table(Compared(study)).id.empty()) << "the size of r is unknown";
}

// On p all but x are found: its error falls as the loss to the power 1/20. On q both are.
Study both_kinds() {
  return {.runs = {run_of("p", "gd", 0.05), run_of("q", "gd", 1), run_of("p", "newton", 0.05, 11),
                   run_of("q", "newton", 0.5, 35)},
          .sheets = {sheet_of("p", 3e7), sheet_of("q", std::numeric_limits<Real>::infinity())}};
}

TEST(LossWithoutX, IsCountedByMethodWithTheConditionNumberBeside) {
  const Table table = loss_without_x_table(Compared(both_kinds()));
  EXPECT_EQ(at(table, "gd", "n settings"), "2");
  EXPECT_EQ(at(table, "gd", "loss"), "2");
  EXPECT_EQ(at(table, "gd", "x"), "1");
  EXPECT_EQ(at(table, "gd", "loss, not x"), "1");
  EXPECT_EQ(at(table, "gd", "x not near"), "1");
  EXPECT_EQ(at(table, "gd", "worst conditioned"), "p (3e7)");
  // Its loss is not reached on p; on q its x is near, to 1e-3, and not found to 1e-6.
  EXPECT_EQ(at(table, "newton", "loss"), "1");
  EXPECT_EQ(at(table, "newton", "loss, not x"), "1");
  EXPECT_EQ(at(table, "newton", "x not near"), "0");
  EXPECT_EQ(at(table, "newton", "worst conditioned"), "q (singular)");
  EXPECT_TRUE(has(table.reading, " 3 reach a loss of 1e-6")) << table.reading;
}

TEST(LossWithoutX, SaysWhereNeitherCanBeTold) {
  const Table table = loss_without_x_table(Compared({record_of({})}));  // no solution is known
  EXPECT_TRUE(table.rows.empty());
  EXPECT_EQ(table.reading, words("loss-without-x.none"));
  Study study = both_kinds();
  for (Record& record : study.runs) record.request.problem.options.set("goal", std::string("fit"));
  EXPECT_TRUE(loss_without_x_table(Compared(study)).rows.empty()) << "distances from the fit";
  const std::string all_found = loss_without_x_table(Compared({run_of("q", "gd", 1)})).reading;
  EXPECT_TRUE(all_found.ends_with("x of 1e-6.")) << all_found;
}

TEST(LossWithoutX, CountsNothingAgainstALossThatARunUndercuts) {
  Record record = run_of("p", "gd", 0.05);
  record.summary.best_loss = -0.5;
  EXPECT_EQ(Compared({record}).runs[0].loss_met, 0U);
}

// Equivalent forward solves: counts at measured prices, and what does not depend on prices.

Sheet priced(const std::string& spec, Real pullback) {
  Sheet sheet{.kind = "problem", .name = "square", .spec = spec, .options_text = "[]"};
  sheet.prices = MeasuredPrices{"b", "processor", 1e-6, {}};
  sheet.prices->oracles = {{"forward", 1, 1, 1, 1, 31, 620},
                           {"pullback", 1, pullback, pullback, pullback, 31, 620}};
  return sheet;
}

// Forward solves and pullbacks in equal parts: of 2 j work, j each.
Record counted() {
  Record record = record_of({.work_per_hit = 2});
  record.prices[0] = record.prices[1] = 1;
  for (std::size_t j = 0; j < 51; ++j)
    for (const char* oracle : {"forward", "pullback"}) {
      record.curve.counts[oracle].push_back(static_cast<std::int64_t>(j));
      record.hits->counts[oracle].push_back(static_cast<std::int64_t>(j));
    }
  record.counts[0] = record.counts[1] = 51;
  return record;
}

TEST(Costs, AreRawCountsAtMeasuredPrices) {
  const Sheet sheet = priced("square", 2.5);
  const Prices prices(&sheet);
  EXPECT_EQ(prices.cost(counted()), 51 * 3.5);
  EXPECT_EQ(prices.hit_costs(counted(), *counted().hits)[30], 30 * 3.5);
  EXPECT_EQ(prices.curve_costs(counted())[10], 10 * 3.5);
  EXPECT_EQ(counts_at(counted(), 60)[1], 30);
}

TEST(Costs, OfAnOracleThatWasNotMeasuredAreAtItsDeclaredPrice) {
  Record record = counted();
  record.counts[3] = 2;  // Jacobians
  record.prices[3] = 7;
  const Sheet sheet = priced("square", 2.5);
  EXPECT_EQ(Prices(&sheet).cost(record), 51 * 3.5 + 2 * 7);
}

// A pullback of half a forward solve of one microsecond is half a microsecond, and one of 0 is
// nothing that was ever called.
TEST(Costs, OfCallsBelowAMicrosecondAreAtTheirDeclaredPrices) {
  for (const Real pullback : {0.0, 0.5}) {
    const Sheet sheet = priced("square", pullback);
    EXPECT_EQ(Prices(&sheet).cost(counted()), 51 * 2) << pullback;
    EXPECT_TRUE(Prices(&sheet).is_measured("forward"));
    EXPECT_FALSE(Prices(&sheet).is_measured("pullback"));
  }
}

// All prices are in units of a forward solve. Where it is too short to be measured, no price is
// used.
TEST(Costs, InForwardSolvesBelowAMicrosecondAreDeclaredThroughout) {
  Sheet sheet = priced("square", 40);
  sheet.prices->forward_seconds = 0.5e-6;
  EXPECT_FALSE(Prices(&sheet).are_measured());
  EXPECT_EQ(Prices(&sheet).cost(counted()), Real(counted().summary.work));
}

TEST(Costs, WithoutMeasuredPricesAreTheDeclaredWork) {
  EXPECT_EQ(Prices(nullptr).hit_costs(counted(), *counted().hits)[30], 60);
  EXPECT_EQ(Prices(nullptr).cost(counted()), Real(counted().summary.work));
  const Compared c({counted()});
  EXPECT_EQ(c.cell(0, 0).taken[Measure::cost][kTightest].median, 60);
  EXPECT_TRUE(has(cost_unit(c), "nominal"));
  EXPECT_TRUE(prices_table(c).rows.empty());
}

TEST(Costs, AreNotAtThePricesOfOtherSettings) {
  for (const auto& [spec, cost] : {std::pair{"square[n=9]", 60.0}, {"square", 30 * 3.5}}) {
    const Compared c(Study{.runs = {counted()}, .sheets = {priced(spec, 2.5)}});
    EXPECT_EQ(c.cell(0, 0).taken[Measure::cost][kTightest].median, cost) << spec;
  }
}

// 30 forward solves and 30 pullbacks at 2.5: 105.
TEST(Costs, StandBesideTheRawCounts) {
  const Compared c(Study{.runs = {counted()}, .sheets = {priced("square", 2.5)}});
  const Table table = calls_table(c);
  EXPECT_EQ(at(table, "gd", "pullback"), "30");
  for (const char* part : {" 60 forward solves", " 105 "})
    EXPECT_TRUE(has(table.reading, part)) << table.reading;
  EXPECT_TRUE(has(prices_table(c).rows[0].back().text, "1 : 2.5 [2.5–2.5]"));
  const Json cell = parse_json(json_report(document_of(c)), "report.json").at("cells")[0];
  EXPECT_EQ(cell.at("costs").at("1e-6").at("median"), 105);
  EXPECT_EQ(cell.at("calls").at("pullback"), Json::array({30}));
}

// Pullbacks at 40 forward solves turn the order of two methods round.
TEST(Costs, TellWhetherTheFirstIsTheSameAtMeasuredPrices) {
  for (const auto& [pullback, is_kept] : {std::pair(1.1, true), std::pair(40.0, false)}) {
    Study study;
    for (const char* problem : {"p", "q", "r", "s", "t"}) {
      for (const bool is_first : {true, false}) {
        Record& record = study.runs.emplace_back(record_of({.problem = problem,
                                                            .optimizer = is_first ? "a" : "b",
                                                            .work_per_hit = is_first ? 2 : 3}));
        record.prices[0] = record.prices[1] = 1;
        for (std::int64_t j = 0; j < 51; ++j) {
          record.hits->counts["forward"].push_back(is_first ? j : 3 * j);
          record.hits->counts["pullback"].push_back(is_first ? j : 0);
        }
      }
      study.sheets.push_back(priced(problem, pullback));
      study.sheets.back().name = problem;
      study.sheets.back().prices->forward_seconds = 1e-5;
    }
    const Compared c(std::move(study));
    const auto cost = std::ranges::find(c.decision->choices, "cost", &Choice::value);
    ASSERT_NE(cost, c.decision->choices.end());
    EXPECT_EQ(cost->is_kept, is_kept) << pullback;
    EXPECT_EQ(c.optimizers[cost->first.at(0)].label, is_kept ? "a" : "b");
  }
}

// Training once compared with a solve of each instance, from records made by hand.

Record asked(const std::string& problem, const std::string& optimizer, std::uint64_t seed,
             const OptionValues& options) {
  Record record = record_of({.problem = problem, .optimizer = optimizer, .seed = seed});
  record.request.problem.options = options;
  record.request.problem.is_learned = asks_to_learn(options);
  record.cell = cell_digest(record.request);
  return record;
}

constexpr const char* kLearned = "flow[mode=learn]";

// Ends at that error in x, after so many seconds.
Record trained(std::uint64_t seed, Real x_error, Real seconds, const std::string& by = "sip") {
  Record record =
      asked(kLearned, by, seed, {{"N", Index{8}}, {"mode", "learn"}, {"batch", Index{4}}});
  record.summary.x_error = x_error;
  record.summary.processor_seconds = seconds;
  return record;
}

// Errors 10, 1, 0.1 after 0, 1 and 2 times so many seconds.
Record single(const std::string& solver, std::uint64_t seed, Real seconds,
              const OptionValues& options = {{"N", Index{8}}, {"mode", "direct"}}) {
  Record record = asked(options.number("N", 0) == 8 ? "flow" : "flow[N=9]", solver, seed, options);
  record.curve = {};
  record.curve.iteration = {0, 1, 2};
  record.curve.x_error = {10, 1, 0.1};
  record.curve.processor_seconds = {0, seconds, 2 * seconds};
  return record;
}

// The network takes a sixteenth of a forward solve of 2⁻⁶ s: about a millisecond an example.
Sheet timed() {
  Sheet sheet{.kind = "problem", .name = "flow", .spec = kLearned, .options_text = "[]"};
  sheet.prices = MeasuredPrices{"b", "processor", 0x1p-6, {}};
  sheet.prices->oracles = {{"forward", 1, 1, 1, 1, 31, 620},
                           {kInference, 0, 0x1p-4, 0x1p-4, 0x1p-4, 3, 9}};
  return sheet;
}

struct Shown {
  Study study;
  Section section;

  explicit Shown(std::vector<Record> runs, std::vector<Sheet> sheets = {timed()}) {
    study.runs = std::move(runs);
    study.sheets = std::move(sheets);
    section = amortized_section(compare_optimizers(study));
  }
  const TableCell& cell(std::size_t row, const std::string& column) const {
    const Table& table = section.tables.at(0);
    const auto at = std::ranges::find_if(
        table.columns, [&](const std::string& name) { return name.starts_with(column); });
    return table.rows.at(row).at(static_cast<std::size_t>(at - table.columns.begin()));
  }
  std::string text(std::size_t row, const std::string& column) const {
    return cell(row, column).text;
  }
  Real number(std::size_t row, const std::string& column) const {
    const auto& numbers = cell(row, column).numbers;
    return numbers.empty() ? NAN : numbers[0].second;
  }
};

constexpr const char* kSolved = "solver to that error";

// 300·2⁻⁶ s of training and 2⁻¹⁰ s each, against 2⁻⁶ s more than that.
TEST(Amortized, TrainingPaysFromSoManyInstancesAsItsTimeHoldsSavings) {
  const Shown shown({trained(0, 1, 300 * 0x1p-6), single("newton", 0, 0x1p-6 + 0x1p-10)});
  ASSERT_EQ(shown.section.tables.size(), 1U);
  EXPECT_EQ(shown.number(0, "training, s"), 300 * 0x1p-6);
  EXPECT_EQ(shown.number(0, "ms per example"), 0x1p-10);
  EXPECT_EQ(shown.number(0, kSolved), 0x1p-6 + 0x1p-10);
  EXPECT_EQ(shown.number(0, "break-even"), 300);
  EXPECT_TRUE(has(shown.section.tables[0].reading, "from 300 instances"));
}

TEST(Amortized, SolversAreTimedToTheErrorOfEachNetwork) {
  const Shown shown({trained(0, 1, 3), trained(0, 0.5, 3, "adam"), single("newton", 0, 2)});
  EXPECT_EQ(shown.text(0, "network of"), "adam") << "the nearer one first";
  EXPECT_EQ(shown.number(0, kSolved), 4) << "0.1 is the first kept error below 0.5";
  EXPECT_EQ(shown.number(1, kSolved), 2);
}

// Two of three instances get there, one of them late: the median is what it takes.
TEST(Amortized, InstancesThatNeverGetThereStayInTheMedian) {
  Record lost = single("gd", 2, 1), late = single("gd", 1, 50);
  lost.curve.x_error = {10, 9, 8};
  const Shown some({trained(0, 1, 3), single("gd", 0, 1), late, lost});
  EXPECT_EQ(some.number(0, kSolved), 50);
  EXPECT_EQ(some.text(0, "solver runs"), "2/3");
  late.curve.x_error = lost.curve.x_error;
  const Shown none({trained(0, 1, 3), single("gd", 0, 1), late, lost});
  EXPECT_EQ(none.text(0, kSolved), "✗");
  EXPECT_EQ(none.text(0, "break-even"), words("amortized-table.open"));
  Record crashed = single("gd", 2, 1);
  crashed.status = Status::crashed;
  const Shown failed({trained(0, 1, 3), single("gd", 0, 1), single("gd", 1, 1), crashed});
  EXPECT_EQ(failed.text(0, "solver runs"), "2/3");
  EXPECT_EQ(failed.text(0, "failed"), "0, 1");
}

TEST(Amortized, ANetworkNoNearerThanWhereSolversStartIsSaidToBe) {
  const Shown shown({trained(0, 11, 3), single("newton", 0, 2)});
  EXPECT_EQ(shown.number(0, kSolved), 0);
  EXPECT_EQ(shown.text(0, "break-even"), "never");
  EXPECT_TRUE(has(shown.section.tables[0].reading, "error of newton is"))
      << shown.section.tables[0].reading;
}

TEST(Amortized, TimesThatWereNotMeasuredAreAbsent) {
  const Shown shown({trained(0, 1, 3), single("newton", 0, 0.011)}, {});
  EXPECT_EQ(shown.text(0, "ms per example"), "");
  EXPECT_EQ(shown.text(0, "break-even"), "");
  EXPECT_EQ(shown.number(0, "training, s"), 3);
}

// What is not the same physics is no instance of what was learned.
TEST(Amortized, InstancesHaveTheOptionsOfWhatWasLearned) {
  const OptionValues other{{"N", Index{9}}, {"mode", "direct"}};
  EXPECT_TRUE(Shown({trained(0, 1, 3), single("gd", 0, 1, other)}).section.is_empty());
  EXPECT_TRUE(Shown({trained(0, 1, 3)}).section.is_empty());
  EXPECT_TRUE(Shown({single("gd", 0, 1)}).section.is_empty());
}

// The audit: the same table in every format, and reports without it.

PowerLaw law(Real exponent, Real residual) {
  return {.values = {1, 2, 3}, .exponent = exponent, .residual = residual};
}

AuditedOptimizer sample() {
  AuditedOptimizer audited{.name = "gd", .spec = "gd"};
  for (ScalingLaw& scaling : audited.scalings)
    scaling = {{0.1, 1, 10}, law(1, 1e-15), law(2, 1e-15)};
  audited.scalings[1] = {{0.1, 1, 10}, law(1.3, 0.4), law(1.3, 0.4)};
  audited.scalings[3] = {};
  audited.deviations = {1e-15, 0.25, std::numeric_limits<Real>::infinity(), 0, 0, kUnknown};
  audited.regular = {2.04, 0.01, 1e-16, 4, true};
  audited.singular = {kUnknown, kUnknown, 0.5, 1000, false};
  audited.linear_angle = 2.75;
  audited.counted = {{"forward", 10}, {"pullback", 10}};
  audited.iterations = 10;
  audited.flags = {"declares <b>|x|"};
  return audited;
}

std::vector<AuditedOptimizer> samples() {
  return {sample(), {.name = "kfac", .spec = "kfac", .reason = "there is no network"}};
}

// What stands in the columns of the table, its name left out.
std::vector<std::string> cells_of(const AuditedOptimizer& audited) {
  std::vector<std::string> texts;
  const Section section = properties_section({audited});
  for (const TableCell& cell : section.tables.at(0).rows.at(0)) texts.push_back(cell.text);
  texts.erase(texts.begin());
  return texts;
}

TEST(AuditTable, SaysWhatWasMeasured) {
  const std::vector<std::string> expected = {"1 / 2",           "no power law",
                                             "1 / 2",           "no step",
                                             "kept, 0.25, inf", "kept, kept, no step",
                                             "2.0 in 4",        "no order, 0.5 left of 1000",
                                             "2.8°, no step",   "forward 10, pullback 10 in 10",
                                             "declares <b>|x|"};
  EXPECT_EQ(cells_of(sample()), expected);
}

TEST(AuditTable, IsInEveryFormatAndForeignTextIsHarmless) {
  Study study;
  study.audits = samples();
  const Document document = document_of(compare_optimizers(study));
  const std::string html = section_html(document.section("audit")),
                    markdown = markdown_report(document);
  for (const std::string& text : {html, markdown, terminal_section(document.section("audit"))}) {
    EXPECT_TRUE(has(text, "no power law"));
    EXPECT_TRUE(has(text, "there is no network"));
  }
  const std::string latex = latex_report(document);
  for (const char* part : {"no power law", "kept, 0.25", "2.0 in 4", "2.8", "pullback 10 in 10"})
    EXPECT_TRUE(has(latex, part)) << part;
  EXPECT_FALSE(has(html, "<b>|x|"));
  EXPECT_FALSE(has(markdown, "<b>|x|"));
}

TEST(ConductTable, HasMarksFiguresAndAdviceInEveryFormat) {
  Study study;
  study.audits = samples();
  EXPECT_TRUE(conduct_section(study.audits).is_empty());
  study.audits[0].conduct = {
      {.column = "own counter", .holds = true, .figures = "7 of 7", .records = {"a-b.json"}},
      {.column = "outside the bounds", .holds = false, .figures = "3 of 9 <b>|x|", .records = {}},
      {.column = "loose bound", .holds = {}, .figures = "no bounds", .records = {}}};
  EXPECT_EQ(audit_to_json(audit_from_text(audit_to_json(study.audits).dump(), "it")),
            audit_to_json(study.audits));
  const Document document = document_of(compare_optimizers(study));
  const Section& section = document.section("conduct");
  ASSERT_EQ(section.tables.size(), 2U);
  EXPECT_EQ(section.tables[0].rows.size(), 3U);
  EXPECT_EQ(section.tables[0].rows[1][4].text, "0, 1, 0");
  EXPECT_EQ(section.tables[1].rows.size(), 1U);  // kfac was not measured
  EXPECT_EQ(section.tables[1].columns.size(), section.tables[1].meanings.size());
  const std::string html = section_html(section), markdown = markdown_report(document),
                    csv = statistics_csv(document);
  for (const std::string& text : {html, markdown, csv, terminal_section(section)}) {
    EXPECT_TRUE(has(text, "✓ 7 of 7"));
    EXPECT_TRUE(has(text, "✗ 3 of 9"));
    EXPECT_TRUE(has(text, "– no bounds"));
  }
  EXPECT_TRUE(has(html, "a-b.json"));
  EXPECT_TRUE(has(html, conduct_text("outside the bounds", "advice")));
  EXPECT_FALSE(has(html, "<b>|x|"));
}

TEST(AuditTable, SaysWhatDoesNotApplyToWhatTeachesANetwork) {
  AuditedOptimizer teacher = sample();
  teacher.network = "mlp";
  teacher.scalings[2] = {};
  teacher.deviations[0] = kUnknown;
  for (const std::size_t column : {2, 3, 4, 6, 7, 8})
    EXPECT_EQ(cells_of(teacher)[column], "does not apply") << column;
  EXPECT_EQ(cells_of(teacher)[0], "1 / 2");
  EXPECT_TRUE(has(property_readings({teacher}).back().text, "gd train a network"));
}

TEST(AuditTable, TellsThePageWhichMethodARowIsAbout) {
  AuditedOptimizer sip = sample();
  sip.name = "sip";
  const std::string html = section_html(properties_section({sample(), sip}));
  for (const char* row : {"<tr data-method=\"gd\">", "<tr data-method=\"sip\">"})
    EXPECT_TRUE(has(html, row)) << row;
}

// A column in which no row has an entry tells a reader nothing.
TEST(AuditTable, HasNoColumnOfContradictionsWhereThereIsNone) {
  AuditedOptimizer honest = sample();
  honest.flags.clear();
  const Table with = properties_section({sample(), honest}).tables.at(0),
              without = properties_section({honest}).tables.at(0);
  EXPECT_EQ(without.columns.size(), with.columns.size() - 1);
  EXPECT_EQ(without.rows.at(0).size(), without.columns.size());
  EXPECT_FALSE(has(terminal_section(properties_section({honest})), with.columns.back()));
}

TEST(AuditTable, IsReadForANewcomer) {
  const std::vector<Reading> readings = property_readings(samples());
  ASSERT_EQ(readings.size(), 6U);
  EXPECT_TRUE(has(readings[0].text, " needed: gd"));
  EXPECT_TRUE(has(readings[0].text, "L is zero."));
  EXPECT_TRUE(has(readings[2].text, "(order 2): gd"));
  EXPECT_TRUE(has(readings.back().text, "gd declares"));
}

TEST(AuditFile, IsReadWithTheStudyAndReportsDoWithoutIt) {
  const ResultFolder with, without, broken;
  for (const ResultFolder* folder : {&with, &without, &broken}) folder->add(record_of({}));
  with.add_file("audit.json", audit_to_json(samples()).dump());
  broken.add_file("audit.json", "{\"schema\": \"isoline.audit/1\"}");
  const Study study = read_study({without.path(), with.path()}),
              bare = read_study({without.path()}), bad = read_study({broken.path()});
  EXPECT_EQ(study.audits.size(), 2U);
  const Json audit =
      parse_json(json_report(document_of(compare_optimizers(study))), "report").at("audit");
  EXPECT_EQ(audit.at("readings").size(), 6U);
  EXPECT_EQ(audit.at("optimizers"), audit_to_json(samples()).at("optimizers"));
  EXPECT_TRUE(has(markdown_report(document_of(compare_optimizers(study))), "Measured properties"));
  EXPECT_FALSE(has(markdown_report(document_of(compare_optimizers(bare))), "Measured properties"));
  EXPECT_TRUE(has(readable_html(document_of(compare_optimizers(bare))), "no audit of"));
  ASSERT_EQ(bad.unreadable.size(), 1U);
  EXPECT_TRUE(bad.unreadable[0].file.ends_with("/audit.json"));
}

}  // namespace
}  // namespace isoline::reports
