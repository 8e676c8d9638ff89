// Laws and figures of the direct problems in closed form: scaling, exponential, sine.
#include <gtest/gtest.h>

#include <numbers>

#include "make.h"

namespace isoline::problems {
namespace {

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

TEST(Exponential, OtherSeedsDrawTheLogarithmUniformly) {
  const Vector truth = make("exponential[n=10000]", 1).truth()->col(0);
  EXPECT_TRUE((truth.array() <= 0).all() && (truth.array() > -12).all());
  EXPECT_NEAR(truth.mean(), -6, 0.14);  // four standard errors, 12/√12/√10000 = 0.035
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

TEST(Sine, TheFormsAreOneWhereXiIsOne) {
  Point code, paper;
  make("sine[xi=1]").forward(Eigen::Vector2d(0.2, 0.7), code);
  make("sine[xi=1,form=paper]").forward(Eigen::Vector2d(0.2, 0.7), paper);
  EXPECT_EQ(code.y, paper.y);
}

}  // namespace
}  // namespace isoline::problems
