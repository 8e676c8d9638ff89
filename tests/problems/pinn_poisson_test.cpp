// The network that solves Poisson's equation: its Laplacian, its points, its error.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "problems/problem.h"
#include "tests/problems/make.h"
#include "tests/refusal.h"

namespace isoline::problems {
namespace {

Vector random_theta(const Problem& problem) {
  RandomStream stream(0, "pinn-poisson", "test");
  return 0.5 * stream.normal_vector(problem.unknowns());
}

// One hidden layer: u = Σ cⱼ tanh tⱼ + e with t = W p + b, so Δu = Σ cⱼ |wⱼ|² tanh'' tⱼ.
TEST(PinnPoisson, LaplacianOfOneLayerIsThatOfTheClosedForm) {
  const Problem problem = make("pinn-poisson[dimension=5,layers=3,interior=20,boundary=10]");
  const Vector theta = random_theta(problem);
  const Matrix W = theta.head(15).reshaped(3, 5);
  const Vector b = theta.segment(15, 3), c = theta.segment(18, 3);
  Point at;
  problem.forward(theta, at);
  const Matrix& in = problem.batch().input;
  for (Index i = 0; i < in.cols(); ++i) {
    const Eigen::Array3d s = (W * in.col(i).head(5) + b).array().tanh();
    const Eigen::Array3d bend = -2 * s * (1 - s.square()) * W.rowwise().squaredNorm().array();
    EXPECT_NEAR(at.x()(0, i), c.dot(s.matrix()) + theta[21], 1e-14);
    EXPECT_NEAR(at.x()(1, i), i < 20 ? c.dot(bend.matrix()) : 0, 1e-14);
  }
}

TEST(PinnPoisson, LaplacianOfSeveralLayersIsThatOfDifferences) {
  const Problem problem = make("pinn-poisson[dimension=10,layers=6-5-4,interior=7,boundary=3]");
  const Vector theta = random_theta(problem);
  Point at;
  problem.forward(theta, at);
  const auto value_at = [&](const Matrix& in) -> Vector {
    Workspace w;
    Matrix x(2, in.cols());
    problem.network().forward(theta, in, x, w);
    return x.row(0);
  };
  constexpr Real kStep = 1e-3;
  const Matrix& in = problem.batch().input;
  Vector laplacian = -2 * 10 * value_at(in);
  for (Index i = 0; i < 10; ++i)
    for (const Real step : {kStep, -kStep}) {
      Matrix moved = in;
      moved.row(i).array() += step;
      laplacian += value_at(moved);
    }
  laplacian /= kStep * kStep;
  // h² of a fourth derivative, and ε/h² of rounding
  EXPECT_LE((at.x().row(1).head(7).transpose() - laplacian.head(7)).norm(),
            1e-5 * laplacian.head(7).norm());
  EXPECT_TRUE(at.x().row(1).tail(3).isZero(0));
}

// With the exact u and Δu, every residual is 0; the loss of u = 0 is that of the published weights.
TEST(PinnPoisson, ResidualsAreThoseOfTheEquationWithItsWeights) {
  const Problem problem = make("pinn-poisson");
  EXPECT_EQ(problem.unknowns(), 129);
  EXPECT_EQ(problem.residuals(), 904);
  const Batch& batch = problem.batch();
  Point at;
  problem.physics_forward(batch.truth, batch, at);
  EXPECT_LE(at.loss, 1e-28);
  EXPECT_EQ(problem.x_error(batch.truth), 0);
  problem.physics_forward(Matrix::Zero(2, 904), batch, at);
  Real squares = 0;
  for (Index b = 0; b < 784; ++b)
    squares += std::pow(
        2 * kPi * kPi * std::sin(kPi * batch.input(0, b)) * std::sin(kPi * batch.input(1, b)), 2);
  EXPECT_NEAR(at.loss, 0.5 * squares / 784, 1e-12 * squares);
  EXPECT_EQ(problem.x_error(Matrix::Zero(2, 904)), 1);
  Matrix raised = batch.truth;  // u raised by 0.1 on the boundary alone
  raised.row(0).tail(120).array() += 0.1;
  problem.physics_forward(raised, batch, at);
  EXPECT_NEAR(at.loss, 0.5 * 4 * 0.01, 1e-14);
}

TEST(PinnPoisson, PointsLieWhereTheyBelong) {
  for (const char* spec : {"pinn-poisson", "pinn-poisson[points=fixed]",
                           "pinn-poisson[dimension=5,layers=2,interior=90,boundary=60]",
                           "pinn-poisson[dimension=10,layers=2]"}) {
    const Problem problem = make(spec, 1);
    Batch validation;
    problem.draw_validation(validation);
    for (const Batch* batch : std::array<const Batch*, 2>{&problem.batch(), &validation}) {
      const Matrix points = batch->input.topRows(batch->input.rows() - 1);
      const auto sides = (points.array() == 0 || points.array() == 1).colwise().any();
      for (Index b = 0; b < points.cols(); ++b)
        EXPECT_EQ(sides(b), batch->input(points.rows(), b) == 0) << spec << ", point " << b;
      EXPECT_GE(points.minCoeff(), 0);
      EXPECT_LE(points.maxCoeff(), 1);
    }
  }
}

TEST(PinnPoisson, FreshPointsChangeFromStepToStepAndFixedOnesDoNot) {
  for (const auto& [spec, is_fresh] : {std::pair{"pinn-poisson", false},
                                       {"pinn-poisson[points=fixed]", false},
                                       {"pinn-poisson[points=fresh]", true},
                                       {"pinn-poisson[dimension=10,layers=2]", true}}) {
    const Problem problem = make(spec);
    EXPECT_EQ(problem.has_fresh_batches(), is_fresh) << spec;
    Batch first, second;
    problem.draw_batch(0, first);
    problem.draw_batch(1, second);
    EXPECT_EQ(first.input != second.input, is_fresh) << spec;
  }
}

TEST(PinnPoisson, HasThePublishedNetworks) {
  EXPECT_EQ(make("pinn-poisson[dimension=5,interior=9,boundary=5]").unknowns(), 10065);
  EXPECT_EQ(make("pinn-poisson[dimension=10]").unknowns(), 118145);
}

TEST(PinnPoisson, RefusesWhatItCannotBe) {
  for (const char* spec : {"pinn-poisson[dimension=3]", "pinn-poisson[interior=785]",
                           "pinn-poisson[dimension=5,points=grid]", "pinn-poisson[layers=32-]",
                           "pinn-poisson[layers=3a]", "pinn-poisson[mode=direct]"})
    EXPECT_FALSE(refusal([&] { make(spec); }).empty()) << spec;
}

}  // namespace
}  // namespace isoline::problems
