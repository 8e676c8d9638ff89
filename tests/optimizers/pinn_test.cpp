// Least squares over a physics-informed network: its Jacobian by layers whose samples have several
// lanes, and how far Levenberg-Marquardt gets.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decompose.h"
#include "optimizers/layered_jacobian.h"
#include "tests/optimizers/run.h"

namespace isoline::optimizers {
namespace {

constexpr const char* kWidePinn = "pinn-poisson[dimension=5,layers=20-9-6,interior=23,boundary=11]";

struct Assembled {
  explicit Assembled(const char* spec)
      : problem(make(spec)),
        meter(problem, iterations(1),
              {Oracle::forward, Oracle::pullback, Oracle::jacobian, Oracle::layer_factors},
              *trace) {
    Vector theta = problem.start();
    meter.begin(theta);
    meter.linearize(theta, at);
    layers.take(at);
    layers.order(problem.layout(), order);
    J = at.jacobian()(Eigen::all, order);  // in the order of the layers
  }
  Problem problem;
  std::unique_ptr<Trace> trace = std::make_unique<Trace>();
  Meter meter;
  Linearization at;
  LayeredJacobian layers;
  Eigen::Matrix<Index, Eigen::Dynamic, 1> order;
  Matrix J;  // (m·B, n)
};

constexpr Real kRounding = 1e-12;

TEST(Pinn, TheGramMatrixByLayersIsThatOfTheJacobian) {
  Assembled f(kWidePinn);
  const Matrix expected = (f.J * f.J.transpose()).triangularView<Eigen::Lower>();
  Matrix K;
  f.layers.gram(K);
  EXPECT_LE((K - expected).norm(), kRounding * expected.norm());
}

TEST(Pinn, WeightsAndColumnsByLayersAreThoseOfTheJacobian) {
  Assembled f(kWidePinn);
  RandomStream stream(0, "pinn", "test");
  const Vector w = stream.uniform_vector(f.J.cols(), 0.1, 2);
  const Matrix expected = (f.J * w.asDiagonal() * f.J.transpose()).triangularView<Eigen::Lower>();
  Matrix K;
  f.layers.weighted_gram(w, K);
  K = Matrix(K.triangularView<Eigen::Lower>());
  EXPECT_LE((K - expected).norm(), kRounding * expected.norm());
  Vector squares;
  f.layers.squared_columns(squares);
  const Vector columns = f.J.colwise().squaredNorm();
  EXPECT_LE((squares - columns).norm(), kRounding * columns.norm());
}

TEST(Pinn, ProductsByLayersAreThoseOfTheJacobian) {
  Assembled f(kWidePinn);
  RandomStream stream(0, "pinn", "test");
  constexpr Index kColumns = 19;  // more than are taken at once
  const Matrix Y = stream.normal_vector(f.J.rows() * kColumns).reshaped(f.J.rows(), kColumns);
  Matrix Z, JZ;
  f.layers.pullback(Y, Z);
  const Matrix expected = f.J.transpose() * Y;
  EXPECT_LE((Z - expected).norm(), kRounding * expected.norm());
  f.layers.pushforward(Z, JZ);
  EXPECT_LE((JZ - f.J * Z).norm(), kRounding * (f.J * Z).norm());
}

// Woodbury's form of the same step, by the layers and by the Jacobian.
TEST(Pinn, StepsByLayersAreThoseByTheJacobian) {
  const Problem problem = make(kWidePinn);
  for (const auto& [one, other] :
       {std::pair{"hig-damped[kappa=1,damping=1e-6,factorization=layers]",
                  "hig-damped[kappa=1,damping=1e-6,factorization=svd]"},
        {"levenberg-marquardt[factorization=cholesky]",
         "levenberg-marquardt[factorization=orthogonal]"},
        {"hig[factorization=split]", "hig[factorization=svd]"}})
    expect_near(first_step(problem, one), first_step(problem, other), 1e-7, one);
}

// λ in units of JJᵀ/B, as the paper on SPRING for these networks has it; all samples at each step.
TEST(Pinn, AnAbsoluteDampingIsAddedToTheMeanOfSquares) {
  Assembled f(kWidePinn);
  constexpr Real kDamping = 1e-2;
  const Vector r = (f.at.y() - f.meter.target()).reshaped();
  Matrix K = f.J * f.J.transpose();
  K.diagonal().array() += kDamping * static_cast<Real>(r.size());
  Vector solved;
  ASSERT_TRUE(solve_square(K, r, solved));
  Vector expected(f.J.cols());
  expected(f.order) = -0.3 * (f.J.transpose() * solved);
  for (const char* spec :
       {"levenberg-marquardt[damping=absolute,initial-damping=1e-2,rate=0.3]",
        "spring[damping-unit=absolute,damping=1e-2,rate=0.3]",
        "spring[damping-unit=absolute,damping=1e-2,rate=0.3,factorization=cholesky]"})
    expect_near(first_step(f.problem, spec), expected, 1e-9, spec);
}

// A damping so small that the default is QR: Cholesky is taken nevertheless, and says so.
TEST(Pinn, SpringIsByCholeskyWhereThatIsAsked) {
  const Problem problem = make(kWidePinn);
  const auto claim_of = [&](const std::string& options) {
    const auto trace = run(problem, "spring[damping=1e-12" + options + "]", iterations(2)).trace;
    return std::string(trace->claimed);
  };
  EXPECT_NE(claim_of("").find("QR"), std::string::npos);
  EXPECT_EQ(claim_of(",factorization=cholesky").find("QR"), std::string::npos);
}

TEST(Pinn, TheBoundOnAStepOfSpringShortensIt) {
  const Problem problem = make(kWidePinn);
  const Vector whole = first_step(problem, "spring[rate=0.5]");
  const Real length = whole.norm();
  expect_near(first_step(problem, fmt::format("spring[rate=0.5,longest-step={}]", length / 4)),
              whole / 4, 1e-9, "bound");
  expect_near(first_step(problem, fmt::format("spring[rate=0.5,longest-step={}]", 2 * length)),
              whole, 1e-12, "no bound");
}

TEST(Pinn, TheLineSearchTakesTheLengthWithTheLowestLoss) {
  const Problem problem = make("pinn-poisson[interior=49,boundary=40]");
  for (const std::string name : {"spring[damping=1e-3", "levenberg-marquardt[damping=fixed"}) {
    const Vector step = first_step(problem, name + "]");
    const Real length = first_step(problem, name + ",line-search=grid]").norm() / step.norm();
    Real best = 0, least = std::numeric_limits<Real>::infinity();
    for (int k = 0; k <= 30; ++k) {
      const Real loss = loss_at(problem, problem.start() + std::ldexp(1, -k) * step);
      if (loss < least) {
        least = loss;
        best = std::ldexp(1, -k);
      }
    }
    EXPECT_LT(best, 1) << name;  // the whole step is too long here
    EXPECT_NEAR(length, best, 1e-9 * best) << name;
  }
}

// The Gram matrix whose layers include one without inputs, for the viscosity.
TEST(Pinn, TheGramMatrixIncludesAnUnknownCoefficient) {
  Assembled f("pinn-burgers[layers=15-12,points=40]");
  const Matrix expected = (f.J * f.J.transpose()).triangularView<Eigen::Lower>();
  Matrix K;
  f.layers.gram(K);
  EXPECT_LE((K - expected).norm(), kRounding * expected.norm());
}

// From twenty times the viscosity; measurements of 1 % noise determine it to some percent.
TEST(Pinn, LevenbergMarquardtFindsAViscosityFromNoisyMeasurements) {
  const Problem problem =
      make("pinn-burgers[layers=12-12,points=400,viscosity=0.05,start-viscosity=1]");
  const auto found = run(problem, "levenberg-marquardt", iterations(80));
  EXPECT_LE(found.trace->last.x_error, 0.02);
  EXPECT_NEAR(std::exp(found.theta.tail(1)[0]), 0.05, 0.05 * 0.05);
}

// The independent trial that this repeats ended between 1.6e-6 and 3.1e-5.
TEST(Pinn, LevenbergMarquardtSolvesPoissonInTwoDimensionsFromEveryStart) {
  std::vector<Real> errors;
  for (const std::uint64_t seed : {0, 1, 2, 3, 4})
    errors.push_back(run(make("pinn-poisson", seed), "levenberg-marquardt", iterations(300))
                         .trace->last.x_error);
  std::ranges::sort(errors);
  EXPECT_LE(errors[3], 3e-5);
  EXPECT_LE(errors[4], 1e-4);
}

}  // namespace
}  // namespace isoline::optimizers
