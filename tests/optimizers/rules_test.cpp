// First steps of the gradient rules, worked by hand from their formulas, ∇L = (4, −0.5) throughout.
#include <gtest/gtest.h>

#include "run.h"

namespace isoline::optimizers {
namespace {

constexpr Real kRounding = 1e-14;

// θ after `steps` equal gradients, from (1, 1).
Vector after(const std::string& spec, int steps) {
  const Eigen::Vector2d g(4, -0.5);
  Vector theta = Vector::Ones(2);
  const auto rule = make_descent(optimizers(), spec);
  rule->start(2);
  for (int i = 0; i < steps; ++i) rule->update(g, theta);
  return theta;
}

void expect_step(const std::string& spec, int steps, Real first, Real second) {
  const Vector theta = after(spec, steps);
  EXPECT_NEAR(theta[0], 1 + first, kRounding) << spec;
  EXPECT_NEAR(theta[1], 1 + second, kRounding) << spec;
}

TEST(Rules, GradientDescentIsRateTimesGradient) { expect_step("gd[rate=0.1]", 1, -0.4, 0.05); }

TEST(Rules, MomentumAddsUp) {
  expect_step("momentum[rate=0.1,momentum=0.9]", 1, -0.4, 0.05);
  expect_step("momentum[rate=0.1,momentum=0.9]", 2, -0.4 * 2.9, 0.05 * 2.9);
}

TEST(Rules, NesterovLooksAhead) {
  expect_step("nesterov[rate=0.1,momentum=0.9]", 1, -0.4 * 1.9, 0.05 * 1.9);
  expect_step("nesterov[rate=0.1,momentum=0.9]", 2, -0.4 * (1.9 + 2.71), 0.05 * (1.9 + 2.71));
}

TEST(Rules, FirstStepOfAdagradAndAdamIsRateTimesSign) {
  expect_step("adagrad[rate=0.1,epsilon=0]", 1, -0.1, 0.1);
  expect_step("adam[rate=0.1,epsilon=0]", 1, -0.1, 0.1);
  expect_step("adamw[rate=0.1,epsilon=0,weight-decay=0]", 1, -0.1, 0.1);
}

TEST(Rules, AdamStaysAtTheSignForEqualGradients) {
  expect_step("adam[rate=0.1,epsilon=0]", 3, -0.3, 0.3);
}

TEST(Rules, AdamwDecaysBeforeItSteps) {
  expect_step("adamw[rate=0.1,epsilon=0,weight-decay=0.5]", 1, -0.1 - 0.05, 0.1 - 0.05);
}

TEST(Rules, AdagradSlowsAsTheRootOfTheSteps) {
  expect_step("adagrad[rate=0.1,epsilon=0]", 2, -0.1 * (1 + std::sqrt(0.5)),
              0.1 * (1 + std::sqrt(0.5)));
}

TEST(Rules, FirstStepOfRmspropIsOverTheRootOfOneMinusAlpha) {
  expect_step("rmsprop[rate=0.1,alpha=0.75,epsilon=0]", 1, -0.2, 0.2);
}

TEST(Rules, FirstStepOfAdadeltaIsMadeByEpsilon) {
  const auto step = [](Real g) { return std::sqrt(1e-6 / (0.1 * g * g + 1e-6)) * g; };
  expect_step("adadelta", 1, -step(4), -step(-0.5));
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
