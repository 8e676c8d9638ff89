// What the page is made of: medians to targets as the tables have them, filters' attributes, size.
#include "reports/page/page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/files.h"
#include "core/json.h"
#include "core/oracle.h"
#include "core/results/study.h"
#include "reports/report.h"
#include "reports/sections/words.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Three seeds, one of which stops at target 20: τ = 1e-4.
Study uneven_study(bool has_hits) {
  Study study;
  for (const std::uint64_t seed : {0, 1, 2}) {
    study.runs.push_back(record_of({.seed = seed,
                                    .hits = seed == 2 ? 21U : 51U,
                                    .work_per_hit = static_cast<std::int64_t>(2 + 2 * seed)}));
    if (!has_hits) study.runs.back().hits.reset();
  }
  return study;
}

TEST(Targets, AgreeWithTheTablesAtEachTolerance) {
  for (const bool has_hits : {true, false}) {
    const Study study = uneven_study(has_hits);
    const Comparison c = compare_optimizers(study);
    const Cell& cell = c.cell(0, 0);
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
      const Spread& work = cell.headline[t];
      const std::size_t hit = kTolerances[t].rung;
      EXPECT_EQ(cell.median(Measure::work, hit), work.median);
      const auto reached = std::ranges::count_if(
          c.runs, [hit](const reports::Run& run) { return run.targets.size() > hit; });
      EXPECT_EQ(static_cast<std::size_t>(reached), work.n - work.unsolved);
    }
  }
}

TEST(Targets, EndWhereTheMedianIsNeverReached) {
  Study study = uneven_study(true);
  study.runs[1].hits->iteration.at(10) = -1;  // two of three runs miss target 21
  study.runs[1].hits->work.at(10) = -1;
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(c.cell(0, 0).medians[0].size(), 21U);
  std::vector<std::size_t> reached;
  for (const reports::Run& run : c.runs) reached.push_back(run.targets.size());
  EXPECT_EQ(reached, (std::vector<std::size_t>{51, 10, 21}));
}

// By these attributes the page hides what is filtered out.
TEST(Page, RowsSectionsAndCellsNameWhatTheyAreAbout) {
  Study study;
  for (const char* problem : {"a", "b"})
    for (const char* optimizer : {"gd", "newton"})
      study.runs.push_back(record_of({.problem = problem, .optimizer = optimizer}));
  const std::string page = html_report(document_of(compare_optimizers(study)));
  for (const char* part : {"<article class=\"problem one\" id=problem-1 data-p=1>",
                           "<article class=\"optimizer one\" id=optimizer-1 data-s=1>",
                           "<tr data-s=1 data-p=1><th scope=row>b", "<g data-s=1", "<tr data-s=1"})
    EXPECT_TRUE(has(page, part)) << part;
}

// Two labels of one method have one colour, and one row of the audit: the page is told, it cuts no
// label.
TEST(Page, IsToldTheMethodOfEachOptimizer) {
  Record tuned = record_of({.optimizer = "gd[rate=0.5]"});
  tuned.request.rates = "learn-tuned.json";
  Study study;
  study.runs = {record_of({.optimizer = "gd[rate=0.1]"}), tuned};
  const std::string page = html_report(document_of(compare_optimizers(study)));
  EXPECT_TRUE(has(page, "gd, tuned"));
  EXPECT_TRUE(has(page, "\"methods\":[\"gd\",\"gd\"]"));
  const std::filesystem::path scripts = ISOLINE_SOURCE_DIR "/reports/page";
  for (const auto& file : std::filesystem::directory_iterator(scripts)) {
    if (file.path().extension() != ".js") continue;
    for (const char* cut : {"split('[", "split(/[[", "indexOf('["})
      EXPECT_FALSE(has(read_text(file.path()), cut)) << file.path();
  }
}

TEST(Page, IsTitledByItsSuitesAndShowsFormulasAsTheyAreWritten) {
  Study study;
  study.runs = {record_of({})};
  study.plan.suites = {"quick"};
  study.sheets = {{.kind = "problem",
                   .name = "square",
                   .spec = "square",
                   .formula = "P(x) = x₁² / ‖x̃‖, Λ^(−κ) < 1",
                   .options_text = "[]"}};
  const std::string page = html_report(document_of(compare_optimizers(study)));
  EXPECT_TRUE(has(page, "<title>quick"));
  EXPECT_TRUE(has(page, "<p class=formula>P(x) = x₁² / ‖x̃‖, Λ^(−κ) &lt; 1</p>"));
}

// A sheet names the least that a method can do with; the page names what its runs asked for.
TEST(Page, NamesTheDerivativesThatRunsCounted) {
  Study study;
  study.runs = {record_of({.problem = "a", .optimizer = "hig"}),
                record_of({.problem = "b", .optimizer = "hig"})};
  for (Record& record : study.runs) record.counts = {};
  for (Record& record : study.runs) record.counts[static_cast<std::size_t>(Oracle::forward)] = 11;
  study.runs[1].counts[static_cast<std::size_t>(Oracle::jacobian)] = 11;
  EXPECT_EQ(counted_oracles(compare_optimizers(study), 0), "forward, jacobian (on 1 of 2)");
}

// One line ends a hundred times below all others.
TEST(PanelsOfThePage, HaveNoAxisThatLeavesOutTheEndOfALine) {
  Study study;
  Figure figure{
      .problem = "square", .title = "5c", .kind = "curve", .is_log_x = true, .is_log_y = true};
  for (std::size_t s = 0; s < 5; ++s) {
    study.runs.push_back(record_of({.optimizer = "m" + std::to_string(s)}));
    figure.lines.push_back({.optimizer = s,
                            .x = {1, 10, 100},
                            .y = {3, 2, s == 0 ? 0.0124 : 1.3},
                            .low = {},
                            .high = {}});
  }
  Document document{.comparison = compare_optimizers(study)};
  document.figures = {figure};
  const std::string html = figures_html(document);
  const std::size_t at = html.find("data-y=\"");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LE(std::stod(html.substr(at + 8)), 0.0124);
}

// Eight lines can be told apart; the others are shown on demand.
TEST(Page, ShowsEightLinesOfAProblemAtFirst) {
  Study study;
  for (std::size_t s = 0; s < 12; ++s) {
    const std::string name = "method-" + std::to_string(s);
    study.runs.push_back(record_of({.optimizer = name}));
    Sheet sheet{.kind = "optimizer", .name = name, .spec = name, .options_text = "[]"};
    sheet.mathematics = "kind-" + std::to_string(s);
    study.sheets.push_back(std::move(sheet));
  }
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(shown_at_first(c, ranking(c, 0)).size(), 8U);
  const std::string svg = curves_html(c, 0);
  std::size_t hidden = 0;
  for (std::size_t at = 0; (at = svg.find("class=off", at)) != std::string::npos; ++at) ++hidden;
  std::size_t charts = 0;
  for (std::size_t at = 0; (at = svg.find("class=\"chart", at)) != std::string::npos; ++at)
    ++charts;
  EXPECT_EQ(hidden, 4 * charts);
}

TEST(Page, TenThousandRecordsStayBelowEightMegabytes) {
  constexpr std::size_t kMost = 8'000'000, kProblems = 250, kOptimizers = 40;
  Study study;
  for (std::size_t p = 0; p < kProblems; ++p)
    for (std::size_t s = 0; s < kOptimizers; ++s)
      study.runs.push_back(record_of({.problem = "problem-" + std::to_string(p),
                                      .optimizer = "optimizer-" + std::to_string(s),
                                      .hits = 20 + (7 * p + 3 * s) % 32,
                                      .work_per_hit = static_cast<std::int64_t>(5 + p + 11 * s)}));
  EXPECT_EQ(study.runs.size(), 10'000U);
  EXPECT_LT(html_report(document_of(compare_optimizers(study))).size(), kMost);
}

}  // namespace
}  // namespace isoline::reports
