// What the formulas of the training methods promise of each other.
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

Vector first_step(const Problem& problem, const std::string& spec) {
  return run(problem, spec, iterations(1)).theta - problem.start();
}

void expect_near(const Vector& one, const Vector& other, Real tolerance, const std::string& what) {
  EXPECT_LE((one - other).norm(), tolerance * other.norm()) << what;
}

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

std::string why(const std::string& spec, const Problem& problem) {
  const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
  return why_inapplicable(entry, options_of_spec(entry, spec), problem);
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

TEST(Rescaled, DirectionsByGradientAndByTruthAgreeWhereAMonotonePHasOneInput) {
  const Problem problem = published("exponential");
  const Vector by_gradient = run(problem, "rescaled", iterations(3)).theta;
  EXPECT_EQ(by_gradient, run(problem, "rescaled[by=truth]", iterations(3)).theta);
  EXPECT_EQ(by_gradient[0], -3);
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

// Both paths of the same filter; J has condition 5, the Gram matrix 25.
TEST(HalfInverse, GramMatrixAndSingularValuesAgree) {
  for (const Index batch : {1, 2, 3, 20})  // wider and taller than square
    for (const char* kappa : {"-1", "0", "0.5", "1"}) {
      const std::string spec = std::string("hig[rate=0.1,kappa=") + kappa + ",cutoff=";
      expect_near(run(learned_affine(batch), spec + "1.01e-7]", iterations(5)).theta,
                  run(learned_affine(batch), spec + "0.99e-7]", iterations(5)).theta, 1e-9, spec);
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

// argmin ‖J d + r‖² + μ‖D d‖² by the normal equations, D the norms of J's columns.
TEST(LevenbergMarquardt, WideStepIsThatOfItsFormula) {
  constexpr Real kDamping = 0.1;
  const Problem problem = learned_affine(2, 2);
  Point at;
  problem.forward(problem.start(), at);
  Matrix J;
  problem.jacobian(J, at);
  ASSERT_LT(J.rows(), J.cols());
  const Vector D = J.colwise().norm();
  const Matrix scaled = J * D.cwiseInverse().asDiagonal();
  const Matrix K = scaled * scaled.transpose() + kDamping * Matrix::Identity(J.rows(), J.rows());
  const Vector r = (at.y - problem.target()).reshaped();
  Vector solved;
  ASSERT_TRUE(solve_square(K, r, solved));
  const Vector expected = -(scaled.transpose() * solved).cwiseQuotient(D);
  expect_near(first_step(problem, "levenberg-marquardt[initial-damping=0.1]"), expected, 1e-12,
              "damped");
}

TEST(LevenbergMarquardt, FollowsFreshSamples) {
  const Outcome result =
      run(learned_affine(3), "levenberg-marquardt", {.iterations = 60, .target = 1e-12});
  EXPECT_EQ(result.status, Status::target);
}

TEST(AdaHessian, DiagonalOfADiagonalHessianIsExact) {
  const Matrix M = Eigen::Vector3d(1, 2, 3).asDiagonal();
  const Problem problem = linear(M, Eigen::Vector3d(1, -2, 3), Vector::Zero(3));
  const Vector step = first_step(problem, "adahessian[rate=1,power=1,epsilon=0]");
  expect_near(step, -problem.start(), 1e-14, "Newton's step");
}

// Parameters that act one by one, but are laid out as two kernels of two taps, or as two modes of
// one pair of channels.
class Kernels final : public Network {
 public:
  explicit Kernels(Block::Kind kind) : kind_(kind) {}
  Index parameters() const override { return 4; }
  Index inputs() const override { return 0; }
  Index outputs() const override { return 4; }
  Vector start(RandomStream&) const override { return Vector::Ones(4); }
  std::vector<Block> layout() const override { return {{0, 2, 2, kind_}}; }
  void forward(VectorRef theta, BatchRef, BatchOut x, Workspace&) const override {
    x.col(0) = theta;
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace&) const override { Jv.col(0) = v; }
  void pullback(BatchRef u, VectorOut JTu, Workspace&) const override { JTu = u.col(0); }
  bool has_curvature() const override { return true; }
  void curvature(VectorRef, BatchRef, BatchRef du, VectorOut out, Workspace&) const override {
    out = du.col(0);
  }

 private:
  Block::Kind kind_;
};

// The curvatures, like the gradient, are 1, 4, 9, 16.
Problem kernels(Block::Kind kind) {
  const Matrix M = Eigen::Vector4d(1, 2, 3, 4).asDiagonal();
  return Problem({.physics = std::make_unique<Linear>(M),
                  .start = Vector::Ones(4),
                  .target = Vector::Zero(4),
                  .network = std::make_unique<Kernels>(kind),
                  .input = Matrix(0, 1),
                  .minimum = 0});
}
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

}  // namespace
}  // namespace isoline::optimizers
