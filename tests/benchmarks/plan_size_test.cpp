// How large a plan is, is known before anything of it is made.
#include <gtest/gtest.h>

#include "benchmarks/plan/suite.h"
#include "core/errors.h"
#include "core/spec.h"
#include "core/text.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {
namespace {

Suite suite_of(const std::string& problems, const std::string& optimizers, const char* seeds) {
  const MatrixBlock block{
      .problems = {problems}, .optimizers = {optimizers}, .seeds = parse_seeds(seeds)};
  return {.name = "own", .title = "", .blocks = {block}};
}

TEST(PlanSizes, AreWhatExpansionGives) {
  for (const auto& [problems, optimizers] : std::vector<std::pair<std::string, std::string>>{
           {"sine[xi=1|2|3],square", "gd[rate=1|2],newton"}, {"*", "@matrix-free"}}) {
    const Suite suite = suite_of(problems, optimizers, "3");
    EXPECT_EQ(size_of(catalog(), suite).cells, expand(catalog(), suite, {}).size()) << problems;
  }
}

TEST(PlanSizes, SayWhatMakesThemSoLarge) {
  const Suite suite = suite_of("sine[xi=1|2|3|4,phi=1|2]", "gd", "50000");
  const PlanSize size = size_of(catalog(), suite);
  EXPECT_EQ(size.cells, 400'000U);
  EXPECT_EQ(too_large(size, 1000),
            "the plan has 400,000 cells, more than 1,000: 50,000 seeds × 8 settings of sine");
  const Suite wide = suite_of("sine[xi=1|2|3],square", "gd,newton", "2");
  EXPECT_EQ(size_of(catalog(), wide).largest,
            "2 seeds × 4 settings of 2 problems, 3 of them of sine × 2 optimizers");
}

TEST(PlanSizes, OverAMillionAreRefusedBeforeAnythingIsMade) {
  EXPECT_THROW(expand(catalog(), suite_of("*", "*", "0..999999"), {}), UsageError);
  std::string values = "1";
  for (int i = 1; i < 1000; ++i) values += "|" + std::to_string(i);
  const std::string sweep = "sine[xi=" + values + ",phi=" + values + ",gamma=" + values + "]";
  EXPECT_EQ(size_of(catalog(), suite_of(sweep, sweep, "1000000")).cells, kUncountable);
  EXPECT_THROW(expand(catalog(), suite_of(sweep, "gd", "1"), {}), UsageError);
  EXPECT_THROW(expand(catalog(), suite_of("square", "gd", "11"), {}, 10), UsageError);
}

TEST(Cells, OfOneRequestDifferInTheirSeedsAlone) {
  const std::vector<Request> cells = expand(catalog(), suite_of("square", "gd", "5"), {});
  for (const Request& cell : cells) EXPECT_EQ(cell.cell, cell_digest(cell));
}

}  // namespace
}  // namespace isoline::benchmarks
