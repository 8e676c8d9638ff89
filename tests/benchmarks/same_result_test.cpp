// Where two runs of one cell part is named by what a reader of the curve would look for.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/store.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

Record run_of(const char* problem, const char* optimizer, std::int64_t iterations = 20) {
  const Request request = cell_of(problem, optimizer, {.iterations = iterations, .target = 0});
  return executed(catalog(), request);
}

TEST(SameResult, IsThatOfTheSameCellRunTwice) {
  const Record a = run_of("square", "gd[rate=1e-4]"), b = run_of("square", "gd[rate=1e-4]");
  EXPECT_TRUE(same_result(a, b));
  const Comparison found = compare_results(a, b);
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.iterations, 20);
}

TEST(SameResult, IsNotThatOfOneBitMore) {
  const Record a = run_of("square", "gd[rate=1e-4]");
  Record b = a;
  b.curve.gradient_norm[5] = std::nextafter(b.curve.gradient_norm[5], 1e9);
  EXPECT_FALSE(same_result(a, b));
  EXPECT_TRUE(compare_results(a, b).difference.starts_with("gradient norm at iteration 5: "))
      << compare_results(a, b).difference;
}

TEST(SameResult, TheEarliestIterationIsNamedWhateverItsColumn) {
  const Record a = run_of("square", "gd[rate=1e-4]");
  Record b = a;
  b.curve.loss[9] = 1;
  b.curve.work[4] = 7;
  EXPECT_TRUE(compare_results(a, b).difference.starts_with("work at iteration 4: "))
      << compare_results(a, b).difference;
}

TEST(SameResult, NotANumberIsItself) {
  Record a = run_of("square", "newton");
  a.curve.x_error[1] = std::nan("");
  EXPECT_EQ(compare_results(a, a).difference, "");
  Record b = a;
  b.curve.x_error[1] = 0;
  EXPECT_EQ(compare_results(a, b).difference, "x error at iteration 1: \"nan\" against 0.0");
}

TEST(SameResult, ALongerRunDiffersUnlessAClockEndedOne) {
  const Record a = run_of("square", "gd[rate=1e-4]", 20);
  Record b = run_of("square", "gd[rate=1e-4]", 10);
  EXPECT_EQ(compare_results(a, b).difference, "last iteration: 20 against 10");
  b.is_nondeterministic = true;
  const Comparison found = compare_results(a, b);
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.iterations, 9);
  EXPECT_TRUE(found.is_up_to_there);
}

TEST(SameResult, TimesAndTheMachineAreNoDifference) {
  const Record a = run_of("square", "newton");
  Record b = a;
  b.summary.wall_seconds = 7;
  b.curve.wall_seconds[1] = 3;
  b.repeat_wall_seconds = {1, 2};
  b.provenance.run.command = "another";
  EXPECT_EQ(compare_results(a, b).difference, "");
  b.message = "another";
  EXPECT_EQ(compare_results(a, b).difference, "message: \"\" against \"another\"");
}

}  // namespace
}  // namespace isoline::benchmarks
