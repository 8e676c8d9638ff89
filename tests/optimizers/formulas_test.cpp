// Single methods against their formulas: self-scaled Broyden, Levenberg-Marquardt by products,
// gradient rules and baselines.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/decompose.h"
#include "optimizers/differences.h"
#include "optimizers/examination.h"
#include "optimizers/residual_curvature.h"
#include "optimizers/ssbroyden.h"
#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

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

TEST(SelfScaledBroyden, SolvesRosenbrockToRounding) {
  const Outcome result = run(make("rosenbrock"), "ssbroyden", iterations(60));
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
    const Problem problem = make(spec);
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
    const Problem problem = make(spec);
    const Budget budget{.iterations = 1000, .target = 0};
    const Outcome dense = run(problem, "levenberg-marquardt", budget);
    const Outcome products = run(problem, "levenberg-marquardt-cg", budget);
    const Real dense_loss = dense.trace->last.loss, loss = products.trace->last.loss;
    EXPECT_LE(loss, (1 + 1e-9) * dense_loss + 1e-12 * products.trace->start_loss) << spec;
    EXPECT_EQ(products.trace->last.counts[static_cast<std::size_t>(Oracle::jacobian)], 0) << spec;
  }
}

TEST(LevenbergMarquardtCg, TreatsProblemsTooLargeForAJacobian) {
  const Problem problem = make("heat[N=64]");
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

// Baselines on cases with a known answer.

Problem network(const std::string& batch) {
  return make(
      "sine[mode=learn,xi=2,network=mlp[layers=8-6,activation=tanh,precision=double],batch=" +
      batch + "]");
}

// J and r = y − y* of the batch that a problem starts with.
struct Linearized {
  Matrix J, g;
  Vector r, gradient;
};
Linearized linearized(const Problem& problem, const Vector& theta) {
  Point at;
  Linearized all;
  problem.forward(theta, at);
  problem.jacobian(all.J, at);
  all.r = (at.y - problem.target()).reshaped();
  all.g.resize(problem.outputs(), problem.samples());
  problem.cotangent(at, all.g);
  all.gradient = all.J.transpose() * all.g.reshaped();
  return all;
}

// Jᵀ (JJᵀ + λ)⁻¹ w, λ a share of the mean diagonal.
Vector damped_inverse(const Matrix& J, Real share, const Vector& w) {
  Matrix K = J * J.transpose();
  K.diagonal().array() += share * K.diagonal().mean();
  Vector solved;
  EXPECT_TRUE(solve_square(K, w, solved));
  return J.transpose() * solved;
}

TEST(FixedDamping, IsItsFormulaWideAndTall) {
  for (const char* batch : {"5", "80"})
    for (const char* factorization : {"auto", "orthogonal", "cholesky"}) {
      const Problem problem = network(batch);
      const Linearized at = linearized(problem, problem.start());
      const Vector theta = run(problem,
                               "levenberg-marquardt[damping=fixed,initial-damping=1e-2,rate=0.3,"
                               "factorization=" +
                                   std::string(factorization) + "]",
                               iterations(1))
                               .theta;
      expect_near(theta - problem.start(), -0.3 * damped_inverse(at.J, 1e-2, at.r), 1e-9,
                  factorization);
    }
}

// Wide by its layers, tall by JᵀJ; with a damping that squaring J alone would round to nothing.
TEST(LevenbergMarquardt, StepsAlikeByQrAndByCholesky) {
  for (const char* samples : {"40", "70"})  // 80 and 140 residuals for 92 unknowns
    for (const char* scaling : {"more", "none", "jacobian"})
      for (const char* damping : {"1e-2", "1e-6"}) {
        const Problem problem = network(std::string(samples) + ",data=" + samples);
        const std::string spec = std::string("levenberg-marquardt[initial-damping=") + damping +
                                 ",scaling=" + scaling + ",factorization=";
        expect_near(run(problem, spec + "cholesky]", iterations(5)).theta,
                    run(problem, spec + "orthogonal]", iterations(5)).theta, 1e-7, spec);
      }
}

TEST(LevenbergMarquardt, ScalesAsItIsAsked) {
  const Problem problem = network("5");
  const Linearized at = linearized(problem, problem.start());
  for (const char* scaling : {"more", "none", "jacobian"}) {
    const Vector D = std::string(scaling) == "none" ? Vector(Vector::Ones(at.J.cols()))
                                                    : Vector(at.J.colwise().norm().transpose());
    const Matrix A = at.J * D.cwiseInverse().asDiagonal();
    Matrix K = A * A.transpose();
    K.diagonal().array() += 0.1;
    Vector z;
    ASSERT_TRUE(solve_square(K, at.r, z));
    const std::string spec =
        std::string("levenberg-marquardt[initial-damping=0.1,scaling=") + scaling + "]";
    expect_near(run(problem, spec, iterations(1)).theta - problem.start(),
                -(A.transpose() * z).cwiseQuotient(D), 1e-10, scaling);
  }
}

// Above 900 residuals the default damping was taken for too small to square J, and each step for
// QR; and no Jacobian is formed where the layers are known.
TEST(LevenbergMarquardt, OfManyResidualsTakesTheGramMatrixOfTheLayers) {
  const Problem problem = make("poisson-hig[mode=learn,batch=16]");  // 1,024 residuals
  const Outcome fixed = run(problem, "levenberg-marquardt[damping=fixed]", iterations(1));
  EXPECT_NE(std::string(fixed.trace->claimed).find("Gram matrix"), std::string::npos);
  for (const char* spec : {"levenberg-marquardt", "levenberg-marquardt[damping=fixed]"}) {
    const OracleCounts counts = run(problem, spec, iterations(2)).trace->last.counts;
    EXPECT_EQ(counts[static_cast<std::size_t>(Oracle::jacobian)], 0) << spec;
    EXPECT_GT(counts[static_cast<std::size_t>(Oracle::layer_factors)], 0) << spec;
  }
}

TEST(Spring, IsFixedDampingWithoutMomentum) {
  const Problem problem = network("5");
  expect_near(run(problem, "spring[momentum=0,damping=1e-2,rate=0.3]", iterations(4)).theta,
              run(problem, "levenberg-marquardt[damping=fixed,initial-damping=1e-2,rate=0.3]",
                  iterations(4))
                  .theta,
              1e-12, "without momentum");
}

// On the same samples at both steps.
TEST(Spring, SecondStepIsItsFormula) {
  const Problem problem = network("5,data=5");
  const Linearized first = linearized(problem, problem.start());
  const Vector before = -damped_inverse(first.J, 1e-2, first.r);
  const Vector theta = problem.start() + 0.3 * before;
  const Linearized second = linearized(problem, theta);
  const Vector step =
      0.8 * before - damped_inverse(second.J, 1e-2, second.r + 0.8 * second.J * before);
  expect_near(run(problem, "spring[momentum=0.8,damping=1e-2,rate=0.3]", iterations(2)).theta,
              theta + 0.3 * step, 1e-10, "second");
}

// Five steps of Newton-Schulz act on singular values alone.
Real newton_schulz(Real x) {
  for (int i = 0; i < 5; ++i) x = 3.4445 * x - 4.7750 * std::pow(x, 3) + 2.0315 * std::pow(x, 5);
  return x;
}

TEST(Muon, FirstStepKeepsTheSingularVectorsOfTheGradient) {
  const Problem problem = network("20");
  const Vector gradient = linearized(problem, problem.start()).gradient;
  const Vector step = run(problem, "muon[rate=0.01]", iterations(1)).theta - problem.start();
  for (const Block& block : problem.layout()) {
    const auto of = [&](const Vector& v) -> Matrix {
      return v.segment(block.offset, block.rows * block.columns)
          .reshaped(block.rows, block.columns);
    };
    if (block.rows == 1 || block.columns == 1) {  // Adam's first step is by signs
      EXPECT_LE((of(step) + 0.01 * of(gradient).cwiseSign()).norm(), 1e-4) << block.offset;
      continue;
    }
    Svd svd;
    ASSERT_TRUE(thin_svd(of(gradient), svd));
    const Real norm = svd.sigma.norm();
    const Matrix expected =
        svd.U * (svd.sigma / norm).unaryExpr(&newton_schulz).asDiagonal() * svd.Vt;
    const Real length = 0.01 * 0.2 * std::sqrt(std::max(block.rows, block.columns));
    EXPECT_LE((of(step) + length * expected).norm(), 1e-10 * length) << block.offset;
  }
}

// From one gradient G = U Σ Vᵀ both preconditioners leave the orthogonal factor U Vᵀ; SOAP's first
// step fills its own, and the second has the same gradient.
TEST(Shampoo, FirstStepIsTheOrthogonalFactorOfTheGradient) {
  const Problem problem = learned_affine(6, 6);
  const Vector gradient = linearized(problem, problem.start()).gradient;
  Svd svd;
  ASSERT_TRUE(thin_svd(gradient.head(4).reshaped(2, 2), svd));
  const Matrix factor = svd.U * svd.Vt;
  EXPECT_EQ(run(problem, "soap", iterations(1)).theta, problem.start());
  for (const auto& [spec, steps] :
       {std::pair{"shampoo[rate=0.1,epsilon=1e-14]", 1}, {"soap[rate=0.1,epsilon=1e-9]", 2}}) {
    const Vector step = run(problem, spec, iterations(steps)).theta - problem.start();
    EXPECT_LE((step.head(4).reshaped(2, 2) + 0.1 * factor).norm(), 1e-6) << spec;
  }
  const Vector step =
      run(problem, "shampoo[rate=0.1,epsilon=1e-14]", iterations(1)).theta - problem.start();
  expect_near(step.tail(2), -0.1 * gradient.tail(2).normalized(), 1e-6, "a vector");
}

// L of a vector is the sum of its gradients' outer products: AdaGrad with its full matrix.
TEST(Shampoo, OfAVectorIsFullMatrixAdagrad) {
  const Problem problem = easy();
  Vector theta = problem.start();
  Matrix sum = 1e-4 * Matrix::Identity(2, 2);
  for (int i = 0; i < 4; ++i) {
    const Vector g = linearized(problem, theta).gradient;
    sum += g * g.transpose();
    SymmetricEigen eigen;
    ASSERT_TRUE(symmetric_eigen(sum, eigen));
    theta -= 0.1 * eigen.V * eigen.lambda.cwiseSqrt().cwiseInverse().asDiagonal() *
             eigen.V.transpose() * g;
  }
  expect_near(run(problem, "shampoo[rate=0.1,every=1]", iterations(4)).theta, theta, 1e-12,
              "four steps");
}

// Squares of gradients of 1e6 leave nothing of ε: what is rounding in their sum must not be raised
// to a power of −1/2.
TEST(Shampoo, StandsGradientsWhoseSquaresSwampEpsilon) {
  const Problem problem = make("variably-dimensioned");
  for (const char* spec : {"shampoo[rate=0.1]", "shampoo[rate=1]", "shampoo[rate=10]"}) {
    const Vector theta = run(problem, spec, iterations(50)).theta;
    Point at;
    problem.forward(theta, at);
    EXPECT_LT(at.loss, loss_at_start(problem)) << spec;
  }
}

// Without a basis of its own SOAP is Adam, of which the mean of squares decays alike, a step later.
TEST(Soap, IsAdamWithoutABasis) {
  const Problem problem = network("6,data=6");
  expect_near(run(problem, "soap[rate=0.01,longest=1,beta1=0.9,beta2=0.99]", iterations(11)).theta,
              run(problem, "adam[rate=0.01,beta1=0.9,beta2=0.99]", iterations(10)).theta, 1e-12,
              "adam");
}

// What another kernel of a library rounds otherwise stays rounding: no method makes a choice by it.
TEST(Rounding, StaysRoundingThroughThreeStepsOfEveryMethod) {
  for (const std::string samples : {"6", "20", "6,data=6"}) {
    const Problem problem = network(samples);
    RandomStream stream(1, "rounding", "start");
    const Vector nudge = stream.normal_vector(problem.unknowns());
    const Vector nudged = problem.start().array() * (1 + 4e-16 * nudge.array());
    for (const auto& [name, entry] : optimizers()) {
      if (!why_inapplicable(entry, options_of_spec(entry, name), problem).empty()) continue;
      if (samples == "6,data=6" && !entry.needs_same_samples) continue;
      const Vector one = run(problem, name, iterations(3)).theta,
                   other = run_from(nudged, problem, name, iterations(3)).theta;
      expect_near(one, other, 1e-8, name + ", " + samples);
    }
  }
}

TEST(Ceres, KeepsItsLastIterateWhereTheBudgetEndsWithinAnIteration) {
  const Problem problem = make("square");
  for (const char* method : {"ceres-lm", "ceres-gauss-newton", "ceres-dogleg", "ceres-bfgs"})
    for (std::int64_t work = 12; work < 18; ++work) {
      const Outcome ended = run(problem, method, {.iterations = 1000, .work = work, .target = 0});
      EXPECT_EQ(ended.status, Status::budget) << method << ", work " << work;
      EXPECT_LE(ended.trace->last.loss, 0.5 * ended.trace->start_loss)
          << method << ", work " << work;
      EXPECT_LE(ended.trace->last.work, work) << method;
    }
}

// At its default, an option is the library's own choice: the counts were taken before the libraries
// had any option here. Rounding moves those of other methods.
TEST(Libraries, StepAtTheirDefaultsAsWithoutOptions) {
  const std::map<std::string, Real> works{{"ceres-lm", 78}, {"ceres-dogleg", 47}};
  const Problem problem = make("rosenbrock");
  for (const auto& [name, work] : works) {
    const auto result = run(problem, name, {.iterations = 1000, .work = 2000});
    EXPECT_NEAR(static_cast<Real>(result.trace->last.work), work, 0.05 * work) << name;
  }
}

TEST(Libraries, TakeTheOptionThatIsTuned) {
  for (const auto& [name, entry] : optimizers()) {
    const std::string& option = entry.tunable.option;
    if (option.empty() || (!name.starts_with("ceres-") && !name.starts_with("nlopt-"))) continue;
    const Real standard = options_of_spec(entry, name).number(option, 0);
    const auto end = [&](const std::string& spec) {
      return run(make("rosenbrock"), spec, {.iterations = 10, .work = 200, .target = 0}).theta;
    };
    const std::string given = name + '[' + option + '=';
    EXPECT_EQ(end(given + std::to_string(standard) + ']'), end(name)) << name;
    EXPECT_NE(end(given + std::to_string(0.01 * standard) + ']'), end(name)) << name;
  }
}

TEST(Applicability, OfMethodsForNetworks) {
  for (const char* name : {"muon", "soap", "two-stage"}) {
    EXPECT_NE(why(name, easy()), "") << name;
    EXPECT_EQ(why(name, network("4")), "") << name;
  }
}

// y = J x with residuals that J does not reach, so that the solution is x = 0.
std::string doubt_at(const Matrix& J, const Vector& x, std::vector<bool> is_held = {}) {
  const std::vector<std::string> names{"k", "c"};
  Vector far = Vector::Zero(J.rows());
  far[J.rows() - 1] = 0.1;
  is_held.resize(static_cast<std::size_t>(x.size()));
  return doubt_of({.J = J,
                   .residual = J * x + far,
                   .theta = x,
                   .sizes = Vector::Ones(x.size()),
                   .is_held = is_held,
                   .names = names,
                   .size_of_y = 1,
                   .noise = std::numeric_limits<Real>::epsilon()});
}

TEST(Examination, ConfirmsASolutionAndNamesWhatSpeaksAgainstOne) {
  Matrix J = Matrix::Zero(4, 2);
  J.topRows(2) = Matrix::Identity(2, 2);
  EXPECT_EQ(doubt_at(J, Vector::Zero(2)), "");
  const Vector away = Vector::Unit(2, 1) * 1e-3;
  EXPECT_NE(doubt_at(J, away).find("moves c"), std::string::npos);
  EXPECT_EQ(doubt_at(J, away, {false, true}), "");  // a bound holds it
  J.col(1).setZero();
  EXPECT_NE(doubt_at(J, Vector::Zero(2)).find("c has no effect"), std::string::npos);
  J.col(1) = 2 * J.col(0);
  EXPECT_NE(doubt_at(J, Vector::Zero(2)).find("rank"), std::string::npos);
}

// Each update keeps what J knows of the steps before; Broyden's own would be 0.7 off here.
TEST(UpdatedJacobian, OfALinearMapIsExactAfterAStepForEachUnknown) {
  const Matrix A{{1, 2, 0}, {0, 1, 3}, {2, 0, 1}, {1, 1, 1}};
  const Vector zero = Vector::Zero(3), D{{1, 2, 0.5}};
  DifferenceJacobian J;
  Linearization at;
  J.know(zero, A * zero, Matrix::Ones(4, 3));
  for (const Vector& step : {Vector{{1, 0, 0}}, Vector{{1, 1, 0}}, Vector{{0, 1, 2}}})
    J.learn(step, A * step, D, at);
  EXPECT_LT((at.jacobian() - A).norm(), 1e-14);
}

// r = (x₁ − 1, x₂ + x₁², 3 + x₁x₂/2, …) leaves a residual: with S, steps shrink ever faster;
// without, by a factor.
TEST(ResidualCurvature, MakesStepsConvergeFasterThanGaussNewton) {
  const auto residual = [](const Vector& x) -> Vector {
    return Vector{{x[0] - 1, x[1] + x[0] * x[0], 3 + 0.5 * x[0] * x[1], 2 - std::sin(x[1])}};
  };
  const auto jacobian = [](const Vector& x) -> Matrix {
    return Matrix{{1, 0}, {2 * x[0], 1}, {0.5 * x[1], 0.5 * x[0]}, {0, -std::cos(x[1])}};
  };
  const auto slope_after = [&](int steps, bool bends) {
    ResidualCurvature curvature;
    Vector x{{0.4, -0.2}}, d;
    for (int i = 0; i < steps; ++i) {
      Matrix J = jacobian(x);
      const Vector b = -residual(x), D = J.colwise().norm();
      if (bends) curvature.measured(J, x, b);
      if (!curvature.solve(J, b, D, d)) least_squares(J, b, 1e-14, d);
      x += d;
    }
    return (jacobian(x).transpose() * residual(x)).norm();
  };
  EXPECT_LT(slope_after(9, true), 1e-10);
  EXPECT_GT(slope_after(9, false), 1e-4);
}

}  // namespace
}  // namespace isoline::optimizers
