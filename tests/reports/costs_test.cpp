// Equivalent forward solves: raw counts at measured prices, and what does not depend on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/results/study.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

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
  EXPECT_EQ(prices.hit_costs(counted())[30], 30 * 3.5);
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

// All prices are told in forward solves: where these are too short to be told, none is.
TEST(Costs, InForwardSolvesBelowAMicrosecondAreDeclaredThroughout) {
  Sheet sheet = priced("square", 40);
  sheet.prices->forward_seconds = 0.5e-6;
  EXPECT_FALSE(Prices(&sheet).are_measured());
  EXPECT_EQ(Prices(&sheet).cost(counted()), Real(counted().summary.work));
}

TEST(Costs, WithoutMeasuredPricesAreTheDeclaredWork) {
  EXPECT_EQ(Prices(nullptr).hit_costs(counted())[30], 60);
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
  EXPECT_TRUE(has(table.reading, "60 forward solves at nominal cost, 105 in")) << table.reading;
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

}  // namespace
}  // namespace isoline::reports
