// Not part of the suite: writes sample studies to look at and to measure, under $ISOLINE_SAMPLE.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>

#include "reports/report.h"
#include "tests/reports/fixture.h"

namespace isoline {
namespace {

std::filesystem::path sample_folder() {
  const char* folder = std::getenv("ISOLINE_SAMPLE");
  return folder == nullptr ? std::filesystem::temp_directory_path() / "isoline-sample" : folder;
}

void report_and_measure(const std::filesystem::path& folder) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<Real>(Clock::now() - start).count();
  };
  const auto start = Clock::now();
  const Study study = read_study({folder});
  std::cout << study.runs.size() << " records read in " << since(start) << " s\n";
  write_report(study, folder / "report");
  std::cout << "all in " << since(start) << " s, page "
            << std::filesystem::file_size(folder / "report" / "index.html") << " bytes\n";
}

TEST(Sample, DISABLED_ToReport) { report_and_measure(sample_folder()); }

TEST(Sample, DISABLED_ToLookAt) { write_sample_study(sample_folder(), {}); }

TEST(Sample, DISABLED_OfTenThousandRecords) {
  write_sample_study(sample_folder(),
                     {.problems = 20, .optimizers = 50, .seeds = 10, .points = 90});
}

TEST(Sample, DISABLED_OfTenThousandCells) {
  write_sample_study(sample_folder(),
                     {.problems = 25, .optimizers = 400, .seeds = 1, .points = 90});
}

}  // namespace
}  // namespace isoline
