// Repeated runs: where two of one cell part is named by what a reader of the curve would look for;
// perturbed starts differ in the last bit and in nothing else, and their records stay apart.

#include <cmath>
#include <limits>

#include "core/errors.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

constexpr Real kUnit = std::numeric_limits<Real>::epsilon();

Request request_for(const std::string& problem) {
  Request request;
  request.problem.name = problem;
  return request;
}

TEST(Perturbation, MovesEachComponentByOneUnitInTheLastPlace) {
  const Vector start = Vector::LinSpaced(64, -3, 5);
  const Vector moved = perturbed_start(start, request_for("square"), 1);
  Index up = 0;
  for (Index i = 0; i < start.size(); ++i) {
    EXPECT_NE(moved[i], start[i]);
    EXPECT_EQ(std::nextafter(start[i], moved[i]), moved[i]) << "not its neighbour";
    up += moved[i] > start[i];
  }
  EXPECT_GT(up, 16) << "half of 64 random signs, give or take four deviations of 4";
  EXPECT_LT(up, 48);
}

TEST(Perturbation, GivesAZeroTheUnitOfTheLargestComponent) {
  Vector start(3);
  start << 0, -4, 1;
  EXPECT_EQ(std::abs(perturbed_start(start, request_for("square"), 1)[0]), 4 * kUnit);
  const Vector origin = perturbed_start(Vector::Zero(5), request_for("square"), 1);
  EXPECT_TRUE((origin.array().abs() == kUnit).all());
  EXPECT_EQ(perturbed_start(Vector(0), request_for("square"), 1).size(), 0);
}

TEST(Perturbation, IsTheSameForItsNumberAndAnotherForTheNext) {
  const Vector start = Vector::Ones(64);
  const Request square = request_for("square"), beale = request_for("beale");
  EXPECT_EQ(perturbed_start(start, square, 1), perturbed_start(start, square, 1));
  EXPECT_NE(perturbed_start(start, square, 1), perturbed_start(start, square, 2));
  EXPECT_NE(perturbed_start(start, square, 1), perturbed_start(start, beale, 1));
}

std::vector<Record> perturbed(const std::vector<Record>& records) {
  return perturbed_records(catalog(), records, 1, {.jobs = 2}).value();
}

FinishedMatrix small_matrix() {
  const Suite suite{.name = "small",
                    .title = "",
                    .blocks = {{.problems = {"rosenbrock"},
                                .optimizers = {"gd", "newton", "hig"},
                                .budget = {.iterations = 50}}}};
  return FinishedMatrix(catalog(), suite, Rates::builtin());
}

TEST(PerturbedRuns, AnswerTheSameCellsFromAnotherStartAndLeaveTheRecordsAsTheyWere) {
  const FinishedMatrix matrix = small_matrix();
  const auto once = perturbed(matrix.records), again = perturbed(matrix.records);
  ASSERT_EQ(once.size(), matrix.records.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    const Record& record = matrix.records[i];
    EXPECT_EQ(once[i].cell, record.cell);
    EXPECT_EQ(once[i].summary.loss, again[i].summary.loss);
    EXPECT_NE(once[i].summary.start_loss, record.summary.start_loss) << title_of(record);
    EXPECT_NEAR(once[i].summary.start_loss, record.summary.start_loss,
                1e-12 * record.summary.start_loss);
    const auto kept = Store::find_in(matrix.folder.path(), matrix.requests[i]);
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(kept->summary.start_loss, record.summary.start_loss);
    EXPECT_EQ(kept->repeat_wall_seconds, record.repeat_wall_seconds);
  }
}

TEST(PerturbedRuns, RefuseAnotherBuildAndLeaveOutWhatAClockEndedAndWhatDoesNotApply) {
  FinishedMatrix matrix = small_matrix();
  matrix.records[0].is_nondeterministic = true;
  matrix.records[1].status = Status::inapplicable;
  EXPECT_EQ(perturbed(matrix.records).size(), matrix.records.size() - 2);
  matrix.records[2].build = "0123456789abcdef";
  EXPECT_THROW(perturbed(matrix.records), UsageError);
}

// --- two records of one cell

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

TEST(SameResult, IsNotThatOfOneBitMoreAndTheEarliestIterationIsNamed) {
  const Record a = run_of("square", "gd[rate=1e-4]");
  Record b = a;
  b.curve.gradient_norm[5] = std::nextafter(b.curve.gradient_norm[5], 1e9);
  EXPECT_FALSE(same_result(a, b));
  EXPECT_TRUE(compare_results(a, b).difference.starts_with("gradient norm at iteration 5: "))
      << compare_results(a, b).difference;
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
