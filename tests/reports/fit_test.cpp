// The fit of a user's own problem, and when its standard deviations are shown.
#include <gtest/gtest.h>

#include <cmath>

#include "core/results/uncertainty.h"
#include "reports/sections/answers.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// y = k x at x = 1, 2, …, 5 with σ = 0.1, two unknowns of which c is held at its lower bound.
Record fit_of(const std::string& optimizer, Real loss) {
  Record record = record_of({.optimizer = optimizer.c_str(), .hits = 6});
  record.foreign.problem = Foreign{.door = "process", .command = "mine", .label = "line"};
  record.status = Status::converged;
  record.minimum.reset();
  record.scale.reset();
  record.hits.reset();
  record.summary.loss = record.summary.best_loss = loss;
  record.summary.start_loss = 100;
  record.curve.loss.assign(record.curve.loss.size(), 100);
  record.curve.loss.back() = loss;
  record.answer = AnswerPoints{.unknowns = 2,
                               .names = {"k", "c"},
                               .units = {"N/m", ""},
                               .points = {kReturned},
                               .x = {{2.0, 0.0}},
                               .at_lower = {1},
                               .residual_norm = std::sqrt(2 * loss)};
  record.fit = FitData{
      .target = {2, 4, 6, 8, 10}, .y = {2.1, 4, 6, 8, 9.9}, .sigma = std::vector<Real>(5, 0.1)};
  record.uncertainty = Uncertainty{.x = {2.0, 0.0},
                                   .standard_deviation = {0.01, NAN},
                                   .correlation = {{1, NAN}, {NAN, 1}},
                                   .variance = loss / 2,
                                   .degrees_of_freedom = 4,
                                   .condition = 1};
  return record;
}

const Table& table_of(const Section& section, const std::string& start) {
  for (const Table& table : section.tables)
    if (table.id.starts_with(start)) return table;
  throw std::runtime_error(start + " is missing");
}

TEST(Fit, IsTheFirstSectionAndHasIntervalsAndBasins) {
  Record other = fit_of("b", 3);
  other.answer->x = {{9, 0}};
  other.uncertainty->x = {9, 0};
  const Compared c({fit_of("a", 2), other});
  const Document document = document_of(c);
  ASSERT_EQ(document.sections[0].id, "fit");
  const Section& fit = document.sections[0];
  const Table& parameters = table_of(fit, "fit-parameters");
  ASSERT_EQ(parameters.rows.size(), 2U);
  const auto& numbers = parameters.rows[0][3].numbers;
  ASSERT_EQ(numbers.size(), 1U);
  EXPECT_NEAR(numbers[0].second, 2.7764451 * 0.01, 1e-8);  // t of 4 degrees of freedom
  EXPECT_TRUE(has(parameters.rows[1].back().text, "lower"));
  EXPECT_EQ(table_of(fit, "fit-basins").rows.size(), 2U);
  EXPECT_EQ(fit.plots.size(), 3U);
  EXPECT_EQ(fit.plots[0].series[0].low.size(), 5U);
  // the least loss of the records counts
  EXPECT_FALSE(c.problems[0].lacks_least_loss());
  EXPECT_LT(c.taken(c.runs[0], Measure::work, 0), kNever);
}

// A run whose last step is worse than one before, as the digits of a program can have it.
TEST(Fit, IsSolvedAtTheLeastLossThatARunReturned) {
  Record record = fit_of("a", 2.001);
  record.summary.best_loss = 2;
  const Compared c({record});
  EXPECT_LT(c.taken(c.runs[0], Measure::work, kTightest), kNever);
  for (const Reading& each : document_of(c).section("standings").readings)
    EXPECT_NE(each.text, words("ranking.none-near", tau_name(c)));
}

TEST(Fit, HasTheProfilesOfItsCellAndNoOthers) {
  Compared c({fit_of("a", 2)});
  const std::string cell = c.runs[0].record->cell;
  // twice as steep above the fit as below
  c.owned.profiles = {
      {"0000000000000000", {{.name = "k", .low = 0, .high = 9}}},
      {cell,
       {{.name = "k", .low = 1.97, .high = 2.015, .value = {1.98, 2, 2.01}, .rise = {4, 0, 4}}}}};
  const Document document = document_of(c);
  const Section& fit = document.sections[0];
  const Table& profiles = table_of(fit, "fit-profiles");
  ASSERT_EQ(profiles.rows.size(), 1U);
  EXPECT_EQ(profiles.rows[0][1].text, "1.97 … 2.015");
  ASSERT_EQ(fit.plots.size(), 4U);
  const PlotSeries& line = fit.plots[2].series.at(0);
  ASSERT_EQ(line.x.size(), 3U);
  EXPECT_NEAR(line.x[0], -2, 1e-9);
  EXPECT_EQ(line.y, (std::vector<Real>{-2, 0, 2}));
}

TEST(Fit, IsAbsentWithoutAProblemOfOnesOwn) {
  const Compared c({record_of({.optimizer = "a", .hits = 6})});
  EXPECT_NE(document_of(c).sections[0].id, "fit");
}

TEST(Fit, HasNoUncertaintyWhereTheStatusOrTheNoiseContradictIt) {
  Record record = fit_of("a", 2);
  EXPECT_EQ(doubt_of(record), Doubt::none);
  EXPECT_EQ(answer_columns(record, *record.answer, "{}").size(), 6U);
  record.status = Status::unconfirmed;
  EXPECT_EQ(doubt_of(record), Doubt::not_minimum);
  EXPECT_EQ(answer_columns(record, *record.answer, "{}").size(), 4U);
  Record wrong = fit_of("a", 20);  // χ² = 40 with 4 degrees of freedom
  EXPECT_EQ(doubt_of(wrong), Doubt::contradicted);
  EXPECT_TRUE(has(doubt_text(wrong), "χ² = 40"));
  wrong.fit->sigma.clear();
  EXPECT_EQ(doubt_of(wrong), Doubt::none);
  wrong.noise_level = 0.1;
  EXPECT_EQ(doubt_of(wrong), Doubt::contradicted);
}

TEST(Fit, IntervalsOfLogarithmsArePositive) {
  Record record = fit_of("a", 2);
  record.uncertainty->standard_deviation[0] = 2;
  EXPECT_LT(intervals_of(record)[0].low, 0);
  record.request.problem.options.set("log", std::string("c; k"));
  const XInterval interval = intervals_of(record)[0];
  EXPECT_GT(interval.low, 0);
  EXPECT_NEAR(interval.low * interval.high, 4, 1e-12);
}

// Tables of Abramowitz and Stegun (1964), 26.8.
TEST(ChiSquare, TailHasTheTabulatedValues) {
  EXPECT_NEAR(chi_square_tail(18.3070, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_tail(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_tail(20.5150, 5), 0.001, 1e-6);
}

}  // namespace
}  // namespace isoline::reports
