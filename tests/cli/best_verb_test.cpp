// The table of best losses, renewed from runs as a user does it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

TEST(BestVerb, KeepsTheLeastLossOfRunsThatDeclareNoneAndNoOther) {
  const Shell shell;
  const std::string run =
      "./isoline run --problem 'brown-dennis[m=10],rosenbrock' --optimizer gd,levenberg-marquardt "
      "--rates none --work 500 --seeds 2 --quiet --no-report --out out";
  ASSERT_EQ(shell(run).exit_code, 0);
  ASSERT_EQ(shell("./isoline best out --out best.json").exit_code, 0);
  const Json table = read_json(shell.folder() / "best.json");
  ASSERT_EQ(table.at("rows").size(), 1U);
  const Json& row = table["rows"][0];
  EXPECT_EQ(row.at("problem"), "brown-dennis");
  EXPECT_EQ(row.at("options").at("m"), 10);
  ASSERT_EQ(row.at("losses").size(), 2U);
  EXPECT_EQ(row["losses"][0].at("optimizer"), "levenberg-marquardt");
  EXPECT_EQ(shell("./isoline validate best.json").exit_code, 0);
  const Finished again = shell("./isoline best out --out best.json");
  EXPECT_TRUE(contains(again.out, "improved: 0\n")) << again.out;
  EXPECT_EQ(read_json(shell.folder() / "best.json"), table);
}

}  // namespace
}  // namespace isoline::benchmarks
