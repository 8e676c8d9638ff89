// Methods on the multilayer perceptron: their laws hold there too, and short trainings end as the
// paper says.
#include <gtest/gtest.h>

#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::Problem;
namespace {

void expect_near(const Vector& one, const Vector& other, Real tolerance, const std::string& what) {
  EXPECT_LE((one - other).norm(), tolerance * other.norm()) << what;
}

Vector first_step(const Problem& problem, const std::string& spec) {
  return run(problem, spec, iterations(1)).theta - problem.start();
}

// 42 parameters in double; fresh samples, fewer residuals than parameters for batches up to 20.
Problem smooth(const std::string& batch) {
  return published(
      "sine[mode=learn,xi=2,network=mlp[layers=8,activation=tanh,precision=double],"
      "batch=" +
      batch + "]");
}

// What is known of a learned problem is the best loss of some run, which a longer one may better.
TEST(LearnedRuns, GoOnPastTheBestLossKnownWhereEveryToleranceIsToBePassed) {
  Problem problem = smooth("20");
  const Real start = run(problem, "adam", iterations(1)).trace->start_loss;
  problem.set_minimum(0.9 * start);
  const auto end = [&](Real target) {
    return run(problem, "adam[rate=0.01]", {.iterations = 300, .target = target}).trace->last;
  };
  EXPECT_EQ(end(0).iteration, 300);
  EXPECT_LT(end(0).loss, 0.9 * start);
  EXPECT_LT(end(1e-6).iteration, 300);
}

TEST(HalfInverse, KappaMinusOneIsGradientDescentOnANetwork) {
  for (const char* batch : {"1", "5", "60"})
    expect_near(run(smooth(batch), "hig[kappa=-1,cutoff=0,rate=1e-3]", iterations(5)).theta,
                run(smooth(batch), "gd[rate=1e-3]", iterations(5)).theta, 1e-10, batch);
}

// κ = 1 is 1/B of the step of Gauss-Newton.
TEST(HalfInverse, KappaOneIsGaussNewtonOnANetwork) {
  expect_near(first_step(smooth("1"), "hig[kappa=1,cutoff=0]"),
              first_step(smooth("1"), "gauss-newton"), 1e-10, "1");
  expect_near(4 * first_step(smooth("4"), "hig[kappa=1,cutoff=0]"),
              first_step(smooth("4"), "gauss-newton"), 1e-9, "4");
}

TEST(LevenbergMarquardt, LearnsFromFreshBatchesWideAndTall) {
  for (const char* batch : {"10", "60"}) {
    const Outcome result = run(smooth(batch), "levenberg-marquardt", iterations(150));
    EXPECT_LT(result.trace->last.loss, 0.05 * result.trace->start_loss) << batch;
  }
}

TEST(Rescaled, DirectionsByGradientAndByTruthAgreeOnANetworkOfOneOutput) {
  const Problem problem = published("exponential[mode=learn,batch=20]");
  EXPECT_EQ(run(problem, "rescaled", iterations(20)).theta,
            run(problem, "rescaled[by=truth]", iterations(20)).theta);
}

// The labels are drawn from all branches of the inverse sine, whose mean is none of them.
TEST(Supervised, FailsOnTheSineWhereSipDoesNot) {
  const Problem problem = published("sine[mode=learn,xi=4]");
  const Real supervised = run(problem, "supervised", iterations(1500)).trace->last.x_error;
  const Real sip =
      run(problem, "sip[inverse=newton,proxy=l1]", iterations(1500)).trace->last.x_error;
  EXPECT_GT(supervised, 20 * sip);
}

TEST(Libraries, LearnAPerceptronFromFiniteData) {
  const Problem problem = published("sine[mode=learn,xi=1,data=64]");
  for (const char* name : {"ceres-lbfgs", "nlopt-lbfgs"}) {
    const Outcome result = run(problem, name, iterations(100));
    EXPECT_LT(result.trace->last.loss, 0.1 * result.trace->start_loss) << name;
  }
}

TEST(TrainingMethods, LowerTheLossOfAPerceptron) {
  const Problem problem = published("sine[mode=learn,xi=1,network=mlp[layers=16-16],batch=30]");
  for (const auto& [spec, steps] : {std::pair{"adahessian", 200},
                                    {"hessian-free", 20},
                                    {"kfac[rate=0.1,damping=1]", 200},
                                    {"hig", 100},
                                    {"gauss-newton[rate=0.1,cutoff=1e-3]", 60},
                                    {"levenberg-marquardt", 60}}) {
    const Outcome result = run(problem, spec, iterations(steps));
    EXPECT_LT(result.trace->last.loss, 0.1 * result.trace->start_loss) << spec;
  }
}

}  // namespace
}  // namespace isoline::optimizers
