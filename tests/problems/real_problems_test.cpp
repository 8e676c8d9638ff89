// Inverse problems of other collections: deconvolution and the heat equation in one dimension, and
// the coefficient field of a Poisson equation.
#include <gtest/gtest.h>

#include <cmath>

#include "core/decompose.h"
#include "make.h"

namespace isoline::problems {
namespace {

Matrix image(const Problem& problem, const Vector& x) {
  Point at;
  problem.forward(x, at);
  return at.y;
}

// A wave on the circle keeps its form; its factor is the transform of the Gaussian, which is again
// one as long as the circle is much wider.
TEST(Deconvolution1d, DampsWavesByTheTransformOfAGaussian) {
  const Problem problem = make("deconvolution-1d");
  const Index N = problem.inputs();
  ASSERT_EQ(N, 128);
  for (const Real k : {0.0, 1.0, 3.0, 7.0}) {
    Vector wave(N);
    for (Index i = 0; i < N; ++i)
      wave[i] = std::cos(2 * kPi * k * static_cast<Real>(i) / static_cast<Real>(N) + 0.3);
    const Real factor = std::exp(-std::pow(2 * kPi * k * 10 / static_cast<Real>(N), 2) / 2);
    EXPECT_LE((image(problem, wave) - factor * wave).norm(), 1e-8 * wave.norm()) << k;
  }
  const Vector truth = problem.truth()->reshaped();
  EXPECT_NEAR(truth[127], std::sin(5 * kPi) / (5 * kPi), 1e-15);
  EXPECT_NEAR(truth.maxCoeff(), std::sin(5 * kPi / 127) / (5 * kPi / 127), 1e-15);
  EXPECT_NE(*make("deconvolution-1d", 1).truth(), *problem.truth());
}

// Against n explicit steps, one after the other.
TEST(Heat1d, IsEulersExplicitMethod) {
  const Problem problem = make("heat-1d[N=20,time=0.05]");
  const Index N = 20;
  const Real h = 1.0 / 21;
  const int steps = static_cast<int>(0.05 / (5.0 / 11 * h * h));
  const Real r = 0.05 / steps / (h * h);
  Vector u = problem.truth()->reshaped();
  for (int step = 0; step < steps; ++step) {
    Vector next = (1 - 2 * r) * u;
    next.head(N - 1) += r * u.tail(N - 1);
    next.tail(N - 1) += r * u.head(N - 1);
    u = next;
  }
  EXPECT_LE((image(problem, problem.truth()->reshaped()) - u).norm(), 1e-13 * u.norm());
  EXPECT_NEAR((*problem.truth())(9, 0), 10 * h * std::exp(-20 * h) * std::sin(1 - 10 * h), 1e-15);
}

// In the limit of fine grids the first mode decays as e^(−π²T), and T = 0.2 leaves few modes.
TEST(Heat1d, LeavesFewModes) {
  const Problem problem = make("heat-1d");
  Vector mode(128);
  for (Index i = 0; i < 128; ++i) mode[i] = std::sin(kPi * static_cast<Real>(i + 1) / 129);
  EXPECT_NEAR(image(problem, mode).norm() / mode.norm(), std::exp(-0.2 * kPi * kPi), 1e-4);
  const Real floor = problem.x_floor(problem.batch()), scale = problem.x_scale(problem.batch());
  EXPECT_GT(floor, 1e-3 * scale);
  EXPECT_LT(floor, 0.1 * scale);
}

// Where m depends on x₁ alone, u = x₂ at every point. Where it depends on x₂ alone, the flux is
// constant, but for the ends of the one row of squares whose triangles differ.
TEST(PoissonField, HasTheSolutionsOfOneDimension) {
  const Problem problem = make("poisson-field[N=16,points=50]");
  const Index N = 16, nodes = 17 * 17;
  const Matrix linear = image(problem, Vector::Zero(nodes));
  EXPECT_GE(linear.minCoeff(), 0.05);
  EXPECT_LE(linear.maxCoeff(), 0.95);
  Vector columns(nodes);
  for (Index i = 0; i < nodes; ++i) columns[i] = std::sin(static_cast<Real>(i % 17));
  EXPECT_LE((image(problem, columns) - linear).norm(), 1e-12);
  Vector layered(nodes);
  for (Index j = 0; j <= N; ++j) layered.segment(17 * j, 17).setConstant(j < N / 2 ? 0 : 2);
  // Of the rows of squares, seven have e⁰, eight e², and one its two triangles' mean.
  const Real middle = (std::exp(2.0 / 3) + std::exp(4.0 / 3)) / 2;
  const Real total = 7 + 8 * std::exp(-2) + 1 / middle;
  for (Index p = 0; p < 50; ++p) {
    const Real x2 = 16 * linear(p, 0);
    const Real expected = std::min(x2, 7.0) + std::clamp(x2 - 7, 0.0, 1.0) / middle +
                          std::max(x2 - 8, 0.0) * std::exp(-2);
    EXPECT_NEAR(image(problem, layered)(p, 0), expected / total, 2e-3) << p;
  }
}

TEST(PoissonField, HasExactProducts) {
  const Problem problem = make("poisson-field[N=8,points=20]", 1);
  const Vector m = problem.truth()->reshaped();
  const Matrix J = jacobian_at(problem, m);
  Point at;
  problem.forward(m, at);
  RandomStream stream(3, "poisson-field", "test");
  const Vector v = stream.normal_vector(m.size());
  Matrix Jv(20, 1);
  problem.pushforward(v, Jv, at);
  EXPECT_LE((Jv - J * v).norm(), 1e-12 * Jv.norm());
  const Real h = 1e-6;
  EXPECT_LE((Jv - (image(problem, m + h * v) - image(problem, m - h * v)) / (2 * h)).norm(),
            1e-7 * Jv.norm());  // rounding, over h
  EXPECT_LE((J * Vector::Ones(m.size())).norm(), 1e-12 * J.norm()) << "a constant changes nothing";
  EXPECT_NEAR(problem.x_error((m.array() + 5).matrix()), 0, 1e-12 * m.norm());
}

}  // namespace
}  // namespace isoline::problems
