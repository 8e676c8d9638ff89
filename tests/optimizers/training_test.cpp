// What the formulas of the training methods promise of each other, also on the multilayer
// perceptron, where short trainings end as the paper says.
#include <gtest/gtest.h>

#include "core/decompose.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using networks::Block;
using networks::Network;
using problems::Point;
using problems::Problem;
namespace {

// The same eigenvectors by other means: to rounding times the condition number of the Hessian.
TEST(Sip, ByNewtonIsSaddleFreeNewtonForTheIdentityNetwork) {
  for (const char* problem : {"sine[xi=1]", "sine", "rosenbrock", "exponential", "box3d"})
    for (int steps : {1, 5})
      expect_near(run(published(problem), "sip[inverse=newton]", iterations(steps)).theta,
                  run(published(problem), "saddle-free-newton", iterations(steps)).theta, 1e-9,
                  problem);
}

TEST(Sip, ByNewtonIsNewtonWhereTheLossIsConvexAndUnlimited) {
  expect_near(
      run(published("exponential"), "sip[inverse=newton,max-loss-change=1e9]", iterations(4)).theta,
      run(published("exponential"), "newton", iterations(4)).theta, 1e-14, "k = 1");
}

// S̄ is not below S where all are equal, and the published comparison is strict.
TEST(Sip, ByNewtonLimitsEqualCurvatures) {
  const Problem round = linear(Matrix::Identity(2, 2), Eigen::Vector2d(4, 0), Vector::Zero(2));
  EXPECT_NEAR(first_step(round, "sip[inverse=newton]")[0], -0.2 / 4, 1e-15);
  const Problem rounder = linear(Matrix::Identity(3, 3), Eigen::Vector3d(4, 0, 0), Vector::Zero(3));
  EXPECT_NEAR(first_step(rounder, "sip[inverse=newton]")[0], -0.2 / 4, 1e-15);
}

TEST(Sip, InnerStepsInvertAgainFromWhereTheLastEnded) {
  const Problem problem = published("sine");
  expect_near(run(problem, "sip[inverse=newton,inner-steps=4]", iterations(1)).theta,
              run(problem, "sip[inverse=newton]", iterations(4)).theta, 1e-15, "sine");
}

// The inverse is exact, so that each step of the one finds the x̃ that the other holds.
TEST(Sip, NetworkStepsGoTowardTheSameTarget) {
  const Problem problem = learned_affine(4, 4);
  expect_near(run(problem, "sip[network-steps=6]", iterations(1)).theta,
              run(problem, "sip", iterations(6)).theta, 1e-12, "six steps");
}

TEST(Sip, SaysWhichInverseAProblemLacks) {
  EXPECT_EQ(why("sip[inverse=damped]", published("heat[N=4]")), "");
  EXPECT_EQ(why("sip[inverse=damped]", published("sine")),
            "inverse=damped, and the physics has an inverse, but not a damped one");
  EXPECT_EQ(why("sip[inverse=damped]", published("box3d")), "the physics has no local inverse");
  EXPECT_EQ(why("sip[inverse=newton]", far_root()), "the problem offers no second derivatives");
  EXPECT_EQ(why("sip[inverse=newton]", published("exponential[n=9]")),
            "inverse=newton is for up to 8 inputs of the physics, which has 9");
}

TEST(Sip, RefusesABadNetworkOptimizer) {
  const OptimizerEntry& sip = optimizers().at("sip");
  for (const char* bad : {"adam[rate=-1]", "newton", "adan", "adam[rat=1]"})
    EXPECT_THROW(
        sip.make(complete_options(sip.options, "sip", {{"network-optimizer", bad}}), optimizers()),
        UsageError)
        << bad;
}

TEST(Supervised, WithAUnitStepIsSipWhereTheInverseIsUnique) {
  const Problem problem = learned_affine(4);
  expect_near(run(problem, "supervised", iterations(20)).theta,
              run(problem, "sip", iterations(20)).theta, 1e-12, "affine");
}

TEST(Truth, IsAPrivilege) {
  const Problem problem = learned_affine(4);
  for (const auto& [spec, count] : {std::pair{"supervised", 1U},
                                    {"rescaled[by=truth]", 1U},
                                    {"rescaled", 0U},
                                    {"sip[inverse=lbfgs]", 0U}}) {
    const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
    const OracleSet needs = needs_of(entry, options_of_spec(entry, spec), problem);
    EXPECT_EQ(privileges_of(needs, problem.inverse_kind()).size(), count) << spec;
  }
}

TEST(LeastSquares, WideJacobiansGiveTheShortestStep) {
  const Problem problem = learned_affine(1, 1);
  const Vector step = first_step(problem, "gauss-newton");
  expect_near(first_step(problem, "hig[kappa=1]"), step, 1e-12, "hig");
  // Scaled by D, and so not the shortest, but a solution too.
  Point at;
  problem.forward(
      problem.start() + first_step(problem, "levenberg-marquardt[initial-damping=1e-12]"), at);
  EXPECT_LE(at.loss, 1e-18);
}

TEST(AdaHessian, DiagonalOfADiagonalHessianIsExact) {
  const Matrix M = Eigen::Vector3d(1, 2, 3).asDiagonal();
  const Problem problem = linear(M, Eigen::Vector3d(1, -2, 3), Vector::Zero(3));
  const Vector step = first_step(problem, "adahessian[rate=1,power=1,epsilon=0]");
  expect_near(step, -problem.start(), 1e-14, "Newton's step");
}

// Two kernels of two taps, or two modes of one pair of channels.
Problem kernels(Block::Kind kind) { return separate({{0, 2, 2, kind}}); }
const Eigen::Vector4d kGradient(1, 4, 9, 16);

TEST(AdaHessian, AveragesTheTapsOfAKernel) {
  const Problem problem = kernels(Block::Kind::convolution);
  const Eigen::Vector4d mean(2.5, 2.5, 12.5, 12.5);
  const std::string spec = "adahessian[rate=1,power=1,epsilon=0";
  expect_near(first_step(problem, spec + "]"), -kGradient.cwiseQuotient(mean), 1e-14, "averaged");
  expect_near(first_step(problem, spec + ",average=false]"), -Vector::Ones(4), 1e-14, "each");
}

TEST(AdaHessian, AveragesTheModesOfAPairOfChannelsTheirRealAndImaginaryParts) {
  expect_near(first_step(kernels(Block::Kind::spectrum), "adahessian[rate=1,power=1,epsilon=0]"),
              -kGradient / 7.5, 1e-14, "averaged");
}

TEST(HessianFree, SolvesALinearLeastSquaresProblemAtOnceWithoutDamping) {
  const Problem problem = learned_affine(8, 8);
  Point at;
  problem.forward(run(problem, "hessian-free[damping=1e-14]", iterations(1)).theta, at);
  EXPECT_LE(at.loss, 1e-20);
}

TEST(HessianFree, LowersItsDampingWhileTheModelHolds) {
  const Outcome result =
      run(learned_affine(8), "hessian-free", {.iterations = 100, .target = 1e-10});
  EXPECT_EQ(result.status, Status::target);
  EXPECT_EQ(result.trace->rejected_steps, 0);
}

TEST(Libraries, NeedFiniteData) {
  for (const char* name : {"ceres-lbfgs", "nlopt-lbfgs", "ceres-lm", "nlopt-bobyqa"}) {
    EXPECT_NE(why(name, learned_affine(4)).find("data=N"), std::string::npos) << name;
    EXPECT_EQ(why(name, learned_affine(8, 8)), "") << name;
  }
}

TEST(Libraries, LearnFromFiniteData) {
  for (const char* name : {"ceres-lbfgs", "nlopt-lbfgs", "ceres-lm"}) {
    const Outcome result = run(learned_affine(8, 8), name, {.iterations = 200, .target = 1e-10});
    EXPECT_EQ(result.status, Status::target) << name;
  }
}

// --- on the multilayer perceptron

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

TEST(TrainingMethods, LowerTheLossOfAPerceptron) {
  const Problem problem = published("sine[mode=learn,xi=1,network=mlp[layers=16-16],batch=30]");
  for (const auto& [spec, steps] : {std::pair{"adahessian", 200},
                                    {"hessian-free", 20},
                                    {"kfac[rate=0.1,damping=1]", 200},
                                    {"hig", 100},
                                    {"gauss-newton[rate=0.1,cutoff=1e-3]", 60},
                                    {"levenberg-marquardt", 60},
                                    {"muon[rate=0.01]", 300},
                                    {"soap[rate=0.01]", 300},
                                    {"shampoo[rate=0.1]", 300},
                                    {"spring[rate=0.3]", 60},
                                    {"levenberg-marquardt[damping=fixed,initial-damping=1e-2]", 60},
                                    {"hig-damped", 100}}) {
    const Outcome result = run(problem, spec, iterations(steps));
    EXPECT_LT(result.trace->last.loss, 0.1 * result.trace->start_loss) << spec;
  }
}

}  // namespace
}  // namespace isoline::optimizers
