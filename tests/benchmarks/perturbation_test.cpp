// Perturbed starts differ in the last bit and in nothing else; their records stay apart.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "benchmarks/run/execute.h"
#include "benchmarks/run/runner.h"
#include "core/errors.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

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
  Suite suite;
  suite.name = "small";
  suite.blocks = {{.problems = {"rosenbrock"}, .optimizers = {"gd", "newton", "hig"}}};
  suite.blocks[0].budget.iterations = 50;
  return FinishedMatrix(catalog(), suite, Rates::builtin());
}

TEST(PerturbedRuns, AnswerTheSameCellsFromAnotherStart) {
  const FinishedMatrix matrix = small_matrix();
  const auto once = perturbed(matrix.records);
  const auto again = perturbed(matrix.records);
  ASSERT_EQ(once.size(), matrix.records.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    const Record& record = matrix.records[i];
    EXPECT_EQ(once[i].cell, record.cell);
    EXPECT_EQ(once[i].summary.loss, again[i].summary.loss);
    EXPECT_NE(once[i].summary.start_loss, record.summary.start_loss) << title_of(record);
    EXPECT_NEAR(once[i].summary.start_loss, record.summary.start_loss,
                1e-12 * record.summary.start_loss);
  }
}

TEST(PerturbedRuns, LeaveTheRecordsOfTheFolderAsTheyWere) {
  const FinishedMatrix matrix = small_matrix();
  perturbed(matrix.records);
  for (std::size_t i = 0; i < matrix.records.size(); ++i) {
    const Record& record = matrix.records[i];
    const auto kept = Store::find_in(matrix.folder.path(), matrix.requests[i]);
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(kept->summary.start_loss, record.summary.start_loss);
    EXPECT_EQ(kept->repeat_wall_seconds, record.repeat_wall_seconds);
  }
}

TEST(PerturbedRuns, RefuseRecordsOfAnotherBuild) {
  FinishedMatrix matrix = small_matrix();
  matrix.records[1].build = "0123456789abcdef";
  EXPECT_THROW(perturbed(matrix.records), UsageError);
}

TEST(PerturbedRuns, LeaveOutWhatAClockEndedAndWhatDoesNotApply) {
  FinishedMatrix matrix = small_matrix();
  matrix.records[0].is_nondeterministic = true;
  matrix.records[1].status = Status::inapplicable;
  EXPECT_EQ(perturbed(matrix.records).size(), matrix.records.size() - 2);
}

}  // namespace
}  // namespace isoline::benchmarks
