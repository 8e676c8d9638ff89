// Not part of the suite: writes sample studies to look at and to measure, under $ISOLINE_SAMPLE.
#include <gtest/gtest.h>

#include <cstdlib>

#include "reports/comparison.h"
#include "tests/reports/fixture.h"

namespace isoline {
namespace {

std::filesystem::path sample_folder() {
  const char* folder = std::getenv("ISOLINE_SAMPLE");
  return folder == nullptr ? std::filesystem::temp_directory_path() / "isoline-sample" : folder;
}

TEST(Sample, DISABLED_ToLookAt) { write_sample_study(sample_folder(), {}); }

TEST(Sample, DISABLED_OfTenThousandRecords) {
  write_sample_study(sample_folder(), {.problems = 20, .optimizers = 50, .seeds = 10});
}

}  // namespace
}  // namespace isoline
