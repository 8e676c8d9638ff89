// Burgers' equation: its steps against the exact solution of Cole (1951) and Hopf (1950), what they
// keep, their derivatives, and the simulation backward.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "make.h"
#include "problems/burgers_flow.h"

namespace isoline::problems {
namespace {

constexpr Real kWave = 2 * M_PI;

// u = −2ν φ'/φ, where φ is any positive solution of φ̇ = νφ'': here
// φ = 1 + A e^(−νk²t) cos ks + B e^(−4νk²t) sin 2ks.
Vector exact(Index N, Real viscosity, Real time) {
  constexpr Real A = 0.8, B = 0.15;
  const Real first = A * std::exp(-viscosity * kWave * kWave * time);
  const Real second = B * std::exp(-4 * viscosity * kWave * kWave * time);
  Vector u(N);
  for (Index j = 0; j < N; ++j) {
    const Real s = kWave * static_cast<Real>(j) / static_cast<Real>(N);
    const Real phi = 1 + first * std::cos(s) + second * std::sin(2 * s);
    const Real slope = kWave * (2 * second * std::cos(2 * s) - first * std::sin(s));
    u[j] = -2 * viscosity * slope / phi;
  }
  return u;
}

Vector evolved(const BurgersFlow& flow, const Vector& x) {
  Vector y(x.size());
  flow.evolve(x, y);
  return y;
}

Matrix states(Index N, Index samples) {
  Matrix x(N, samples);
  for (Index b = 0; b < samples; ++b)
    x.col(b) = *make("burgers[N=" + std::to_string(N) + "]", static_cast<std::uint64_t>(b)).truth();
  return x;
}

TEST(Burgers, ApproachesTheExactSolutionAtSecondOrder) {
  constexpr Real kViscosity = 0.03, kTime = 0.25;
  std::array<Real, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Index N = Index(32) << i;
    const BurgersFlow flow(N, 5 * N, kViscosity, kTime);  // Δt falls with h
    const Vector y = evolved(flow, exact(N, kViscosity, 0));
    errors[i] = (y - exact(N, kViscosity, kTime)).cwiseAbs().maxCoeff();
  }
  EXPECT_LT(errors[0], 0.02);
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 2, 0.15) << i;  // the next order is O(h²)
}

TEST(Burgers, IsOfSecondOrderInTimeAlone) {
  const Vector x = exact(32, 0.03, 0), fine = evolved(BurgersFlow(32, 1 << 14, 0.03, 0.25), x);
  std::array<Real, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = (evolved(BurgersFlow(32, Index(32) << i, 0.03, 0.25), x) - fine).norm();
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 2, 0.15) << i;  // the next order is O(Δt)
}

// Momentum to rounding; energy without viscosity but for Heun's third order, and less with it.
TEST(Burgers, KeepsMomentumAndEnergyAsTheEquationDoes) {
  const Vector x = states(64, 1).col(0).array() + 0.3;
  const Vector y = evolved(BurgersFlow(64, 0, 0.005, 0.25), x);
  EXPECT_NEAR(y.sum(), x.sum(), 1e-12 * x.cwiseAbs().sum());
  EXPECT_LT(y.squaredNorm(), 0.9 * x.squaredNorm());
  const auto gain = [&x](Index steps) {
    return evolved(BurgersFlow(64, steps, 0, 0.05), x).squaredNorm() / x.squaredNorm() - 1;
  };
  EXPECT_LT(std::abs(gain(16)), 1e-3);
  EXPECT_GT(std::abs(gain(16) / gain(32)), 6);  // 8 in the limit
}

TEST(Burgers, DerivativesAreThoseOfTheStepsForEverySample) {
  const BurgersFlow flow(16, 0, 0.005, 0.25);
  const Matrix x = states(16, 3);
  RandomStream stream(1, "burgers", "derivatives");
  const Matrix v = stream.normal_vector(48).reshaped(16, 3);
  const Matrix u = stream.normal_vector(48).reshaped(16, 3);
  Workspace w;
  Matrix y(16, 3), Jv(16, 3), JTu(16, 3);
  flow.forward(x, Matrix(), y, w);
  flow.pushforward(v, Jv, w);
  flow.pullback(u, JTu, w);
  const Real h = 1e-3;  // differences of fourth order leave h⁴ of a fifth derivative and ε/h
  for (Index b = 0; b < 3; ++b) {
    EXPECT_NEAR(u.col(b).dot(Jv.col(b)), v.col(b).dot(JTu.col(b)), 1e-12);  // of sums of order 1
    EXPECT_EQ(evolved(flow, x.col(b)), y.col(b));
    const auto at = [&](Real step) { return evolved(flow, x.col(b) + step * v.col(b)); };
    const Vector slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    EXPECT_LT((slope - Jv.col(b)).norm(), 1e-8 * Jv.col(b).norm()) << b;
  }
}

// Heun's steps of Δt and −Δt undo each other to fourth order, so all of them to third.
TEST(Burgers, RunBackwardWithoutViscosityGivesASmoothStateBack) {
  const Vector x = exact(64, 0.03, 0.2);
  std::array<Real, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const BurgersFlow flow(64, Index(16) << i, 0, 0.1);
    Vector back(64);
    flow.reverse(evolved(flow, x), back);
    errors[i] = (back - x).cwiseAbs().maxCoeff();
  }
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 3, 0.2) << i;  // the next order is O(Δt)
}

TEST(Burgers, LocalInverseStaysWhereYIsReached) {
  const Problem problem = make("burgers", 1);
  Point at;
  problem.forward(problem.start(), at);
  Matrix x(problem.inputs(), 1);
  EXPECT_TRUE(problem.local_inverse(at.y, x, at).all());
  EXPECT_LT((x - at.x()).norm(), 1e-13 * at.x().norm());
}

// From rest, again and again: each time it takes up some of what viscosity took.
TEST(Burgers, LocalInverseRepeatedComesCloserToTheStateSought) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Problem problem = make("burgers", seed);
    Matrix x = Matrix::Zero(problem.inputs(), 1);
    Point at;
    std::vector<Real> errors;
    for (int i = 0; i < 30; ++i) {
      problem.physics_forward(x, problem.batch(), at);
      EXPECT_TRUE(problem.local_inverse(problem.target(), x, at).all());
      errors.push_back((x - *problem.truth()).norm() / problem.truth()->norm());
    }
    EXPECT_LT(errors[0], 0.6) << seed;
    EXPECT_LT(errors[4], 0.7 * errors[0]) << seed;
    EXPECT_LT(errors[29], 0.7 * errors[4]) << seed;
  }
}

TEST(Burgers, TooFewStepsAreAUsageErrorThatSaysHowMany) {
  EXPECT_NO_THROW(make("burgers[N=128]"));
  EXPECT_NO_THROW(make("burgers[N=128,steps=64]"));
  try {
    make("burgers[N=128,steps=16]");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("steps must be at least 17, got 16"),
              std::string::npos)
        << error.what();
  }
  EXPECT_THROW(make("burgers[viscosity=-1]"), UsageError);
  EXPECT_THROW(make("burgers[time=0]"), UsageError);
}

}  // namespace
}  // namespace isoline::problems
