// Single methods against their formulas: self-scaled Broyden, Levenberg-Marquardt by products, and
// the gradient rules.
#include <gtest/gtest.h>

#include "core/decompose.h"
#include "optimizers/ssbroyden.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::Point;
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

TEST(SelfScaledBroyden, SolvesRosenbrockToRounding) {
  const Outcome result = run(published("rosenbrock"), "ssbroyden", iterations(60));
  EXPECT_LE(result.trace->last.loss, 1e-20);
}

TEST(SelfScaledBroyden, NeedsTheSameSamples) {
  EXPECT_NE(why("ssbroyden", learned_affine(4)), "");
  EXPECT_EQ(why("ssbroyden", learned_affine(4, 4)), "");
}

// Levenberg-Marquardt by products, against its definition and against the dense method.

// The first step from y, J and r formed: (JᵀJ + μ) d = −Jᵀr with μ = 10⁻⁴ ‖J g‖²/‖g‖². Conjugate
// gradients stop at a tenth, for η = 0.1 at the first point: of one unknown they are exact.
TEST(LevenbergMarquardtCg, TakesTheDampedStepToItsTolerance) {
  for (const char* spec : {"sine[xi=2]", "rosenbrock", "wood", "exponential[n=1]"}) {
    const Problem problem = published(spec);
    const Outcome outcome = run(problem, "levenberg-marquardt-cg", {.iterations = 1});
    const Vector step = outcome.theta - problem.start();
    Point at;
    problem.forward(problem.start(), at);
    Matrix J;
    problem.jacobian(J, at);
    const Vector g = J.transpose() * (at.y - problem.target()).reshaped();
    const Real mu = 1e-4 * (J * g).squaredNorm() / g.squaredNorm();
    if (outcome.trace->rejected_steps > 0) continue;
    const Vector left = J.transpose() * (J * step) + mu * step + g;
    EXPECT_LE(left.norm(), 0.1 * g.norm()) << spec;
    EXPECT_LT(step.dot(g), 0) << spec;
  }
}

TEST(LevenbergMarquardtCg, FindsWhatTheDenseMethodFinds) {
  for (const char* spec :
       {"rosenbrock", "beale", "helical-valley", "wood", "sine[xi=2]", "broyden-tridiagonal[n=20]",
        "coupled-oscillators[mode=direct]", "brown-dennis"}) {
    const Problem problem = published(spec);
    const Budget budget{.iterations = 1000, .target = 0};
    const Outcome dense = run(problem, "levenberg-marquardt", budget);
    const Outcome products = run(problem, "levenberg-marquardt-cg", budget);
    const Real dense_loss = dense.trace->last.loss, loss = products.trace->last.loss;
    EXPECT_LE(loss, (1 + 1e-9) * dense_loss + 1e-12 * products.trace->start_loss) << spec;
    EXPECT_EQ(products.trace->last.counts[static_cast<std::size_t>(Oracle::jacobian)], 0) << spec;
  }
}

TEST(LevenbergMarquardtCg, TreatsProblemsTooLargeForAJacobian) {
  const Problem problem = published("heat[N=64]");
  const Outcome outcome = run(problem, "levenberg-marquardt-cg", {.iterations = 10});
  EXPECT_LT(outcome.trace->last.loss, 1e-6 * outcome.trace->start_loss);
}

// Gradient rules from their formulas, ∇L = (4, −0.5) throughout.

// θ after `steps` equal gradients, from (1, 1).
Vector after(const std::string& spec, int steps) {
  const Eigen::Vector2d g(4, -0.5);
  Vector theta = Vector::Ones(2);
  const auto rule = make_descent(optimizers(), spec);
  rule->start(2);
  for (int i = 0; i < steps; ++i) rule->update(g, theta);
  return theta;
}

// What θ has moved after so many steps, worked by hand.
TEST(Rules, StepAsTheirFormulas) {
  const auto adadelta = [](Real g) { return -std::sqrt(1e-6 / (0.1 * g * g + 1e-6)) * g; };
  const Real slowed = 0.1 * (1 + std::sqrt(0.5));  // as the root of the steps
  struct Case {
    const char* spec;
    int steps;
    Real first, second;
  };
  for (const auto& [spec, steps, first, second] :
       {Case{"gd[rate=0.1]", 1, -0.4, 0.05},
        {"momentum[rate=0.1,momentum=0.9]", 1, -0.4, 0.05},
        {"momentum[rate=0.1,momentum=0.9]", 2, -0.4 * 2.9, 0.05 * 2.9},
        {"nesterov[rate=0.1,momentum=0.9]", 1, -0.4 * 1.9, 0.05 * 1.9},
        {"nesterov[rate=0.1,momentum=0.9]", 2, -0.4 * (1.9 + 2.71), 0.05 * (1.9 + 2.71)},
        {"adagrad[rate=0.1,epsilon=0]", 1, -0.1, 0.1},
        {"adagrad[rate=0.1,epsilon=0]", 2, -slowed, slowed},
        {"adam[rate=0.1,epsilon=0]", 1, -0.1, 0.1},
        {"adam[rate=0.1,epsilon=0]", 3, -0.3, 0.3},
        {"adamw[rate=0.1,epsilon=0,weight-decay=0]", 1, -0.1, 0.1},
        {"adamw[rate=0.1,epsilon=0,weight-decay=0.5]", 1, -0.1 - 0.05, 0.1 - 0.05},
        {"rmsprop[rate=0.1,alpha=0.75,epsilon=0]", 1, -0.2, 0.2},
        {"adadelta", 1, adadelta(4), adadelta(-0.5)}}) {
    const Vector theta = after(spec, steps);
    EXPECT_NEAR(theta[0], 1 + first, 1e-14) << spec << ", " << steps;  // rounding
    EXPECT_NEAR(theta[1], 1 + second, 1e-14) << spec << ", " << steps;
  }
}

TEST(Rules, DefaultsAreThoseOfPyTorch) {
  const auto standard = [](const std::string& name, const char* option) {
    const OptionValues options =
        complete_options(optimizers().at(name).options, name, OptionValues());
    return std::get<Real>(options.at(option));
  };
  EXPECT_EQ(standard("adam", "epsilon"), 1e-8);
  EXPECT_EQ(standard("adam", "beta2"), 0.999);
  EXPECT_EQ(standard("adamw", "weight-decay"), 1e-2);
  EXPECT_EQ(standard("rmsprop", "alpha"), 0.99);
  EXPECT_EQ(standard("adadelta", "rho"), 0.9);
  EXPECT_EQ(standard("adadelta", "epsilon"), 1e-6);
  EXPECT_EQ(standard("adagrad", "epsilon"), 1e-10);
}

// At 1 the mean would stay at zero, and its bias correction would divide 0 by 0.
TEST(Rules, ADecayOfOneIsRefused) {
  std::size_t refused = 0;
  for (const auto& [name, entry] : optimizers())
    for (const OptionField& option : entry.options)
      for (const std::string decay : {"beta1", "beta2", "rho", "alpha"})
        if (option.name == decay) {
          EXPECT_THROW(complete_options(entry.options, name, {{decay, 1.0}}), UsageError)
              << name << "[" << decay << "=1]";
          EXPECT_NO_THROW(complete_options(entry.options, name, {{decay, 0.0}}));
          ++refused;
        }
  EXPECT_GE(refused, 12U);
}

TEST(Rules, OnlyGradientRulesCanBeUsedInside) {
  EXPECT_THROW(make_descent(optimizers(), "newton"), UsageError);
}

}  // namespace
}  // namespace isoline::optimizers
