// Least-squares methods on NIST's certified regressions: parameters, standard deviations, stopping.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "tests/optimizers/run.h"

namespace isoline::optimizers {
namespace {

const Json& certified() {
  static const Json all = read_json(ISOLINE_SOURCE_DIR "/problems/nist.json").at("datasets");
  return all;
}

Problem regression(const std::string& name, int start) {
  return make("nist[dataset=" + name + ",start=" + std::to_string(start) + "]");
}

constexpr Budget kBudget{.iterations = 100000, .work = 10000, .target = 0};
constexpr Budget kSuite{.iterations = 100000, .work = 3380, .target = 0};  // of `nist`

// The log relative error of the worst parameter, at most the certified 11.
Real digits_reached(const Outcome& outcome) {
  const Real error = outcome.trace->last.x_error;
  return error < 1 ? std::min(-std::log10(error), 11.0) : 0;
}

struct NistSum {
  int solved = 0;  // to four digits, of 54
  Real digits = 0;
  std::int64_t forwards = 0;
};
NistSum sum_over_all(const std::string& method) {
  NistSum sum;
  for (const auto& set : certified().items())
    for (const int start : {1, 2}) {
      const Outcome outcome = run(regression(set.key(), start), method, kSuite);
      sum.solved += digits_reached(outcome) >= 4;
      sum.digits += digits_reached(outcome) / 54;
      sum.forwards += outcome.trace->last.counts[0];
    }
  return sum;
}

// Lanczos1's residuals are rounding.
TEST(Regression, StandardDeviationsAreTheCertifiedOnes) {
  ASSERT_EQ(certified().size(), 27U);
  for (const auto& set : certified().items()) {
    if (set.key() == "Lanczos1") continue;
    const Outcome outcome = run(regression(set.key(), 2), "levenberg-marquardt", kBudget);
    ASSERT_TRUE(outcome.parts.uncertainty) << set.key();
    const Uncertainty& known = *outcome.parts.uncertainty;
    const std::vector<Real> deviations = reals_of(set.value().at("standard_deviation"));
    ASSERT_EQ(known.x.size(), deviations.size()) << set.key();
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      EXPECT_NEAR(known.standard_deviation[i] / deviations[i], 1, 1e-6) << set.key() << i;
      EXPECT_EQ(known.x[i], outcome.theta[Index(i)]) << set.key();
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LE(std::abs(known.correlation[i][j]), 1) << set.key();
        EXPECT_EQ(known.correlation[i][j], known.correlation[j][i]) << set.key();
      }
    }
    EXPECT_GE(known.condition, 1) << set.key();
  }
}

// As many residuals as unknowns leave no variance to estimate, and a loss that is not a square, a
// network, or a parameter without any effect has no such covariance.
TEST(Regression, StandardDeviationsNeedMoreResidualsThanUnknowns) {
  EXPECT_FALSE(run(make("rosenbrock"), "gauss-newton", iterations(5)).parts.uncertainty);
  EXPECT_FALSE(run(make("quantum-dipole"), "gd", iterations(1)).parts.uncertainty);
  EXPECT_FALSE(run(make("sine[mode=learn]"), "gd", iterations(1)).parts.uncertainty);
  const Outcome flat = run_from(Vector{{0.0, 1e9}}, regression("BoxBOD", 1), "gd", iterations(0));
  EXPECT_FALSE(flat.parts.uncertainty);
}

// 4,564 evaluations were counted with kernels for AVX2, 5,168 with those for SSE3: the steps at the
// level of rounding differ, and still make x more accurate.
TEST(Regression, LevenbergMarquardtSolvesAllCellsButOne) {
  const NistSum sum = sum_over_all("levenberg-marquardt");
  EXPECT_GE(sum.solved, 53);
  EXPECT_LE(sum.forwards, 6000);  // room for the rounding of other kernels
  EXPECT_GE(sum.digits, 9.9);
}

TEST(Regression, BoxBodFromItsFarStartNeedsTheAcceleration) {
  const Problem problem = regression("BoxBOD", 1);
  EXPECT_GE(digits_reached(run(problem, "levenberg-marquardt", kBudget)), 6);
  EXPECT_LT(digits_reached(run(problem, "levenberg-marquardt[acceleration=0]", kBudget)), 4);
}

// Without poor steps, a run is one without acceleration.
TEST(Regression, GoodStepsAreNotAccelerated) {
  const Outcome usual = run(regression("Misra1a", 2), "levenberg-marquardt", kBudget),
                plain =
                    run(regression("Misra1a", 2), "levenberg-marquardt[acceleration=0]", kBudget);
  EXPECT_EQ(usual.theta, plain.theta);
  EXPECT_EQ(usual.trace->last.counts, plain.trace->last.counts);
}

// J's columns differ by 1e16 in norm on the way: none may count as dependent on another.
TEST(Regression, LevenbergMarquardtEndsNowhereBelowTheLoss) {
  Budget budget = kBudget;
  budget.work = 100000;
  const Outcome outcome =
      run(regression("MGH10", 1), "levenberg-marquardt[acceleration=0]", budget);
  EXPECT_EQ(outcome.status, Status::converged);
  EXPECT_GE(digits_reached(outcome), 6);
}

// Once rounding alone judges a step, a run ends within a few: MGH17 from its second start took
// eight rejected steps more.
TEST(Regression, LevenbergMarquardtEndsWhereOnlyRoundingIsLeft) {
  for (const char* name : {"MGH17", "Rat43", "Thurber", "Gauss1"}) {
    const Outcome outcome = run(regression(name, 2), "levenberg-marquardt", kBudget);
    EXPECT_EQ(outcome.status, Status::converged) << name;
    EXPECT_LE(outcome.trace->rejected_steps, 6) << name;
    EXPECT_GE(digits_reached(outcome), 7) << name;
  }
}

TEST(Regression, CeresStopsAtItsTolerances) {
  const NistSum
      tight = sum_over_all(
          "ceres-lm[function-tolerance=1e-16,gradient-tolerance=1e-20,parameter-tolerance=1e-18]"),
      usual = sum_over_all(
          "ceres-lm[function-tolerance=1e-6,gradient-tolerance=1e-10,parameter-tolerance=1e-8]");
  EXPECT_EQ(tight.solved, 53);
  EXPECT_GE(tight.digits, 8.8);
  EXPECT_LE(usual.digits, 5);
  EXPECT_LE(usual.forwards, tight.forwards * 2 / 3);
}

// exp overflows in the gradient of Rat42 beside a finite loss. Ceres would end the process there.
TEST(Regression, CeresSearchesStepBackFromAGradientThatOverflows) {
  for (const char* method : {"ceres-bfgs", "ceres-lbfgs", "ceres-ncg"}) {
    const Outcome outcome = run(regression("Rat42", 1), method, kBudget);
    EXPECT_LT(outcome.trace->last.loss, outcome.trace->start_loss) << method;
  }
}

}  // namespace
}  // namespace isoline::optimizers
