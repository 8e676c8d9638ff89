// The tables of statistics: hand-computed cases, and the same figure in every format.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports/report.h"
#include "reports/sections/evidence.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string at(const Table& table, const std::string& row, const std::string& column) {
  const auto i = std::ranges::find(table.columns, column) - table.columns.begin();
  for (const auto& cells : table.rows)
    if (cells[0].text == row) return cells.at(static_cast<std::size_t>(i)).text;
  return "no such row";
}

// Ranks of a: 1, 2.5 and 1; of b: 2, 1 and 3; of c: 3, 2.5 and 2.
TEST(Tables, MeanRanksShareTiesAndCountFailuresLast) {
  const Study study = study_of({{"p", "a", 1},
                                {"p", "b", 2},
                                {"p", "c", 3},
                                {"q", "a", 0},
                                {"q", "b", 1},
                                {"q", "c", 0},
                                {"r", "a", 1},
                                {"r", "b", 0},
                                {"r", "c", 2}});
  const Table table = rank_table(compare_optimizers(study));
  EXPECT_EQ(at(table, "a", "mean rank"), "1.5");
  EXPECT_EQ(at(table, "b", "mean rank"), "2");
  EXPECT_EQ(at(table, "c", "mean rank"), "2.5");
  EXPECT_EQ(at(table, "a", "n problems"), "3");
  EXPECT_TRUE(has(table.reading, "a has the least mean rank, 1.5 of 3")) << table.reading;
}

// Five problems, all won by a: p = 2/2⁵ = 0.0625, with one pair not adjusted.
TEST(Tables, SignedRanksCannotTellFiveProblemsApart) {
  std::vector<Result> results;
  for (const char* problem : {"p", "q", "r", "s", "t"}) {
    results.push_back({problem, "a", 1});
    results.push_back({problem, "b", problem[0] == 't' ? 0 : 7});
  }
  const Study study = study_of(results);
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(signed_rank_table(c), "a", "b"), "0.062 (5/5)");
  EXPECT_TRUE(std::ranges::any_of(limits_of_evidence(c), [](const std::string& sentence) {
    return has(sentence, "no pair can be told apart");
  }));
}

// Of a, b and c alone: b is far behind c on both, a fast on one. Scores up to 64×, on log2:
// a is 1, 0 with c there on q; removing c turns a and b: see the ratios.
TEST(Tables, LeavingOneOutFindsTheFlipThatItCauses) {
  // p: a 8, b 16, c 1.  q: a 64·1, b 2, c unsolved.  r: a 1, b 4, c unsolved.
  // With c: a scores ½, 1/6, 1 (1.667); b 1/3, 1, 2/3 (2.0): b first of the two.
  // Without c: a 1, 1/6, 1 (2.167); b 5/6, 1, 2/3 (2.5): no flip. With q: a 16, without: 1, ½, 1
  // (2.5) against 2.5: a tie is no flip; a 8 gives 2.667 against 2.5, but with c 2.167 against 2.0.
  const Study none = study_of({{"p", "a", 8},
                               {"p", "b", 16},
                               {"p", "c", 1},
                               {"q", "a", 64},
                               {"q", "b", 1},
                               {"q", "c", 0},
                               {"r", "a", 1},
                               {"r", "b", 4},
                               {"r", "c", 0}});
  EXPECT_TRUE(flip_table(compare_optimizers(none)).rows.empty());
  // p: a 64, b 1, c 1/… makes a's loss count for nothing beyond 64×: a cut-off that c moves.
  // With c at 1: a 8 → ½, b 1024 → 0. Without: a 1, b 128 → 0; on q: b 1, a 16 → 1/3.
  // With c: a ½ + 1/3 = 0.833, b 0 + 1 = 1: b first. Without: a 1.333, b 1: a first.
  const Study turned = study_of({{"p", "a", 8},
                                 {"p", "b", 1024},
                                 {"p", "c", 1},
                                 {"q", "a", 16},
                                 {"q", "b", 1},
                                 {"q", "c", 0}});
  const Table table = flip_table(compare_optimizers(turned));
  EXPECT_EQ(at(table, "c", "pairs swapped"), "1") << table.reading;
  EXPECT_EQ(at(table, "c", "first without it"), "a");
}

// Alone on p and q: a scores 1 and 1/3, b 0 and 1; their order in the whole table is the reverse.
TEST(Tables, PairwiseProfilesKnowNoThirdMethod) {
  const Study study = study_of({{"p", "a", 8},
                                {"p", "b", 1024},
                                {"p", "c", 1},
                                {"q", "a", 16},
                                {"q", "b", 1},
                                {"q", "c", 0}});
  const Table table = pairwise_table(compare_optimizers(study));
  EXPECT_EQ(at(table, "a", "b"), "0.67 : 0.50 (n 2)");
}

// Work 30, 300 and never: a third within 100, two thirds within 1000.
TEST(Tables, DataProfileCountsForwardSolvesAndKeepsFailures) {
  const Study study = study_of({{"p", "a", 1}, {"q", "a", 10}, {"r", "a", 0}});
  const Table table = data_profile_table(compare_optimizers(study));
  EXPECT_EQ(at(table, "a", "≤ 10"), "0 %");
  EXPECT_EQ(at(table, "a", "≤ 100"), "33 %");
  EXPECT_EQ(at(table, "a", "≤ 1000"), "67 %");
  EXPECT_EQ(at(table, "a", "n problems"), "3");
}

// A loss from −1 to −5 with f_L = −5, read off the curve, since no minimum is declared.
TEST(Tables, ProfilesAreRightForNegativeLosses) {
  Study study = study_of({{"p", "a", 2}});
  Record& record = study.runs[0];
  record.hits.reset();
  record.minimum.reset();
  for (Real& loss : record.curve.loss) loss = -5 + 4 * loss;  // 1 … 1e-10 before
  record.summary.start_loss = -1;
  record.summary.loss = record.summary.best_loss = -5;
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 100"), "100 %");
  EXPECT_EQ(at(data_profile_table(c), "a", "≤ 10"), "0 %");
  EXPECT_EQ(at(accuracy_table(c), "a", "≥ 10"), "100 %");
}

// One of two seeds gets there, after 60 of 102 spent in all by each... the other spends its 20.
TEST(Tables, ExpectedRunningTimeCountsWhatFailedRunsSpent) {
  Study study;
  study.runs = {record_of({.seed = 0, .work_per_hit = 2}),
                record_of({.seed = 1, .hits = 10, .work_per_hit = 2, .status = Status::budget})};
  const Table table = restart_table(compare_optimizers(study));
  EXPECT_TRUE(at(table, "gd", "square").starts_with("80 [60–")) << at(table, "gd", "square");
  EXPECT_TRUE(at(table, "gd", "square").ends_with("(1/2)")) << at(table, "gd", "square");
}

// Every tenth of the 51 targets costs 10 more: by 100 all are met, by 10 the first 6 of 51.
TEST(Tables, RuntimeDistributionCountsTargets) {
  const Study study = study_of({{"p", "a", 2}});
  const Table table = anytime_table(compare_optimizers(study));
  EXPECT_EQ(at(table, "a", "≤ 10"), "12 %");
  EXPECT_EQ(at(table, "a", "≤ 100"), "100 %");
  EXPECT_EQ(at(table, "a", "n runs"), "1");
}

// A method that goes on ten times as long changes no other's area: 51 targets a forward solve or
// two apart, of the 2000 that the request allowed.
TEST(Tables, TheAreaOverAConvergenceCurveDoesNotDependOnWhoElseRan) {
  Study study = study_of({{"p", "a", 1}});
  study.runs[0].request.budget.work = 2000;
  const std::string alone = at(anytime_table(compare_optimizers(study)), "a", "area");
  EXPECT_EQ(alone, "0.987");
  study.runs.push_back(record_of({.problem = "p", .optimizer = "b", .work_per_hit = 1000}));
  EXPECT_EQ(at(anytime_table(compare_optimizers(study)), "a", "area"), alone);
}

TEST(Tables, NobodyHasTheLargestAreaWhereAllAreZero) {
  Study study;
  for (const char* problem : {"p", "q", "r", "s"})
    for (const char* optimizer : {"a", "b"})
      study.runs.push_back(record_of(
          {.problem = problem, .optimizer = optimizer, .hits = 1, .status = Status::budget}));
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(has(anytime_table(c).reading, "all areas are 0")) << anytime_table(c).reading;
  EXPECT_TRUE(has(profile_table(c).reading, "No method solves any")) << profile_table(c).reading;
  const Document document = document_of(compare_optimizers(study));
  for (const Plot& plot : document.section("statistics").plots)
    if (plot.id != "plot-runtime")  // whose first target is the start, which all meet
      EXPECT_FALSE(has(plot.reading, "a and 1 more")) << plot.id << ": " << plot.reading;
}

TEST(Tables, RestartsSayThatTheyDrawOtherInstances) {
  const Study study = study_of({{"p", "a", 1}});
  const Comparison c = compare_optimizers(study);
  EXPECT_TRUE(has(restart_table(c).caption, "a restart here draws another instance"));
}

// Two sizes of one problem are two settings of it: a count of rows says so.
TEST(Tables, CountsOfSettingsAreNotCalledProblems) {
  const Study study = study_of({{"p[N=8]", "a", 1}, {"p[N=16]", "a", 1}});
  const Comparison c = compare_optimizers(study);
  EXPECT_EQ(at(data_profile_table(c), "a", "n settings"), "2");
  EXPECT_EQ(std::ranges::count(data_profile_table(c).columns, "n problems"), 0);
}

// Three seeds give a range, whatever is resampled: an interval of 95 % takes six.
TEST(Tables, OfFewerThanSixSeedsTheRangeIsCalledARange) {
  Study study;
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    study.runs.push_back(record_of({.seed = seed, .work_per_hit = 1 + 2 * std::int64_t(seed)}));
  const Table table = interval_table(compare_optimizers(study));
  EXPECT_TRUE(has(table.caption, "range of 3")) << table.caption;
  EXPECT_FALSE(has(table.caption, "95 %")) << table.caption;
  EXPECT_EQ(at(table, "gd", "square"), "90 [30–150] (3/3)");
}

TEST(Tables, EveryFormatPrintsTheSameFigures) {
  const ResultFolder folder;
  write_sample_study(folder.path(), {.problems = 5, .optimizers = 6, .seeds = 3, .points = 30});
  const Study study = read_study({folder.path()});
  const Document document = document_of(compare_optimizers(study));
  const std::string html = html_report(document), markdown = markdown_report(document),
                    latex = latex_report(document);
  std::size_t count = 0;
  for (const Table& table : document.section("statistics").tables) {
    EXPECT_FALSE(table.reading.empty()) << table.id;
    EXPECT_TRUE(std::ranges::any_of(table.columns,
                                    [](const std::string& name) { return name == "failed"; }) ||
                table.id == "prices")
        << table.id;
    for (const auto& row : table.rows) {
      ASSERT_EQ(row.size(), table.columns.size()) << table.id;
      for (const TableCell& each : row) {
        const std::string& cell = each.text;
        const bool is_figure = cell.find_first_not_of("0123456789.e-") == std::string::npos;
        if (!is_figure || cell.empty()) continue;
        for (const std::string* text : {&html, &markdown, &latex})
          EXPECT_TRUE(has(*text, cell)) << table.id << ": " << cell;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 40U);
}

}  // namespace
}  // namespace isoline::reports
