// The network that finds a viscosity: its derivatives in the point, its residuals, its data.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "problems/burgers_flow.h"
#include "problems/cole_hopf.h"
#include "problems/problem.h"
#include "tests/problems/make.h"
#include "tests/refusal.h"

namespace isoline::problems {
namespace {

TEST(ColeHopf, HasTheSlopeOfTheLiterature) {
  // Basdevant et al. (1986): the largest slope for ν = 1/100π is 152.00516, at t = 1.6037/π.
  constexpr Real kStep = 1e-5;
  const Real u = cole_hopf(kStep, 1.6037 / kPi, 0.01 / kPi);
  EXPECT_NEAR(-u / kStep, 152.00516, 1e-3);
  EXPECT_NEAR(cole_hopf(0.3, 0, 0.01 / kPi), -std::sin(0.3 * kPi), 1e-14);
}

// The ring of `burgers` is [0, 1): with ξ = (x + 1)/2 and s = t/2, u_s + u u_ξ = ν/2 u_ξξ.
TEST(ColeHopf, IsTheFlowThatTheSimulationGives) {
  constexpr Index kFinest = 512;
  const auto error_of = [&](Index N) {
    const Real viscosity = 0.05;
    const BurgersFlow flow(N, 0, viscosity / 2, 0.3 / 2);
    Vector x(N), to(N);
    for (Index j = 0; j < N; ++j) x[j] = 2 * static_cast<Real>(j) / static_cast<Real>(N) - 1;
    const Vector from = -(kPi * x.array()).sin();
    flow.evolve(from, to);
    Real worst = 0;
    for (Index j = 0; j < N; ++j)
      worst = std::max(worst, std::abs(to[j] - cole_hopf(x[j], 0.3, viscosity)));
    return worst;
  };
  const Real fine = error_of(kFinest), coarse = error_of(kFinest / 2);
  EXPECT_LE(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.3);  // the simulation is of second order
}

TEST(PinnBurgers, DerivativesInThePointAreThoseOfDifferences) {
  const Problem problem = make("pinn-burgers[layers=6-5-4,points=9]");
  RandomStream stream(0, "pinn-burgers", "test");
  const Vector theta = 0.7 * stream.normal_vector(problem.unknowns());
  Point at;
  problem.forward(theta, at);
  const Matrix& in = problem.batch().input;
  const auto value_at = [&](Real dx, Real dt) -> Vector {
    Workspace w;
    Matrix x(problem.inputs(), in.cols()), moved = in;
    moved.row(0).array() += dx;
    moved.row(1).array() += dt;
    problem.network().forward(theta, moved, x, w);
    return x.row(0);
  };
  constexpr Real h = 1e-4;
  const Vector u = value_at(0, 0), u_x = (value_at(h, 0) - value_at(-h, 0)) / (2 * h),
               u_t = (value_at(0, h) - value_at(0, -h)) / (2 * h),
               u_xx = (value_at(h, 0) - 2 * u + value_at(-h, 0)) / (h * h);
  const Matrix& x = at.x();
  EXPECT_EQ(x.row(0).transpose(), u);
  EXPECT_LE((x.row(1).transpose() - u_x).norm(), 1e-6 * u_x.norm());
  EXPECT_LE((x.row(2).transpose() - u_t).norm(), 1e-6 * u_t.norm());
  EXPECT_LE((x.row(3).transpose() - u_xx).norm(), 1e-5 * u_xx.norm());
  EXPECT_TRUE((x.row(4).array() == theta[theta.size() - 1]).all());
}

// The exact u with its derivatives by differences leaves no residual at the true viscosity only.
TEST(PinnBurgers, ResidualsVanishForTheSolutionAtTheTrueViscosity) {
  constexpr Real kViscosity = 0.05, h = 1e-3;
  const Problem problem = make("pinn-burgers[layers=2,points=40,viscosity=0.05,sigma=0]");
  const Batch& batch = problem.batch();
  Matrix x(5, batch.samples());
  for (Index b = 0; b < batch.samples(); ++b) {
    const Real p = batch.input(0, b), t = batch.input(1, b) + h;  // where t − h is not negative
    const auto u = [&](Real dx, Real dt) { return cole_hopf(p + dx, t + dt, kViscosity); };
    x.col(b) << u(0, 0), (u(h, 0) - u(-h, 0)) / (2 * h), (u(0, h) - u(0, -h)) / (2 * h),
        (u(h, 0) - 2 * u(0, 0) + u(-h, 0)) / (h * h), std::log(kViscosity);
  }
  Point at;
  problem.physics_forward(x, batch, at);
  const Real exact = at.y.row(1).norm();
  x.row(4).array() += 0.1;
  problem.physics_forward(x, batch, at);
  EXPECT_LE(exact, 1e-3 * at.y.row(1).norm());
}

TEST(PinnBurgers, MeasuresWithTheNoiseAskedForAndJudgesWithoutIt) {
  const Problem problem = make("pinn-burgers[layers=2,sigma=0.05]", 1);
  EXPECT_EQ(problem.residuals(), 4000);
  const Batch& batch = problem.batch();
  const Vector noise = (batch.target.row(0) - batch.context.row(0)).transpose();
  EXPECT_NEAR(noise.norm() / std::sqrt(2000.0), 0.05, 0.003);  // 1/√4000 is 1.6 %
  EXPECT_TRUE(batch.target.row(1).isZero(0));
  for (const Index b : {0, 7, 1999}) {
    EXPECT_NEAR(batch.context(0, b), cole_hopf(batch.input(0, b), batch.input(1, b), 0.01 / kPi),
                1e-13);
    EXPECT_LE(std::abs(batch.input(0, b)), 1);
  }
  Matrix x = Matrix::Zero(5, batch.samples());
  EXPECT_NEAR(problem.x_error(x), 1, 1e-14);
  x.row(0) = batch.context.row(0);
  EXPECT_EQ(problem.x_error(x), 0);
}

TEST(PinnBurgers, RefusesWhatItCannotBe) {
  for (const char* spec : {"pinn-burgers[mode=direct]", "pinn-burgers[layers=20-]"})
    EXPECT_FALSE(refusal([&] { make(spec); }).empty()) << spec;
}

}  // namespace
}  // namespace isoline::problems
