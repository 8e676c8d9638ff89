// Figures of Moré, Garbow and Hillstrom's problems. Unless it says otherwise, a value was computed
// from the paper's definitions apart from this code, in rational or quadruple arithmetic.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

#include "make.h"
#include "problems/dense_physics.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

Real sum_of_squares_at_start(const std::string& spec) { return 2 * loss_at_start(make(spec)); }

constexpr Real kRelative = 1e-13;  // rounding in sums of a few squares

TEST(Classical, StandardStartsHaveThePublishedSumsOfSquares) {
  const std::vector<std::pair<std::string, Real>> published = {
      {"rosenbrock", 24.2},
      {"powell-singular", 215},
      {"brown-badly-scaled", 999998000002.999996000004},
      {"beale", 14.203125},
      {"helical-valley", 2500},
      {"box3d", 1031.153810609398349062066},
      {"wood", 19192},
      {"brown-dennis", 7926693.33699743238339864530217},
      {"variably-dimensioned", 2198551.1625},
      {"broyden-tridiagonal", 21}};
  for (const auto& [spec, f] : published)
    EXPECT_NEAR(sum_of_squares_at_start(spec), f, kRelative * f) << spec;
}

// The paper gives 85822.2; the digits are those of Newton's method in quadruple precision.
TEST(Classical, BrownAndDennisMinimumIsThePublishedOne) {
  const Problem problem = make("brown-dennis");
  EXPECT_NEAR(2 * *problem.minimum(), 85822.2016263563446606155957383, kRelative * 85822.2);
  EXPECT_FALSE(make("brown-dennis[m=10]").minimum().has_value());
}

TEST(Classical, TheGradientVanishesAtEveryDeclaredMinimizer) {
  for (const std::string spec :
       {"rosenbrock", "powell-singular", "beale", "helical-valley", "box3d", "wood", "brown-dennis",
        "variably-dimensioned", "broyden-tridiagonal", "broyden-tridiagonal[n=1000]"}) {
    const Problem problem = make(spec);
    // Rounding of residuals times J, against the gradient at the start.
    EXPECT_LE(gradient_at(problem, problem.truth()->reshaped()).norm(),
              1e-12 * gradient_at(problem, problem.start()).norm())
        << spec;
  }
}

TEST(Classical, ErrorInXIsTheDistanceToTheNearestSolution) {
  const Problem box = make("box3d");
  constexpr Real kTwoRoundings = 1e-15;
  EXPECT_NEAR(box.x_error(Eigen::Vector3d(1, 10, 1.5)), 0.5, kTwoRoundings);
  EXPECT_NEAR(box.x_error(Eigen::Vector3d(10, 1.25, -1)), 0.25, kTwoRoundings);
  EXPECT_NEAR(box.x_error(Eigen::Vector3d(30, 30, 0)), 0, kTwoRoundings);
  EXPECT_NEAR(box.x_error(Eigen::Vector3d(31, 30, 0)), std::sqrt(0.5), kTwoRoundings);
  EXPECT_NEAR(make("rosenbrock").x_error(Eigen::Vector2d(4, 5)), 5, kTwoRoundings);
  Point at;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(1, 10, 1), Eigen::Vector3d(10, 1, -1),
                                   Eigen::Vector3d(0.3, 0.3, 0), Eigen::Vector3d(7, 7, 0)}) {
    box.forward(x, at);
    EXPECT_LE(at.loss, 1e-30);  // ten residuals of rounding, squared
  }
}

TEST(PowellSingular, InverseTakesTheBranchNearestTheGuess) {
  const Problem problem = make("powell-singular");
  Point at;
  Matrix x(4, 1);
  for (const Eigen::Vector4d& solution :
       {Eigen::Vector4d(3, -1, 0, 1), Eigen::Vector4d(-3, 1, 0, -1), Eigen::Vector4d(3, -1, -1, 5),
        Eigen::Vector4d(1, 2, 0.5, 2)}) {
    problem.forward(solution, at);
    const Matrix y = at.y;
    problem.forward(solution + Vector::Constant(4, 0.01), at);
    EXPECT_TRUE(problem.local_inverse(y, x, at).all());
    EXPECT_LE((x - solution).norm(), 1e-13);  // rounding, amplified by a well-posed solve
  }
}

TEST(Classical, InverseFailsWhereNoInputReachesTheOutput) {
  const auto fails = [](const std::string& spec, const Vector& y) {
    const Problem problem = make(spec);
    Point at;
    problem.forward(problem.start(), at);
    Matrix x(problem.inputs(), 1);
    return !problem.local_inverse(y, x, at).any() && x.allFinite();
  };
  EXPECT_TRUE(fails("powell-singular", Eigen::Vector4d(0, 0, -1, 1)));
  EXPECT_TRUE(fails("powell-singular", Eigen::Vector4d(0, 0, 1, -1)));
  EXPECT_TRUE(fails("helical-valley", Eigen::Vector3d(0, -11, 0)));  // ρ < 0
  EXPECT_TRUE(fails("helical-valley", Eigen::Vector3d(-80, 0, 0)));  // θ = 0.8
}

TEST(HelicalValley, AngleIsContinuousExceptAcrossItsCut) {
  const Problem problem = make("helical-valley");
  Point left, right;
  constexpr Real kStep = 1e-9;
  problem.forward(Eigen::Vector3d(-kStep, 1, 0), left);
  problem.forward(Eigen::Vector3d(kStep, 1, 0), right);
  EXPECT_LE((left.y - right.y).norm(), 100 * kStep);  // ∂f1/∂x1 is 100/2π
  problem.forward(Eigen::Vector3d(-kStep, -1, 0), left);
  problem.forward(Eigen::Vector3d(kStep, -1, 0), right);
  EXPECT_NEAR(left.y(0, 0) - right.y(0, 0), -100, 1e-6);  // a whole turn
}

TEST(VariableDimension, AHundredThousandUnknownsAreServedByProductsAlone) {
  for (const std::string name : {"broyden-tridiagonal", "variably-dimensioned"}) {
    const Problem problem = make(name + "[n=100000]");
    Point at;
    Matrix g(problem.outputs(), 1);
    Vector gradient(problem.unknowns());
    problem.forward(problem.start(), at);
    problem.cotangent(at, g);
    problem.pullback(g, gradient, at);
    problem.pushforward(gradient, g, at);
    EXPECT_TRUE(g.allFinite()) << name;
    EXPECT_EQ(problem.x_error(*problem.truth()), 0) << name;
  }
}

// Laws and figures of the direct problems in closed form: scaling, exponential, sine.

// The book's loss is |P|², and half of that the one of all other problems here.
TEST(Scaling, HasTheBooksLossWhereItIsAskedFor) {
  EXPECT_EQ(loss_at_start(make("scaling[alpha=0.5]")), 9);  // ½ (3² + 3²)
  EXPECT_EQ(loss_at_start(make("scaling[alpha=0.5,loss=square]")), 18);
}

TEST(Scaling, ThePublishedStartInYIsTheSameForEveryAlpha) {
  Point reference, at;
  const Problem one = make("scaling[alpha=1]", 0);
  one.forward(one.start(), reference);
  for (const char* spec : {"scaling", "scaling[alpha=1e-3]", "scaling[alpha=1e3]"}) {
    const Problem problem = make(spec, 0);
    problem.forward(problem.start(), at);
    EXPECT_LE((at.y - reference.y).norm(), 1e-15);  // one division and one product
  }
}

TEST(Exponential, ThePublishedInstanceIsTheMiddleOfTheRange) {
  EXPECT_EQ(make("exponential").target()(0), std::exp(-6.0));
  const Vector truth = make("exponential[n=3]").truth()->col(0);
  EXPECT_LE((truth - Eigen::Vector3d(-2, -6, -10)).norm(), 1e-14);  // rounding
}

TEST(Exponential, InverseFailsWhereOutputsAreNotPositive) {
  const Problem problem = make("exponential[n=2]");
  Point at;
  Matrix x(2, 1);
  problem.forward(problem.start(), at);
  EXPECT_FALSE(problem.local_inverse(Eigen::Vector2d(1, -1), x, at).any());
  EXPECT_FALSE(problem.local_inverse(Eigen::Vector2d(0, 1), x, at).any());
  EXPECT_TRUE(x.allFinite());
}

// Computed from the formula apart from this code, in double.
TEST(Sine, LossAtAPointOfThePublishedLandscape) {
  const std::vector<std::pair<std::string, Real>> computed = {
      {"sine[xi=1,phi=15]", 13.040095459826832},
      {"sine", 2056.948806285901},
      {"sine[form=paper]", 2056.946330056514}};
  for (const auto& [spec, loss] : computed) {
    Point at;
    make(spec).forward(Eigen::Vector2d(0.6, 0.3), at);
    EXPECT_NEAR(at.loss, loss, 1e-14 * loss) << spec;  // rounding
  }
}

TEST(Sine, ErrorInXIsTheLeastOverAllSolutions) {
  constexpr Real gamma = 10, xi = 3, phi = 20 * std::numbers::pi / 180;
  RandomStream stream(1, "sine", "test");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make("sine[gamma=10,xi=3,phi=20]", seed);
    const Vector x = stream.uniform_vector(2, -2, 2);
    const Real u = problem.target()(0), z2 = problem.target()(1) / (gamma * xi);
    Real least = std::numeric_limits<Real>::infinity();
    for (int n = -9; n <= 9; ++n) {  // far beyond what |x| < 3 can be near
      const Real s = std::asin(u) + 2 * std::numbers::pi * n;
      const Real other = std::numbers::pi - std::asin(u) + 2 * std::numbers::pi * n;
      for (const Real z1 : {s * xi / gamma, other * xi / gamma}) {
        const Eigen::Vector2d solution(std::cos(phi) * z1 + std::sin(phi) * z2,
                                       -std::sin(phi) * z1 + std::cos(phi) * z2);
        least = std::min(least, (x - solution).norm());
      }
    }
    EXPECT_NEAR(problem.x_error(x), least, 1e-14);  // rounding
  }
}

// The published curve for ξ = 32 starts at 1.85; from x = 0, E|arcsin u| ξ/γ = 0.5708 · 3.2.
TEST(Sine, ErrorOfZeroIsWhereThePublishedCurveStarts) {
  constexpr int kSeeds = 4000;
  Real sum = 0;
  for (int seed = 1; seed <= kSeeds; ++seed)
    sum += make("sine[xi=32]", static_cast<std::uint64_t>(seed)).x_error(Vector::Zero(2));
  EXPECT_NEAR(sum / kSeeds, 1.8266, 0.09);  // four standard errors of 1.35/√4000
}

TEST(Sine, InverseFailsBeyondTheAmplitude) {
  for (const auto& [spec, amplitude] :
       {std::pair<std::string, Real>{"sine", 1}, {"sine[form=paper]", 0.1}}) {
    const Problem problem = make(spec);
    Point at;
    Matrix x(2, 1);
    problem.forward(problem.start(), at);
    EXPECT_TRUE(problem.local_inverse(Eigen::Vector2d(0.999 * amplitude, 1), x, at).all());
    EXPECT_FALSE(problem.local_inverse(Eigen::Vector2d(1.001 * amplitude, 1), x, at).any());
    EXPECT_TRUE(x.allFinite());
  }
}

// The scales of a loss and of an error in x are the problem's own, for every start that is drawn.

class Doubled final : public DensePhysics {
 public:
  Doubled() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y = 2 * x; }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 2; }
};

Real loss_scale(const Problem& problem) { return problem.loss_scale(problem.batch()); }
Real x_scale(const Problem& problem) { return problem.x_scale(problem.batch()); }

TEST(Scales, OfALossWithoutSignalIsThatOfTheStandardStart) {
  for (const char* name : {"rosenbrock", "beale", "wood", "square", "scaling"}) {
    const Real published = loss_scale(make(name));
    EXPECT_EQ(published, loss_at_start(make(name))) << name;
    for (const std::uint64_t seed : {1U, 2U, 3U})
      EXPECT_EQ(loss_scale(make(name, seed)), published) << name << ", seed " << seed;
  }
}

TEST(Scales, OfALossWithASignalIsThatOfNoOutput) {
  const Problem sine = make("sine");
  EXPECT_DOUBLE_EQ(loss_scale(sine), 0.5 * sine.target().squaredNorm());
  const Problem exponential = make("exponential");  // y* = e⁻⁶: its start is at y = 1
  EXPECT_DOUBLE_EQ(loss_scale(exponential), 0.5 * std::exp(-12));
  EXPECT_GT(loss_at_start(exponential), 1e4 * loss_scale(exponential));
}

TEST(Scales, OfALossThatDoesNotVanishIsItsLeast) {
  const Problem problem = make("brown-dennis", 3);
  EXPECT_EQ(loss_scale(problem), *problem.minimum());
}

TEST(Scales, OfALossIsWhatTheProblemDeclares) {
  const Problem problem({.physics = std::make_unique<Doubled>(),
                         .start = Vector::Ones(1),
                         .target = Matrix::Ones(1, 1),
                         .minimum = 0,
                         .scale = 7,
                         .x_error = [](BatchRef x, const Batch&) { return x.norm(); },
                         .x_scale = 5});
  EXPECT_EQ(loss_scale(problem), 7);
  EXPECT_EQ(x_scale(problem), 5);
  EXPECT_EQ(problem.x_floor(problem.batch()), 0);
}

// Seed 1002001 is instance 2 with start 1; its scales are those of the instance.
TEST(Seeds, APairHasTheTargetOfItsInstanceAndTheOffsetOfItsStart) {
  for (const auto& [name, entry] : all_problems().ready()) {
    if (!entry.in_all) continue;
    const Problem pair = make(name, 1'002'001), instance = make(name, 2), start = make(name, 1);
    if (pair.is_learned()) continue;
    EXPECT_EQ(pair.target(), instance.target()) << name;
    EXPECT_EQ(pair.truth(), instance.truth()) << name;
    EXPECT_EQ(pair.standard_start(), instance.standard_start()) << name;
    EXPECT_EQ(pair.loss_scale(pair.batch()), instance.loss_scale(instance.batch())) << name;
    EXPECT_NE(pair.start(), instance.start()) << name;
    if (instance.standard_start() == start.standard_start()) {
      EXPECT_EQ(pair.start(), start.start()) << name;
    }
    EXPECT_EQ(make(name, seed_of(0, 1)).target(), make(name, 0).target()) << name;
    EXPECT_EQ(make(name, seed_of(1, 0)).start(), make(name, seed_of(1, 0)).standard_start())
        << name;
  }
  EXPECT_EQ(Draw(7, "p").stream("target").uniform(), RandomStream(7, "p", "target").uniform());
}

TEST(Scales, OfXAreTheSolutionsNormOrThatOfTheStandardStart) {
  EXPECT_DOUBLE_EQ(x_scale(make("exponential")), 6);  // |log e⁻⁶|
  EXPECT_DOUBLE_EQ(x_scale(make("rosenbrock", 3)), std::sqrt(2));
  EXPECT_DOUBLE_EQ(x_scale(make("square", 3)), std::hypot(3, 3));  // x* = 0; the standard start
  const Problem poisson = make("poisson[N=8]", 2);
  EXPECT_DOUBLE_EQ(x_scale(poisson), poisson.truth()->norm());
}

TEST(Scales, OfALearningProblemAreMeansOverItsValidation) {
  const Problem problem = make("exponential[mode=learn]");
  Batch validation;
  problem.draw_validation(validation);
  EXPECT_DOUBLE_EQ(problem.x_scale(validation), validation.truth.cwiseAbs().mean());
  EXPECT_FALSE(problem.minimum().has_value());  // no network attains 0
}

// The floor from its definition: the singular value decomposition of J(x*), cut where values
// differ.
Real floor_by_svd(const Problem& problem) {
  Point at;
  problem.forward(problem.truth()->col(0), at);
  Matrix J;
  problem.jacobian(J, at);
  const Eigen::JacobiSVD<Matrix> svd(J, Eigen::ComputeThinV);
  const Vector missing = svd.matrixV().transpose() * (problem.start() - problem.truth()->col(0));
  const Vector& sigma = svd.singularValues();
  const Real unit = std::numeric_limits<Real>::epsilon() / 2;
  const Real noise = std::pow(unit * problem.target().norm(), 2) / Real(sigma.size());
  Real least = missing.norm(), kept = 0;
  for (Index i = 0; i < sigma.size(); ++i) {
    kept += noise / (sigma(i) * sigma(i));
    if (i + 1 < sigma.size() && sigma(i) < 1.5 * sigma(i + 1)) continue;
    least = std::min(least, std::sqrt(kept + missing.tail(sigma.size() - 1 - i).squaredNorm()));
  }
  return least;
}

// Singular values of some modes are a few times the rounding of the largest: their directions are
// right to a part of 10⁻⁴ or so.
TEST(Scales, HeatHasTheFloorOfTheBestSpectralCutOff) {
  for (const std::uint64_t seed : {0, 1, 2}) {
    const Problem problem = make("heat[N=8]", seed);
    const Real floor = problem.x_floor(problem.batch()), other = floor_by_svd(problem);
    EXPECT_NEAR(floor, other, 1e-3 * other) << seed;
    EXPECT_LT(floor, (problem.start() - problem.truth()->col(0)).norm());
    Point at;
    problem.forward(Vector::Zero(problem.unknowns()), at);
    Matrix x = Matrix::Zero(problem.inputs(), 1);
    problem.local_inverse(problem.target(), x, at);
    if (seed == 0) {
      EXPECT_LT(floor, (x - *problem.truth()).norm()) << "the damped inverse cannot move it";
    }
  }
  const Problem poisson = make("poisson[N=8]");
  EXPECT_EQ(poisson.x_floor(poisson.batch()), 0);
}

TEST(Scales, WhoSeeksXSaysSoAndKnowsIt) {
  for (const auto& [name, entry] : all_problems().ready()) {
    const Problem problem = make(name);
    EXPECT_EQ(problem.aim(), entry.aim) << name;
    if (entry.aim == Aim::x && !problem.is_learned()) {
      EXPECT_GT(x_scale(problem), 0) << name;
    }
  }
  EXPECT_EQ(all_problems().at("heat").aim, Aim::x);
  EXPECT_EQ(all_problems().at("rosenbrock").aim, Aim::loss);
}

}  // namespace
}  // namespace isoline::problems
