// The words of a model: fixed, tied and logarithmic unknowns, standard deviations, priors, starts.
#include "problems/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "problems/expression.h"
#include "problems/features.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

Problem modelled(const std::string& spec, const OptionValues& words, std::uint64_t seed = 0) {
  return with_features(make(spec, seed), words, Draw(seed, spec));
}
OptionValue text(const char* words) { return std::string(words); }

// 7 unknowns x1 … x7 and 37 data.
constexpr const char* kThurber = "nist[dataset=Thurber]";

std::string name(const Problem& problem, Index i) {
  return problem.names().empty() ? "x" + std::to_string(i + 1)
                                 : problem.names()[static_cast<std::size_t>(i)];
}

// log, fixed, tied, sigma and prior at once.
Problem full() {
  const Problem plain = make(kThurber);
  const auto x = [&](Index i) { return name(plain, i); };
  return modelled(kThurber, {{"log", x(0)},
                             {"fixed", x(1) + "=1400"},
                             {"tied", x(2) + " = " + x(0) + " / 3 + 10 * exp(-" + x(4) + ")"},
                             {"sigma", text("2")},
                             {"prior", x(2) + " = 400 ± 50"}});
}

TEST(Model, ResidualsAreThoseOfXOverSigmaAndOfPriors) {
  const Problem plain = make(kThurber), problem = full();
  ASSERT_EQ(problem.unknowns(), 5);
  ASSERT_EQ(problem.outputs(), plain.outputs() + 1);
  const Vector z = problem.start();
  EXPECT_DOUBLE_EQ(z[0], std::log(plain.start()[0]));
  const Vector x = problem.in_own_units(z);
  EXPECT_DOUBLE_EQ(x[0], plain.start()[0]);
  EXPECT_EQ(x[1], 1400);
  EXPECT_DOUBLE_EQ(x[2], x[0] / 3 + 10 * std::exp(-x[4]));
  Point at, at_x;
  Vector r(problem.residuals()), of_x(plain.residuals());
  problem.forward(z, at);
  problem.residual(at, r);
  plain.forward(x, at_x);
  plain.residual(at_x, of_x);
  EXPECT_LE((r.head(of_x.size()) - of_x / 2).norm(), 1e-13 * of_x.norm());
  EXPECT_DOUBLE_EQ(r[of_x.size()], (x[2] - 400) / 50);
  EXPECT_EQ(problem.noise_level(), std::sqrt(static_cast<Real>(plain.outputs())));
}

TEST(Model, ProductsAndSlopesAreThoseOfDifferencesAlsoOfScaledUnknowns) {
  for (const bool is_scaled : {false, true}) {
    const Problem problem = is_scaled ? with_scaled_unknowns(full()) : full();
    const Vector z = problem.start();
    Point at, moved;
    Matrix J;
    problem.forward(z, at);
    problem.jacobian(J, at);
    const Matrix S = problem.model_slopes(z);
    ASSERT_EQ(S.rows(), 7);
    for (Index j = 0; j < z.size(); ++j) {
      const Real h = 1e-6 * std::max<Real>(1e-3, std::abs(z[j]));
      Vector up = z, down = z;
      up[j] += h;
      down[j] -= h;
      problem.forward(up, moved);
      Matrix y = moved.y;
      problem.forward(down, moved);
      y = (y - moved.y) / (2 * h);
      EXPECT_LE((y - J.col(j)).norm(), 1e-6 * J.col(j).norm()) << j << is_scaled;
      const Vector x = (problem.in_own_units(up) - problem.in_own_units(down)) / (2 * h);
      EXPECT_LE((x - S.col(j)).norm(), 1e-6 * S.col(j).norm()) << j << is_scaled;
    }
    Vector g(z.size());
    const Matrix w = at.y - problem.target();
    problem.pullback(w, g, at);
    EXPECT_LE((g - J.transpose() * w).norm(), 1e-12 * g.norm());
  }
}

TEST(Model, WeightsAreFactorsAndSetNoLevelOfNoise) {
  const Problem plain = make(kThurber), weighted = modelled(kThurber, {{"weights", text("3")}});
  EXPECT_NEAR(loss_at(weighted, plain.start()), 9 * loss_at(plain, plain.start()),
              1e-12 * loss_at(weighted, plain.start()));
  EXPECT_FALSE(weighted.noise_level());
}

TEST(Model, RefusesNamesOrdersAndValuesThatDoNotFit) {
  for (const OptionValues& words :
       std::vector<OptionValues>{{{"fixed", text("none")}},
                                 {{"tied", text("x1 = x2; x2 = x1")}},
                                 {{"tied", text("x1 = 2 +")}},
                                 {{"prior", text("x1 = 1 ± 2")}},
                                 {{"sigma", text("0")}},
                                 {{"sigma", text("1;2;3;4;5")}},
                                 {{"sigma", text("1")}, {"weights", text("1")}},
                                 {{"starts", Index{5}}}})
    EXPECT_THROW(modelled("rosenbrock", words), UsageError);
}

TEST(Model, StartsAreALatinHypercubeOverTheBounds) {
  constexpr Index kStarts = 9;
  const OptionValues words = {{"bounds", text("wide")}, {"starts", kStarts}};
  const Problem first = modelled("nist[dataset=Misra1a]", words);
  EXPECT_EQ(first.start(), make("nist[dataset=Misra1a]").start());
  for (Index j = 0; j < first.unknowns(); ++j) {
    std::set<Index> cells;
    for (std::uint64_t seed = 1; seed < kStarts; ++seed) {
      // instance 0: the same data and bounds
      const Problem other = with_features(make("nist[dataset=Misra1a]"), words,
                                          Draw(seed_of(0, seed), "nist[dataset=Misra1a]"));
      const Bounds& box = *other.bounds();
      cells.insert(static_cast<Index>((kStarts - 1) * (other.start()[j] - box.lower[j]) /
                                      (box.upper[j] - box.lower[j])));
    }
    EXPECT_EQ(cells.size(), std::size_t{kStarts - 1});
  }
}

TEST(Expressions, HaveTheirValuesAndGradients) {
  const std::vector<std::string> names = {"a", "b_1"};
  const Vector x = (Vector(2) << 2, 3).finished();
  const auto value = [&](const char* words) { return Expression(words, names)(x); };
  EXPECT_EQ(value("-a^2 + 2 * b_1").value, 2);
  EXPECT_EQ(value("2^-1 / (a - b_1)").value, -0.5);
  const Expression::Value power = value("a ** b_1 * exp(log(sqrt(4)))");
  EXPECT_NEAR(power.value, 16, 1e-13);
  EXPECT_NEAR(power.by[0], 2 * 12, 1e-12);
  EXPECT_NEAR(power.by[1], 16 * std::log(2), 1e-12);
  for (const char* wrong : {"", "a +", "(a", "c", "a b_1", "sin a", "1..2"})
    EXPECT_THROW(value(wrong), UsageError) << wrong;
}

// A text of any length takes a bounded part of the stack.
TEST(Expressions, HaveAGreatestLengthAndDepth) {
  const std::vector<std::string> names = {"a"};
  const auto nested = [](std::size_t n) { return std::string(n, '(') + "a" + std::string(n, ')'); };
  EXPECT_EQ(Expression(nested(100), names)(Vector::Ones(1)).value, 1);
  EXPECT_THROW(Expression(nested(1000), names), UsageError);
  EXPECT_THROW(Expression(std::string(1000, '-') + "a", names), UsageError);
  std::string sum = "a";
  while (sum.size() <= 4096) sum += "+a";
  EXPECT_THROW(Expression(sum, names), UsageError);
}

// Of a logarithm h / x, of what is scaled h over its scale; one for each x, fixed ones as well.
TEST(Model, GivenStepsAreThoseOfX) {
  const GivenSteps absolute = given_steps("1:2:3:4:5:6:7 absolute"), relative = given_steps("0.1");
  const Problem problem = full();
  const Vector z = problem.start(), x = problem.in_own_units(z);
  EXPECT_DOUBLE_EQ(given_step(absolute, problem.physics(), z, 0, 1, 0), 1 / x[0]);
  EXPECT_EQ(given_step(absolute, problem.physics(), z, 1, 1, 0), 4)
      << "x₄, after a fixed and a tied one";
  EXPECT_EQ(given_step(relative, problem.physics(), z, 1, 5, 0), 0.5);
  const Problem scaled = with_scaled_unknowns(full());
  const Matrix S = scaled.model_slopes(scaled.start());
  EXPECT_DOUBLE_EQ(given_step(absolute, scaled.physics(), scaled.start(), 1, 1, 0),
                   4 / std::abs(S(3, 1)));
}

// What is tied has no value outside its bounds, and what is fixed none.
TEST(Model, BoundsHoldWhatIsTiedAndWhatIsFixed) {
  const auto with = [](const ModelWords& words) {
    ProblemParts parts = make("rosenbrock").parts();
    parts.bounds = Bounds{Vector{{-5, -5}}, Vector{{5, 1}}};
    return with_model(Problem(std::move(parts)), words, Draw(0, "rosenbrock"));
  };
  const Problem tied = with({.tied = "x2 = 2 * x1"});
  Point at;
  tied.forward(Vector{{0.4}}, at);
  EXPECT_TRUE(std::isfinite(at.loss));
  tied.forward(Vector{{0.6}}, at);
  EXPECT_FALSE(std::isfinite(at.loss));
  EXPECT_THROW(with({.fixed = "x2=5"}), UsageError);
}

}  // namespace
}  // namespace isoline::problems
