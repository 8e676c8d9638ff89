// The baselines on cases with a known answer.
#include <gtest/gtest.h>

#include <map>

#include "core/decompose.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using problems::Point;
using problems::Problem;
namespace {

Problem network(const std::string& batch) {
  return published(
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

Real start_loss(const Problem& problem) {
  Point at;
  problem.forward(problem.start(), at);
  return at.loss;
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
    for (const char* way : {"auto", "orthogonal", "cholesky"}) {
      const Problem problem = network(batch);
      const Linearized at = linearized(problem, problem.start());
      const Vector theta = run(problem,
                               "levenberg-marquardt[damping=fixed,initial-damping=1e-2,rate=0.3,"
                               "way=" +
                                   std::string(way) + "]",
                               iterations(1))
                               .theta;
      expect_near(theta - problem.start(), -0.3 * damped_inverse(at.J, 1e-2, at.r), 1e-9, way);
    }
}

// Wide by its layers, tall by JᵀJ; with a damping that squaring J alone would round to nothing.
TEST(LevenbergMarquardt, StepsAlikeByQrAndByCholesky) {
  for (const char* samples : {"40", "70"})  // 80 and 140 residuals for 92 unknowns
    for (const char* scaling : {"more", "none", "jacobian"})
      for (const char* damping : {"1e-2", "1e-6"}) {
        const Problem problem = network(std::string(samples) + ",data=" + samples);
        const std::string spec = std::string("levenberg-marquardt[initial-damping=") + damping +
                                 ",scaling=" + scaling + ",way=";
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
  const Problem problem = published("poisson-hig[mode=learn,batch=16]");  // 1,024 residuals
  const Outcome fixed = run(problem, "levenberg-marquardt[damping=fixed]", iterations(1));
  EXPECT_STREQ(fixed.trace->claimed, "steps by Cholesky of the Gram matrix");
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
  const Problem problem = published("variably-dimensioned");
  for (const char* spec : {"shampoo[rate=0.1]", "shampoo[rate=1]", "shampoo[rate=10]"}) {
    const Vector theta = run(problem, spec, iterations(50)).theta;
    Point at;
    problem.forward(theta, at);
    EXPECT_LT(at.loss, start_loss(problem)) << spec;
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
      EXPECT_LE((one - other).norm(), 1e-8 * one.norm()) << name << ", " << samples;
    }
  }
}

TEST(Ceres, KeepsItsLastIterateWhereTheBudgetEndsWithinAnIteration) {
  const Problem problem = published("square");
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
// had any option here.
TEST(Libraries, StepAtTheirDefaultsAsWithoutOptions) {
  const std::map<std::string, std::int64_t> works{
      {"ceres-lm", 78},      {"ceres-dogleg", 47},      {"ceres-ncg", 302},   {"ceres-bfgs", 80},
      {"nlopt-lbfgs", 50},   {"nlopt-var2", 52},        {"nlopt-slsqp", 107}, {"nlopt-tnewton", 68},
      {"nlopt-bobyqa", 171}, {"nlopt-neldermead", 186}, {"nlopt-sbplx", 260}};
  const Problem problem = published("rosenbrock");
  for (const auto& [name, work] : works)
    EXPECT_EQ(run(problem, name, {.iterations = 1000, .work = 2000}).trace->last.work, work)
        << name;
}

TEST(Libraries, TakeTheOptionThatIsTuned) {
  for (const auto& [name, entry] : optimizers()) {
    const std::string& option = entry.tunable.option;
    if (option.empty() || (!name.starts_with("ceres-") && !name.starts_with("nlopt-"))) continue;
    const Real standard = options_of_spec(entry, name).number(option, 0);
    const auto end = [&](const std::string& spec) {
      return run(published("rosenbrock"), spec, {.iterations = 30, .work = 200, .target = 0}).theta;
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

}  // namespace
}  // namespace isoline::optimizers
