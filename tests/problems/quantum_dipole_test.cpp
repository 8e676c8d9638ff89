// The particle in a box: its energies, its steps against a dense solve, the response of the ground
// state in closed form, what is kept, and the losses.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "make.h"
#include "problems/particle_in_a_box.h"

namespace isoline::problems {
namespace {

using Complex = std::complex<Real>;
using ComplexVector = Eigen::VectorXcd;
constexpr Index kPoints = ParticleInABox::kPoints, kSteps = ParticleInABox::kSteps;
constexpr Real kDx = 2.0 / 15, kDt = 0.05;
constexpr Complex kI(0, 1);

Real energy(Index k) {
  const Real s = std::sin(static_cast<Real>(k) * std::numbers::pi / 30);
  return 4 / (kDx * kDx) * s * s;
}

// (1 − iEΔt/2)/(1 + iEΔt/2), what a step does to a state of that energy.
Complex turn(Real E) { return (1.0 - kI * E * kDt / 2.0) / (1.0 + kI * E * kDt / 2.0); }

Vector control(Real size) {
  return RandomStream(1, "quantum-dipole", "control").normal_vector(kSteps) * size;
}

ComplexVector final_state(const Vector& u) {
  const ParticleInABox box(ParticleInABox::Output::state);
  Workspace w;
  Matrix y(2 * kPoints, 1);
  box.forward(u, Matrix(), y, w);
  return complex_of(y);
}

TEST(QuantumDipole, EnergiesAreThoseOfTheDiscreteBox) {
  const std::array published = {2.458, 9.726, 21.486};
  for (Index k = 1; k <= 3; ++k) {
    EXPECT_NEAR(energy(k), published[static_cast<std::size_t>(k - 1)], 5e-4) << "as printed";
    const Vector psi = ParticleInABox::eigenstate(k);
    EXPECT_NEAR(psi.norm(), 1, 1e-15);
    for (Index i = 0; i < kPoints; ++i) {  // −∂² by its stencil, against H itself below
      const Real beside = (i > 0 ? psi[i - 1] : 0) + (i + 1 < kPoints ? psi[i + 1] : 0);
      EXPECT_NEAR((2 * psi[i] - beside) / (kDx * kDx), energy(k) * psi[i], 1e-11);
    }
  }
}

TEST(QuantumDipole, WithoutAFieldTheGroundStateTurnsByItsEnergy) {
  const ComplexVector expected =
      ParticleInABox::eigenstate(1).cast<Complex>() * std::pow(turn(energy(1)), Real(kSteps));
  EXPECT_LT((final_state(Vector::Zero(kSteps)) - expected).norm(), 1e-12);
}

// Perturbation of first order: a field in step t lifts ψ₁ to ψ_k with the matrix element of x, and
// both turn by their energies before and after.
TEST(QuantumDipole, ResponseOfTheGroundStateHasTheEnergiesOfAllStates) {
  const ParticleInABox box(ParticleInABox::Output::state);
  Workspace w;
  w.x = Matrix::Zero(kSteps, 1);
  Matrix y(2 * kPoints, 1), J(2 * kPoints, kSteps);
  box.forward(w.x, Matrix(), y, w);
  box.jacobian(J, w);
  const Vector x = kDx * Vector::LinSpaced(kPoints, 1, kPoints);
  const Vector ground = ParticleInABox::eigenstate(1);
  for (Index k = 1; k <= kPoints; ++k) {
    const Vector psi = ParticleInABox::eigenstate(k);
    const Real element = psi.dot(x.cwiseProduct(ground));
    const Complex both = (1.0 + kI * energy(k) * kDt / 2.0) * (1.0 + kI * energy(1) * kDt / 2.0);
    for (Index t = 0; t < kSteps; t += 13) {
      const Complex expected = -kI * kDt * element / both *
                               std::pow(turn(energy(k)), Real(kSteps - 1 - t)) *
                               std::pow(turn(energy(1)), Real(t));
      const Complex found = psi.cast<Complex>().dot(ComplexVector(complex_of(J.col(t))));
      EXPECT_LT(std::abs(found - expected), 1e-12) << k << " " << t;
    }
  }
}

// x = A⁻¹ b by Gauss and Jordan, dense.
ComplexVector solved(Eigen::MatrixXcd A, ComplexVector b) {
  for (Index i = 0; i < A.rows(); ++i)
    for (Index r = 0; r < A.rows(); ++r) {
      if (r == i) continue;
      const Complex share = A(r, i) / A(i, i);  // diagonally dominant: no pivots
      A.row(r) -= share * A.row(i);
      b[r] -= share * b[i];
    }
  return b.cwiseQuotient(A.diagonal());
}

TEST(QuantumDipole, StepsAreThoseOfADenseSolve) {
  const Vector u = control(3);
  ComplexVector psi = ParticleInABox::eigenstate(1).cast<Complex>();
  for (const Real field : u) {
    Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(kPoints, kPoints);
    for (Index i = 0; i < kPoints; ++i) {
      H(i, i) = 2 / (kDx * kDx) + field * kDx * static_cast<Real>(i + 1);
      if (i > 0) H(i, i - 1) = H(i - 1, i) = -1 / (kDx * kDx);
    }
    const Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(kPoints, kPoints);
    const Eigen::MatrixXcd half = kI * kDt / 2.0 * H;
    psi = solved(one + half, (one - half) * psi);
  }
  EXPECT_LT((final_state(u) - psi).norm(), 1e-12);  // 384 steps of rounding
  EXPECT_NEAR(final_state(u).norm(), 1, 1e-12);
  EXPECT_NEAR(final_state(20 * u).norm(), 1, 1e-12);
  Workspace w;
  Matrix y(2 * kPoints, 1);  // in fewer steps
  ParticleInABox(ParticleInABox::Output::state, 96).forward(20 * u.head(96), Matrix(), y, w);
  EXPECT_NEAR(y.norm(), 1, 1e-12);
}

TEST(QuantumDipole, HasThePublishedSizeAndLoss) {
  const Problem problem = make("quantum-dipole[mode=learn]", 1);
  EXPECT_EQ(problem.unknowns(), 9484);
  EXPECT_EQ(problem.residuals(), 448);
  EXPECT_FALSE(problem.is_least_squares());
  Point at;
  problem.forward(problem.start(), at);
  EXPECT_NEAR(at.loss, 1, 5e-4);  // 1.000, as printed
  EXPECT_EQ(problem.network().inputs(), 28);
  const Matrix& target = problem.target();
  EXPECT_LT((target.colwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
  for (Index i = 0; i < kPoints; ++i) EXPECT_TRUE(target.row(2 * i + 1).isZero(0)) << "real";
}

TEST(QuantumDipole, TheResidualHasTheSameLossAndGradient) {
  for (const char* mode : {"", "mode=learn,batch=3,"}) {
    const Problem fidelity = make(std::string("quantum-dipole[") + mode + "epoch=0]", 1);
    const Problem residual =
        make(std::string("quantum-dipole[") + mode + "epoch=0,loss=residual]", 1);
    EXPECT_TRUE(residual.is_least_squares());
    const auto evaluate = [](const Problem& problem, Vector& gradient) -> Real {
      Point at;
      problem.forward(problem.start(), at);
      Matrix g(problem.outputs(), problem.samples());
      problem.cotangent(at, g);
      gradient.resize(problem.unknowns());
      problem.pullback(g, gradient, at);
      return at.loss;
    };
    Vector one, other;
    EXPECT_NEAR(evaluate(fidelity, one), evaluate(residual, other), 1e-12);
    EXPECT_LT((one - other).norm(), 1e-11 * one.norm());
    EXPECT_GT(one.norm(), 1e-6);  // the start is no saddle
  }
}

}  // namespace
}  // namespace isoline::problems
