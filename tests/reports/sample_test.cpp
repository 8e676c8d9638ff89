// A study of thousands of cells is reported whole, on a page that a browser can hold.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/files.h"
#include "core/json.h"
#include "reports/report.h"
#include "tests/reports/fixture.h"
#include "tests/temporary_folder.h"

namespace isoline::reports {
namespace {

#ifdef ISOLINE_SANITIZE  // some ten times slower
constexpr int kOptimizers = 40;
#else
constexpr int kOptimizers = 400;
#endif
constexpr int kProblems = 25;

TEST(Report, OfTenThousandCellsIsWholeAndItsPageBelowEightMegabytes) {
  constexpr std::uintmax_t kMostBytes = 8'000'000;
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  write_sample_study(folder,
                     {.problems = kProblems, .optimizers = kOptimizers, .seeds = 1, .points = 64});
  const Study study = read_study({folder});
  EXPECT_EQ(study.plan.cells.size(), std::size_t{kProblems * kOptimizers});
  EXPECT_GT(study.runs.size(), study.plan.cells.size() - 100);  // a few are missing on purpose
  EXPECT_TRUE(study.unreadable.empty());
  write_report(document_of(compare_optimizers(study)), folder / "report");
  EXPECT_LT(std::filesystem::file_size(folder / "report" / "index.html"), kMostBytes);
  const std::string csv = read_text(folder / "report" / "report.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            study.plan.cells.size() + 1);  // a header; missing cells have a row too
}

}  // namespace
}  // namespace isoline::reports
