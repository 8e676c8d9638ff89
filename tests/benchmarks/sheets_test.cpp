// Sheets of problems: how ill-conditioned each is, where that can be told.
#include "benchmarks/run/sheets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace isoline::benchmarks {
namespace {

Sheet sheet_of(const std::string& problem, const OptionValues& options) {
  static const Catalog catalog = builtin_catalog();
  return problem_sheet(catalog, complete_problem(catalog, problem, options));
}

TEST(Sheets, OfADirectProblemTellTheConditionNumberOfItsJacobian) {
  const Sheet scaling = sheet_of("scaling", {{"alpha", 0.02}});
  EXPECT_NEAR(scaling.condition.value(), 50, 50e-12);
  EXPECT_EQ(sheet_from_json(to_json(scaling)).condition, scaling.condition);
  // λ_pq = −4 [sin²(πp/2(N+1)) + sin²(πq/2(N+1))]: their extremes are those of one direction.
  const Real angle = std::numbers::pi / 18;
  const Real poisson = std::pow(std::tan(angle), -2);
  EXPECT_NEAR(sheet_of("poisson", {{"N", 8}}).condition.value(), poisson, 1e-10 * poisson);
}

// At the solution (0, 0) of `square`, x₂² has no slope: J lacks rank there.
TEST(Sheets, OfAProblemThatLacksRankAtItsSolutionSaySo) {
  EXPECT_TRUE(std::isinf(sheet_of("square", {}).condition.value()));
}

TEST(Sheets, TellNoConditionNumberOfWhatIsLearnedOrTooLarge) {
  EXPECT_FALSE(sheet_of("sine", {{"mode", "learn"}, {"batch", 4}}).condition);
  EXPECT_FALSE(sheet_of("poisson", {{"N", 64}}).condition);
}

}  // namespace
}  // namespace isoline::benchmarks
