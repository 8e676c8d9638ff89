// `isoline report` at other tolerances and by other measures.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

class Report : public testing::Test {
 protected:
  void SetUp() override {
    shell(
        "./isoline run --problem square,scaling --optimizer gd,newton --iterations 50 --out out "
        "--no-report");
  }
  Json made() const { return read_json(shell.folder() / "out" / "report" / "report.json"); }
  Shell shell;
};

TEST_F(Report, ByAnyMeasureAtAnyToleranceTellsWhichInItsJson) {
  for (const std::string by : {"work", "cost", "iterations", "time"}) {
    const Finished result = shell("./isoline report out --tolerance 1e-4 --by " + by);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(made()["yardstick"]["by"], by);
    EXPECT_EQ(made()["yardstick"]["tolerances"][2]["name"], "1e-4");
  }
  EXPECT_EQ(shell("./isoline validate out/report/report.json").exit_code, 0);
}

TEST_F(Report, AToleranceBetweenTwoIsTheNextStricterOneAndSaysSo) {
  const Finished between = shell("./isoline report out --tolerance 5e-5");
  EXPECT_TRUE(contains(between.err, "4e-5, the next stricter one")) << between.err;
  EXPECT_EQ(made()["yardstick"]["tolerances"][2]["name"], "4e-5");
  const Finished exact = shell("./isoline report out --tolerance 1e-5");
  EXPECT_FALSE(contains(exact.err, "stricter")) << exact.err;
}

TEST_F(Report, OfAnUnknownMeasureIsWrongUsage) {
  EXPECT_EQ(shell("./isoline report out --by energy").exit_code, 1);
  EXPECT_EQ(shell("./isoline report out --tolerance 1e-12").exit_code, 1);
}

}  // namespace
}  // namespace isoline::benchmarks
