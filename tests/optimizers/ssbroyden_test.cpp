// Self-scaled Broyden: its update, its end on a quadratic, and what it is for.
#include "optimizers/ssbroyden.h"

#include <gtest/gtest.h>

#include "core/decompose.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {
namespace {

Matrix spread(Index n) {  // a convex quadratic of condition number 1e3
  Matrix A = Matrix::Constant(n, n, 0.1);
  for (Index i = 0; i < n; ++i) A(i, i) += std::pow(10, 3.0 * Real(i) / Real(n - 1));
  return A;
}

TEST(SelfScaledBroyden, UpdateMeetsTheSecantConditionAndStaysPositiveDefinite) {
  constexpr Index n = 6;
  RandomStream stream(1, "test", "update");
  Matrix H = spread(n);
  Vector Hy, v;
  for (int i = 0; i < 50; ++i) {
    const Vector s = stream.normal_vector(n);
    const Vector y = spread(n) * s + 0.5 * s.norm() * stream.normal_vector(n);
    if (y.dot(s) <= 0) continue;
    Vector Bs;
    ASSERT_TRUE(solve_square(H, s, Bs));
    update_self_scaled(H, s, y, s.dot(Bs), Hy, v);
    EXPECT_LE((H * y - s).norm(), 1e-9 * s.norm());
    EXPECT_LE((H - H.transpose()).norm(), 1e-12 * H.norm());
    SymmetricEigen eigen;
    ASSERT_TRUE(symmetric_eigen(H, eigen));
    EXPECT_GT(eigen.lambda[0], 0);
  }
}

// With exact searches Broyden's family makes conjugate directions, however it is scaled.
TEST(SelfScaledBroyden, EndsAQuadraticInAsManyExactStepsAsUnknowns) {
  constexpr Index n = 8;
  const Matrix A = spread(n);
  Vector x = Vector::Ones(n), Hy, v;
  Matrix H = Matrix::Identity(n, n);
  const Real before = (A * x).norm();
  for (Index i = 0; i < n; ++i) {
    const Vector g = A * x, d = -(H * g);
    const Real length = -g.dot(d) / d.dot(A * d);
    const Vector s = length * d, y = A * s;
    x += s;
    update_self_scaled(H, s, y, -length * g.dot(s), Hy, v);
  }
  EXPECT_LE((A * x).norm(), 1e-9 * before);
}

TEST(SelfScaledBroyden, SolvesRosenbrockToRounding) {
  const Outcome result = run(published("rosenbrock"), "ssbroyden", iterations(60));
  EXPECT_LE(result.trace->last.loss, 1e-20);
}

TEST(SelfScaledBroyden, NeedsTheSameSamples) {
  const OptimizerEntry& entry = optimizers().at("ssbroyden");
  EXPECT_NE(why_inapplicable(entry, options_of_spec(entry, "ssbroyden"), learned_affine(4)), "");
  EXPECT_EQ(why_inapplicable(entry, options_of_spec(entry, "ssbroyden"), learned_affine(4, 4)), "");
}

}  // namespace
}  // namespace isoline::optimizers
