// Figures of Moré, Garbow and Hillstrom's problems. Unless it says otherwise, a value was computed
// from the paper's definitions apart from this code, in rational or quadruple arithmetic.
#include <gtest/gtest.h>

#include "make.h"
#include "problems/dense_physics.h"

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
    Point at, start;
    Matrix g(problem.outputs(), 1);
    Vector gradient(problem.unknowns()), first(problem.unknowns());
    problem.forward(problem.start(), start);
    problem.cotangent(start, g);
    problem.pullback(g, first, start);
    problem.forward(problem.truth()->reshaped(), at);
    problem.cotangent(at, g);
    problem.pullback(g, gradient, at);
    // Rounding of residuals times J, against the gradient at the start.
    EXPECT_LE(gradient.norm(), 1e-12 * first.norm()) << spec;
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
}

TEST(Classical, AllDeclaredSolutionsOfBoxAreSolutions) {
  const Problem box = make("box3d");
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

}  // namespace
}  // namespace isoline::problems
