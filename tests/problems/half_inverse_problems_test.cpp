// The oscillators of half-inverse gradients: their steps against an integration by another method,
// the inverse of the chain, and the published sizes; the particle in a box.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/decompose.h"
#include "make.h"
#include "problems/oscillators.h"
#include "problems/particle_in_a_box.h"

namespace isoline::problems {
namespace {

constexpr Forces kChain{.linear = 0.2, .cubic = 0, .gain = 1};
constexpr Forces kNonlinear{.linear = 0, .cubic = 1, .gain = 3};

Matrix random(Index rows, Index columns, std::string_view purpose) {
  return RandomStream(1, "oscillators", purpose)
      .normal_vector(rows * columns)
      .reshaped(rows, columns);
}

Matrix evolved(const Oscillators& physics, const Matrix& u, const Matrix& c) {
  Workspace w;
  Matrix y(4, u.cols());
  physics.forward(u, c, y, w);
  return y;
}

// The implicit midpoint rule, which shares nothing with Runge and Kutta's but the equation, and
// Richardson's extrapolation of it over four step sizes: of order 8.
Vector independent(const Forces& forces, const Vector& u, const Vector& state, Real dt) {
  const auto force = [&](const Vector& s, Real push) -> Vector {
    const Real away = s[1] - s[0], spring = forces.linear * away + forces.cubic * std::pow(away, 3);
    return Eigen::Vector4d(s[2], s[3], -s[0] + spring, -s[1] - spring + forces.gain * push);
  };
  std::array<Vector, 4> tableau;
  for (std::size_t level = 0; level < tableau.size(); ++level) {
    const int parts = 8 << level;
    const Real h = dt / parts;
    Vector s = state;
    for (const Real push : u)
      for (int part = 0; part < parts; ++part) {
        Vector middle = s;
        for (int i = 0; i < 40; ++i) middle = s + h / 2 * force(middle, push);  // contracts by h/2
        s = 2 * middle - s;
      }
    tableau[level] = s;
  }
  Real weight = 1;
  for (std::size_t order = 1; order < tableau.size(); ++order) {
    weight *= 4;  // the error has even powers of h alone
    for (std::size_t level = tableau.size() - 1; level >= order; --level)
      tableau[level] += (tableau[level] - tableau[level - 1]) / (weight - 1);
  }
  return tableau.back();
}

TEST(Oscillators, ApproachAnIndependentIntegrationAtFourthOrder) {
  for (const auto& [forces, steps, dt] :
       {std::tuple{kChain, Index{24}, 0.5}, {kNonlinear, Index{16}, 0.125}}) {
    const Vector c = random(4, 1, "state"), coarse = random(steps, 1, "control");
    const Vector reference = independent(forces, coarse, c, dt);
    std::array<Real, 4> errors{};
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const Index parts = Index(1) << i;  // of each interval
      const Vector u = coarse.transpose().replicate(parts, 1).reshaped();
      const Oscillators physics(forces, u.size(), dt / static_cast<Real>(parts));
      errors[i] = (evolved(physics, u, c) - reference).norm();
    }
    EXPECT_LT(errors[0], dt < 0.2 ? 1e-3 : 0.05);
    for (std::size_t i = 1; i < errors.size(); ++i)
      EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 4, 0.3) << i;  // the next order is O(Δt)
  }
}

TEST(Oscillators, LastAsLongInAnyNumberOfSteps) {
  for (const std::string name : {"linear-chain", "coupled-oscillators"}) {
    Point coarse, fine;  // from the same state under the same constant control
    make(name + "[steps=96]", 1).forward(Vector::Constant(96, 0.3), coarse);
    make(name + "[steps=192]", 1).forward(Vector::Constant(192, 0.3), fine);
    EXPECT_LT((coarse.y - fine.y).norm(), 1e-3) << name;
  }
}

TEST(Oscillators, GiveASampleTheSameBitsInWhateverBatch) {
  for (const Forces& forces : {kChain, kNonlinear}) {
    const Oscillators physics(forces, 12, 0.25);
    const Matrix u = random(12, 9, "control"), c = random(4, 9, "state");
    const Matrix y = evolved(physics, u, c);
    for (Index b = 0; b < 9; ++b) EXPECT_EQ(evolved(physics, u.col(b), c.col(b)), y.col(b)) << b;
  }
}

TEST(Oscillators, HaveThePublishedSizes) {
  const Problem chain = make("linear-chain[mode=learn]");
  EXPECT_EQ(chain.unknowns(), 1444);
  EXPECT_EQ(chain.residuals(), 128);
  const Problem nonlinear = make("coupled-oscillators[mode=learn]");
  EXPECT_EQ(nonlinear.unknowns(), 2956);
  EXPECT_EQ(nonlinear.residuals(), 512);
  EXPECT_TRUE(nonlinear.network().has_kinks());
  const Problem smooth = make(
      "coupled-oscillators[mode=learn,network=mlp[layers=20-20-20,activation=tanh,"
      "precision=double,init=glorot]]");
  EXPECT_EQ(smooth.unknowns(), 2956);
  EXPECT_FALSE(smooth.network().has_kinks());
}

// Published: 1.44 before training, of one start. Of 40 starts a tenth is below that at least, and a
// tenth above.
TEST(Oscillators, OfTheChainBeginAboutThePublishedLoss) {
  std::vector<Real> losses;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Problem problem = make("linear-chain[mode=learn,loss=square]", seed);
    Batch validation;
    problem.draw_validation(validation);
    Point at;
    problem.forward(problem.start(), validation, at);
    losses.push_back(at.loss);
  }
  std::ranges::sort(losses);
  EXPECT_LT(losses[4], 1.44);
  EXPECT_GT(losses[35], 1.44);
  EXPECT_GT(losses.front(), 0.3);
  EXPECT_LT(losses.back(), 8);
}

TEST(Oscillators, GoThroughTheSameSamplesEpochByEpoch) {
  const Problem problem = make("linear-chain[mode=learn,batch=8,epoch=24]", 1);
  std::array<Batch, 4> batches;
  for (std::size_t step = 0; step < batches.size(); ++step)
    problem.draw_batch(static_cast<std::int64_t>(step), batches[step]);
  EXPECT_EQ(batches[0].target, batches[3].target);
  EXPECT_NE(batches[0].target, batches[1].target);
  EXPECT_NE(batches[1].target, batches[2].target);
  Batch fresh;
  make("linear-chain[mode=learn,batch=8,epoch=0]", 1).draw_batch(3, fresh);
  EXPECT_NE(fresh.target, batches[0].target);
  EXPECT_TRUE(problem.has_fresh_batches());  // from step to step
  EXPECT_THROW(make("linear-chain[mode=learn,batch=7,epoch=24]"), UsageError);
}

TEST(LinearChain, PublishedLossIsTwiceTheHalfSquare) {
  EXPECT_EQ(loss_at_start(make("linear-chain[loss=square]", 1)),
            2 * loss_at_start(make("linear-chain", 1)));
}

// The inverse goes to the nearest control that returns: no shorter way, and no error in x there.
TEST(LinearChain, InverseIsTheNearestSolution) {
  const Problem problem = make("linear-chain", 3);
  Point at;
  const Vector u = random(24, 1, "far");
  problem.forward(u, at);
  Matrix found(24, 1), J;
  problem.local_inverse(problem.target(), found, at);
  problem.jacobian(J, at);
  const Vector step = found - u;
  Vector multiplier;
  ASSERT_TRUE(solve_square(J * J.transpose(), J * step, multiplier));
  EXPECT_LT((step - J.transpose() * multiplier).norm(), 1e-11 * step.norm());  // no part in ker J
  EXPECT_NEAR(problem.x_error(u), step.norm(), 1e-12 * step.norm());
  EXPECT_LT(problem.x_error(found), 1e-12);
}

// A network of dead neurons: it rectifies, and every bias keeps its neurons at zero.
TEST(Oscillators, CountDeadNeuronsAsSaturated) {
  const Problem problem = make("coupled-oscillators[mode=learn]", 1);
  const auto saturated = [&](const Vector& theta) -> Real {
    Point at;
    problem.forward(theta, at);
    Vector values(static_cast<Index>(problem.series().names.size()));
    problem.series().evaluate(problem, theta, at, values);
    EXPECT_EQ(values.tail(2), at.y.col(0).head(2));  // the path in y
    return values[2];
  };
  EXPECT_EQ(problem.series().names.at(2), "saturated neurons");
  EXPECT_LT(saturated(problem.start()), 20);
  Vector dead = problem.start();
  dead.segment(4 * 20, 20).setConstant(-100);  // biases of the first layer
  EXPECT_EQ(saturated(dead), 60);              // the other layers have zero biases
}

// The particle in a box: its energies, its steps against a dense solve, the response of the ground
// state in closed form, invariants and losses.

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
