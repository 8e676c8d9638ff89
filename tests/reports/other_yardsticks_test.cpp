// Reports at other tolerances, and at equal time, cost or iterations: all of them follow.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/schema.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
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

TEST(OtherYardsticks, TheOrderIsOfWhatIsCounted) {
  const Study study = crossed();
  EXPECT_EQ(compare_optimizers(study).optimizers[0].label, "a");
  for (const Measure by : {Measure::iterations, Measure::time}) {
    const Comparison c = compare_optimizers(study, yardstick_at(by, 1e-6));
    EXPECT_EQ(c.optimizers[0].label, "b") << name_of(by);
    EXPECT_EQ(c.profiles[kTightest].share(0, 1), 1) << name_of(by);
  }
}

// To 1e-4, the 20th target, b takes 8 · 20 = 160 forward solves and 1.6 ms.
TEST(OtherYardsticks, EveryFormatTellsItsMeasureAndItsTolerance) {
  const Study study = crossed();
  const Document work = document_of(compare_optimizers(study, yardstick_at(Measure::work, 1e-4)));
  const Document time = document_of(compare_optimizers(study, yardstick_at(Measure::time, 1e-4)));
  for (const auto text : {html_report, markdown_report, latex_report, terminal_table}) {
    EXPECT_TRUE(has(text(work), "1e-4"));
    EXPECT_TRUE(has(text(work), "160"));
    EXPECT_FALSE(has(text(work), "wall time to"));
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
  const std::string page =
      html_report(document_of(compare_optimizers(study, yardstick_at(Measure::iterations, 1e-4))));
  EXPECT_TRUE(has(page, "\"by\":\"iterations\"")) << "what its scripts count";
  EXPECT_TRUE(has(page, "\"rungs\":[5,15,20]"));
  EXPECT_TRUE(has(page, "<output id=\"tau\">1e-4</output>"));
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

// Pullbacks at 40 forward solves turn the order of two methods round.
Study priced_study(Real pullback) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s", "t"}) {
    for (const char* optimizer : {"a", "b"}) {
      const bool is_first = optimizer[0] == 'a';
      Record record =
          record_of({.problem = problem, .optimizer = optimizer, .work_per_hit = is_first ? 2 : 3});
      record.prices[0] = record.prices[1] = 1;
      for (std::int64_t j = 0; j < 51; ++j) {
        record.hits->counts["forward"].push_back(is_first ? j : 3 * j);
        record.hits->counts["pullback"].push_back(is_first ? j : 0);
      }
      study.runs.push_back(record);
    }
    Sheet sheet{.kind = "problem", .name = problem, .spec = problem, .options_text = "[]"};
    sheet.prices = MeasuredPrices{"b", "processor", 1e-5, {}};
    sheet.prices->oracles = {{"forward", 1, 1, 1, 1, 31, 620},
                             {"pullback", 1, pullback, pullback, pullback, 31, 620}};
    study.sheets.push_back(sheet);
  }
  return study;
}

TEST(BothPrices, TheDecisionSaysWhetherTheFirstIsTheSameAtMeasuredPrices) {
  for (const auto& [pullback, is_kept] : {std::pair(1.1, true), std::pair(40.0, false)}) {
    const Study study = priced_study(pullback);
    const Comparison c = compare_optimizers(study);
    const auto& choices = c.decision->choices;
    const auto cost = std::ranges::find(choices, "cost", &Choice::value);
    ASSERT_NE(cost, choices.end());
    EXPECT_EQ(cost->is_kept, is_kept) << pullback;
    EXPECT_EQ(c.optimizers[cost->first.at(0)].label, is_kept ? "a" : "b");
  }
}

}  // namespace
}  // namespace isoline::reports
