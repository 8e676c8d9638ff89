// Tables and the plot of settings with noise and other features, beside the same settings without;
// the chooser's answers for noise and bounds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/results/advice.h"
#include "core/results/statistics.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Of a problem with N = 8 and a further option.
Record run_with(const char* problem, const std::string& option, const char* optimizer,
                std::int64_t work_per_hit) {
  const std::string spec = option.empty() ? problem : fmt::format("{}[{}]", problem, option);
  Record record =
      record_of({.problem = spec, .optimizer = optimizer, .work_per_hit = work_per_hit});
  OptionValues& options = record.request.problem.options;
  options = OptionValues{{"N", Index{8}}};
  const std::size_t at = option.find('=');
  for (const char* share : {"noise", "fail"})
    if (option.starts_with(share)) options.set(share, std::stod(option.substr(at + 1)));
  if (option.starts_with("bounds")) {
    options.set("bounds", option.substr(at + 1));
    record.curve.kkt_residual = record.curve.gradient_norm;
  }
  record.cell = cell_digest(record.request);
  return record;
}

// Without noise a is fast and c slow; with noise it is the other way round.
std::vector<Record> reversed() {
  std::vector<Record> all;
  for (const char* problem : {"p", "q", "r"}) {
    const char* methods[] = {"a", "b", "c"};
    for (int i = 0; i < 3; ++i) {
      all.push_back(run_with(problem, "", methods[i], 1 + 2 * i));
      all.push_back(run_with(problem, "noise=0.1", methods[i], 5 - 2 * i));
      all.push_back(run_with(problem, "bounds=active", methods[i], 2 + 4 * i));
    }
  }
  return all;
}

TEST(RankCorrelation, IsOneOfEqualOrdersAndMinusOneOfOppositeOnes) {
  EXPECT_NEAR(rank_correlation({1, 2, 5}, {10, 20, 21}), 1, 1e-15);
  EXPECT_NEAR(rank_correlation({1, 2, 5}, {3, 2, 1}), -1, 1e-15);
  // Ranks 1.5, 1.5, 3, 4 and 1, 2, 3, 4: 4.5 of √(4.5 · 5).
  EXPECT_NEAR(rank_correlation({1, 1, 2, 3}, {1, 2, 3, 4}), std::sqrt(0.9), 1e-15);
  EXPECT_TRUE(std::isnan(rank_correlation({1, 1}, {1, 2})));
}

TEST(FeaturesTable, TellsHowFarTheRankingMoves) {
  const Compared c(reversed());
  const Table table = features_table(c);
  EXPECT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(at(table, "noise=0.1", "settings"), "3");
  EXPECT_EQ(at(table, "noise=0.1", "best method"), "c");
  EXPECT_EQ(at(table, "noise=0.1", "place without"), "3rd");
  EXPECT_EQ(at(table, "noise=0.1", "best without"), "a");
  EXPECT_EQ(at(table, "noise=0.1", "correlation"), "-1");
  EXPECT_EQ(at(table, "bounds=active", "best method"), "a");
  EXPECT_EQ(at(table, "bounds=active", "correlation"), "1");
  EXPECT_TRUE(has(table.reading, "-1.00")) << table.reading;
  EXPECT_TRUE(features_table(Compared(study_of({{"p", "a", 1}, {"q", "a", 1}}))).id.empty());
}

// A run whose error in x is least in the middle: it comes within the noise at the tenth point.
Record noisy(const char* problem, const std::string& option, const char* optimizer, Real factor) {
  Record record = run_with(problem, option, optimizer, 2);
  record.x_scale = 1;
  record.noise_level = 0.1;
  for (std::size_t j = 0; j < record.curve.loss.size(); ++j) {
    record.curve.discrepancy.push_back(j < 10 ? 1 : 0.105);
    record.curve.x_error[j] = factor * (1 + std::abs(static_cast<Real>(j) - 15));
  }
  record.summary.x_error = record.curve.x_error.back();
  return record;
}

TEST(DiscrepancyTable, HasTheErrorAtTheNoiseAndAtTheEndOverTheBest) {
  const Table table = discrepancy_table(Compared({noisy("p", "noise=0.1", "a", 1)}));
  EXPECT_EQ(at(table, "a", "within the noise"), "1");
  EXPECT_EQ(at(table, "a", "work"), "20");
  EXPECT_EQ(at(table, "a", "error at the stop"), "6");
  EXPECT_EQ(at(table, "a", "error at the end"), "36");
  Record strict = noisy("p", "noise=0.1", "a", 1);
  strict.request.budget.discrepancy = 1.01;  // τ of the run itself, which never gets there
  strict.cell = cell_digest(strict.request);
  const Table none = discrepancy_table(Compared({strict}));
  EXPECT_EQ(none.rows[0][2].text, "0");
  EXPECT_EQ(none.reading, words("discrepancy.none"));
  EXPECT_TRUE(discrepancy_table(Compared(reversed())).id.empty()) << "no noise level is known";
  strict.request.problem.options.set("goal", std::string("fit"));
  EXPECT_TRUE(discrepancy_table(Compared({strict})).id.empty()) << "distances from the fit";
}

TEST(NoisePlot, HasTheErrorOverTheNoise) {
  std::vector<Record> runs = {run_with("p", "", "a", 1)};
  for (const auto& [option, factor] : {std::pair("noise=0.01", 0.1), {"noise=0.1", 1.0}}) {
    runs.push_back(noisy("p", option, "a", factor));
    runs.push_back(noisy("p", option, "b", 2 * factor));
  }
  const Plots plots = noise_plot(Compared(runs));
  ASSERT_EQ(plots.size(), 1U);
  ASSERT_EQ(plots[0].series.size(), 2U);
  EXPECT_EQ(plots[0].series[0].name, "a");
  EXPECT_EQ(plots[0].series[0].x, (std::vector<Real>{0.01, 0.1}));
  EXPECT_NEAR(plots[0].series[0].y[0], 0.6, 1e-12);
  EXPECT_NEAR(plots[0].series[0].y[1], 6, 1e-12);
  EXPECT_TRUE(noise_plot(Compared(reversed())).empty()) << "one noise is no sweep";
}

// Errors fall to 10^(−2) after 20 points of two solves each, and no further.
TEST(FixedBudgetTable, HasTheLeastErrorWithinSoManyForwardSolves) {
  std::vector<Record> runs;
  for (const auto& [method, scale] : {std::pair("a", 1.0), {"b", 2.0}})
    for (const char* problem : {"p", "q"}) {
      Record record = record_of({.problem = problem, .optimizer = method, .work_per_hit = 2});
      record.x_scale = scale;
      for (std::size_t j = 0; j < 51; ++j)
        record.curve.x_error[j] = std::max(1e-2, std::pow(10, -static_cast<Real>(j) / 20)) *
                                  (j > 45 ? 10 : 1);  // it grows again at the end
      runs.push_back(record);
    }
  const Table table = fixed_budget_table(Compared(runs));
  EXPECT_EQ(at(table, "a", "50"), figure(std::pow(10, -25.0 / 20)));
  EXPECT_EQ(at(table, "a", "100"), "0.01");
  EXPECT_EQ(at(table, "b", "500"), "0.005");
  EXPECT_EQ(at(table, "b", "n problems"), "2");
}

// Ten situations, each with the method that the runs above show to be first; none where no setting
// is like that.
TEST(Chooser, AnswersByTheNoiseAndTheBoundsOfTheReader) {
  std::vector<Record> runs = reversed();
  for (const char* problem : {"p", "q", "r"}) {
    runs.push_back(run_with(problem, "", "d", 1));
    runs.push_back(run_with(problem, "noise=0.1", "d", 1));
    runs.push_back(run_with(problem, "bounds=active", "d", 1));
    runs.push_back(run_with(problem, "fail=0.1", "b", 1));
  }
  for (Record& record : runs) {  // d alone needs gradients
    record.counts = {};
    record.counts[static_cast<std::size_t>(Oracle::forward)] = 1;
    if (record.request.optimizer.name == "d")
      record.counts[static_cast<std::size_t>(Oracle::pullback)] = 1;
  }
  Study study{.runs = std::move(runs)};
  for (const char* problem : {"p", "q", "r"})
    study.sheets.push_back({.kind = "problem", .name = problem, .spec = problem, .unknowns = 20});
  const Compared c(std::move(study));
  const auto first = [&](const Means& means) -> std::string {
    const Advice advice = advise(c, means);
    return advice.ranked.empty() ? "" : c.optimizers[advice.ranked[0].optimizer].method;
  };
  constexpr auto kGradient = Derivatives::gradient;
  EXPECT_EQ(first({}), "a");
  EXPECT_EQ(first({.noise = 0.1}), "c");
  EXPECT_EQ(first({.noise = 0.04}), "c") << "noise of the same size";
  EXPECT_EQ(first({.noise = 0.001}), "") << "no such setting";
  EXPECT_EQ(first({.has_bounds = true}), "a");
  EXPECT_EQ(first({.noise = 0.1, .has_bounds = true}), "") << "no setting has both";
  EXPECT_EQ(first({.derivatives = kGradient, .noise = 0.1}), "d");
  EXPECT_EQ(first({.derivatives = kGradient, .has_bounds = true}), "d");
  EXPECT_EQ(first({.least_unknowns = 101, .noise = 0.1}), "");
  EXPECT_EQ(first({.budget = 20, .noise = 0.1}), "") << "30 targets of one forward each";
  EXPECT_EQ(first({.budget = 40, .noise = 0.1}), "c");
  EXPECT_EQ(first({.has_failures = true}), "b");
  std::vector<std::string> kinds;
  for (const Means& kind : kinds_of_data(c)) kinds.push_back(means_text(kind));
  ASSERT_EQ(kinds.size(), 4U);
  EXPECT_EQ(kinds[1], means_text({.noise = 0.1}));
  EXPECT_EQ(kinds[2], means_text({.has_bounds = true}));
  EXPECT_EQ(kinds[3], means_text({.has_failures = true}));
  EXPECT_NE(kinds[0], kinds[2]);
}

}  // namespace
}  // namespace isoline::reports
