// Invented records pass for real ones, and a report of thousands of them loses none.
#include "tests/reports/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/report.h"
#include "tests/temporary_folder.h"

namespace isoline::reports {
namespace {

#ifdef ISOLINE_SANITIZE  // some ten times slower
constexpr SyntheticSize kSize{.problems = 10, .optimizers = 10, .seeds = 2, .random_seed = 7};
#else
constexpr SyntheticSize kSize{.problems = 20, .optimizers = 20, .seeds = 5, .random_seed = 7};
#endif

struct Tally {
  std::size_t runs = 0, failed = 0, planned = 0;
};

// Of the records themselves, not by way of a report.
std::map<Status, std::size_t> statuses_drawn() {
  std::map<Status, std::size_t> statuses;
  for (std::size_t i = 0; i < kSize.records(); ++i) ++statuses[synthetic_record(kSize, i).status];
  return statuses;
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

TEST(SyntheticRecords, AreTheSameFromTheSameSeedAndOthersFromAnother) {
  SyntheticSize other = kSize;
  ++other.random_seed;
  for (const std::size_t i : {std::size_t{0}, kSize.records() / 3, kSize.records() - 1}) {
    const Json record = to_json(synthetic_record(kSize, i));
    EXPECT_EQ(record, to_json(synthetic_record(kSize, i))) << i;
    EXPECT_NE(record, to_json(synthetic_record(other, i))) << i;
  }
}

TEST(SyntheticRecords, KeepTheSchemaOfRecordsAndHaveTwelveColumns) {
  const Json schema =
      read_json(std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas/run.json");
  for (std::size_t i = 0; i < kSize.records(); i += 17) {
    const Record record = synthetic_record(kSize, i);
    EXPECT_EQ(schema_violations(to_json(record), schema), std::vector<std::string>{}) << i;
    if (record.status == Status::inapplicable) continue;
    const Json curve = to_json(record).at("curve");
    EXPECT_EQ(curve.size() - 1 + curve.at("counts").size(), 12U);  // `counts` holds columns itself
    EXPECT_EQ(curve.at("loss").size(), kSize.points);
  }
}

TEST(Report, OfThousandsOfRecordsCountsEachOnceAndStatesTheSameNumberOfFailuresEverywhere) {
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  write_synthetic_study(folder, kSize);
  const Study study = read_study({folder});
  ASSERT_EQ(study.runs.size(), kSize.records());
  EXPECT_TRUE(study.unreadable.empty());
  const Document document = document_of(compare_optimizers(study));
  const Comparison& comparison = document.comparison;
  EXPECT_EQ(comparison.answered, kSize.records());
  EXPECT_EQ(comparison.statuses, statuses_drawn());
  EXPECT_EQ(comparison.problems.size(), kSize.problems);
  EXPECT_EQ(comparison.optimizers.size(), kSize.optimizers);
  Tally all;
  for (const auto& row : comparison.cells)
    for (const Cell& cell : row) {
      all.runs += cell.runs.size();
      all.failed += cell.failed;
      all.planned += cell.planned;
      EXPECT_EQ(cell.runs.size(), kSize.seeds);
      if (!cell.is_measured()) continue;
      for (const Spread& work : cell.headline) EXPECT_EQ(work.n, kSize.seeds);
      EXPECT_EQ(cell.loss.n, kSize.seeds);
    }
  EXPECT_EQ(all.runs, kSize.records());
  EXPECT_EQ(all.planned, kSize.records());
  EXPECT_EQ(all.failed, comparison.failures.size());
  EXPECT_GT(all.failed, 0U);
  write_report(document, folder / "report");
  EXPECT_EQ(lines_of(read_text(folder / "report/report.csv")), kSize.records() + 1);  // a header
  const Json report = read_json(folder / "report/report.json");
  EXPECT_EQ(report.at("failures").size(), comparison.failures.size());
  std::size_t runs = 0, failed = 0;
  for (const Json& optimizer : report.at("optimizers")) {
    runs += optimizer.at("runs").get<std::size_t>();
    failed += optimizer.at("failed").get<std::size_t>();
  }
  EXPECT_EQ(failed, comparison.failures.size());
  EXPECT_EQ(runs, kSize.records() - statuses_drawn()[Status::inapplicable]);
}

TEST(Report, OfTrimmedRecordsIsThatOfWholeOnes) {
  const TemporaryFolder owned;
  write_synthetic_study(owned.path(), {.problems = 4, .optimizers = 5, .seeds = 3});
  const std::vector<std::string> twice(2, owned.path().string());  // each record has another
  const Study whole = read_study(twice);
  const Study trimmed =
      read_study(twice, {}, [](Record& record) { trim_for_report(record, false); });
  EXPECT_TRUE(std::ranges::all_of(
      trimmed.runs, [](const Record& run) { return run.curve.gradient_norm.empty(); }));
  EXPECT_EQ(trimmed.superseded, whole.runs.size());
  const Document one = document_of(compare_optimizers(whole)),
                 other = document_of(compare_optimizers(trimmed));
  for (const Format& format : kFormats)
    EXPECT_TRUE(format.text(one) == format.text(other)) << format.file;
}

TEST(Report, OfTenThousandCellsIsWholeAndItsPageBelowEightMegabytes) {
  constexpr std::uintmax_t kMostBytes = 8'000'000;
#ifdef ISOLINE_SANITIZE
  constexpr std::size_t kOptimizers = 40;
#else
  constexpr std::size_t kOptimizers = 400;
#endif
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  write_synthetic_study(folder,
                        {.problems = 25, .optimizers = kOptimizers, .seeds = 1, .is_sample = true});
  const Study study = read_study({folder});
  EXPECT_EQ(study.plan.cells.size(), 25 * kOptimizers);
  EXPECT_LT(study.runs.size(), study.plan.cells.size());  // a few are missing on purpose
  EXPECT_TRUE(study.unreadable.empty());
  write_report(document_of(compare_optimizers(study)), folder / "report");
  EXPECT_LT(std::filesystem::file_size(folder / "report" / "index.html"), kMostBytes);
  const std::string csv = read_text(folder / "report" / "report.csv");
  EXPECT_EQ(lines_of(csv), study.plan.cells.size() + 1);  // a header; missing cells have a row too
}

}  // namespace
}  // namespace isoline::reports
