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

Matrix of_rows(Index n, std::initializer_list<Real> entries) {
  return Eigen::Map<const Matrix>(entries.begin(), n, n).transpose();
}

Vector of(std::initializer_list<Real> entries) {
  return Eigen::Map<const Vector>(entries.begin(), static_cast<Index>(entries.size()));
}

// The update as Urbán, Stefanou, Pons (2025) print it, worked out from its letters (h, b, a, ρ⁻,
// ρ⁺, θ, σ, φ, τ) in 40 digits by a program of its own, for each of its branches.
TEST(SelfScaledBroyden, UpdateIsThePublishedOne) {
  struct Case {
    std::string branch;
    Matrix H;
    Vector s, y;
    Matrix expected;
  };
  const Matrix H2 = of_rows(2, {2, 0.5, 0.5, 1});
  const Matrix H3 = of_rows(3, {2, 0.5, 0, 0.5, 1, 0.25, 0, 0.25, 3});
  const std::vector<Case> cases = {
      {"θ = −0.344, 1/b = 0.656 below 1", H2, of({1, 0.5}), of({0.25, 0.25}),
       of_rows(2,
               {3.3439153439153439, 0.65608465608465608, 0.65608465608465608, 1.3439153439153439})},
      {"θ = 1, which is DFP's φ = 0", H2, of({1, 0.5}), of({2, 1.5}),
       of_rows(2, {0.66115702479338843, -0.21487603305785124, -0.21487603305785124,
                   0.61983471074380165})},
      {"θ = −0.222 in three dimensions", H3, of({1, 0.5, -1}), of({0.5, 0.25, -0.125}),
       of_rows(3, {1.694801280865331, 0.37036374622005047, -0.48006738409857487,
                   0.37036374622005047, 1.2023119842237601, -0.1139210466722779,
                   -0.48006738409857487, -0.1139210466722779, 5.8518883702611447})},
      {"θ = 0.142, between BFGS and DFP", H3, of({1, 0.5, -1}), of({0.6, 0.4, -0.3}),
       of_rows(3, {1.4610223482034396, 0.29850152212666209, -0.013286607424238069,
                   0.29850152212666209, 0.93678435717750868, 0.17938218715666914,
                   -0.013286607424238069, 0.17938218715666914, 3.5459363680270829})}};
  for (const Case& each : cases) {
    Matrix H = each.H;
    Vector Bs, Hy, v;
    ASSERT_TRUE(solve_square(H, each.s, Bs));
    update_self_scaled(H, each.s, each.y, each.s.dot(Bs), Hy, v);
    // a = h b − 1 is a difference of numbers near 1, and θ divides by it.
    EXPECT_LE((H - each.expected).norm(), 1e-12 * each.expected.norm()) << each.branch;
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
