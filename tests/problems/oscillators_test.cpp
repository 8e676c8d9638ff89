// The oscillators of half-inverse gradients: their steps against an integration by another method,
// the chain's inverse, and the published sizes.
#include "problems/oscillators.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/decompose.h"
#include "make.h"

namespace isoline::problems {
namespace {

constexpr Forces kChain{.linear = 0.2, .cubic = 0, .gain = 1};
constexpr Forces kNonlinear{.linear = 0, .cubic = 1, .gain = 3};

Matrix random(Index rows, Index columns, std::string_view purpose) {
  return RandomStream(1, "oscillators", purpose)
      .normal_vector(rows * columns)
      .reshaped(rows, columns);
}

Matrix evolved(const Oscillators& physics, const Matrix& u, const Matrix& c) {
  Workspace w;
  Matrix y(4, u.cols());
  physics.forward(u, c, y, w);
  return y;
}

// The implicit midpoint rule, which shares nothing with Runge and Kutta's but the equation, and
// Richardson's extrapolation of it over four step sizes: of order 8.
Vector independent(const Forces& forces, const Vector& u, const Vector& state, Real dt) {
  const auto force = [&](const Vector& s, Real push) -> Vector {
    const Real away = s[1] - s[0], spring = forces.linear * away + forces.cubic * std::pow(away, 3);
    return Eigen::Vector4d(s[2], s[3], -s[0] + spring, -s[1] - spring + forces.gain * push);
  };
  std::array<Vector, 4> tableau;
  for (std::size_t level = 0; level < tableau.size(); ++level) {
    const int parts = 8 << level;
    const Real h = dt / parts;
    Vector s = state;
    for (const Real push : u)
      for (int part = 0; part < parts; ++part) {
        Vector middle = s;
        for (int i = 0; i < 40; ++i) middle = s + h / 2 * force(middle, push);  // contracts by h/2
        s = 2 * middle - s;
      }
    tableau[level] = s;
  }
  Real weight = 1;
  for (std::size_t order = 1; order < tableau.size(); ++order) {
    weight *= 4;  // the error has even powers of h alone
    for (std::size_t level = tableau.size() - 1; level >= order; --level)
      tableau[level] += (tableau[level] - tableau[level - 1]) / (weight - 1);
  }
  return tableau.back();
}

TEST(Oscillators, ApproachAnIndependentIntegrationAtFourthOrder) {
  for (const auto& [forces, steps, dt] :
       {std::tuple{kChain, Index{24}, 0.5}, {kNonlinear, Index{16}, 0.125}}) {
    const Vector c = random(4, 1, "state"), coarse = random(steps, 1, "control");
    const Vector reference = independent(forces, coarse, c, dt);
    std::array<Real, 4> errors{};
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const Index parts = Index(1) << i;  // of each interval
      const Vector u = coarse.transpose().replicate(parts, 1).reshaped();
      const Oscillators physics(forces, u.size(), dt / static_cast<Real>(parts));
      errors[i] = (evolved(physics, u, c) - reference).norm();
    }
    EXPECT_LT(errors[0], dt < 0.2 ? 1e-3 : 0.05);
    for (std::size_t i = 1; i < errors.size(); ++i)
      EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 4, 0.3) << i;  // the next order is O(Δt)
  }
}

TEST(Oscillators, LastAsLongInAnyNumberOfSteps) {
  for (const std::string name : {"linear-chain", "coupled-oscillators"}) {
    Point coarse, fine;  // from the same state under the same constant control
    make(name + "[steps=96]", 1).forward(Vector::Constant(96, 0.3), coarse);
    make(name + "[steps=192]", 1).forward(Vector::Constant(192, 0.3), fine);
    EXPECT_LT((coarse.y - fine.y).norm(), 1e-3) << name;
  }
}

TEST(Oscillators, GiveASampleTheSameBitsInWhateverBatch) {
  for (const Forces& forces : {kChain, kNonlinear}) {
    const Oscillators physics(forces, 12, 0.25);
    const Matrix u = random(12, 9, "control"), c = random(4, 9, "state");
    const Matrix y = evolved(physics, u, c);
    for (Index b = 0; b < 9; ++b) EXPECT_EQ(evolved(physics, u.col(b), c.col(b)), y.col(b)) << b;
  }
}

TEST(Oscillators, HaveThePublishedSizes) {
  const Problem chain = make("linear-chain[mode=learn]");
  EXPECT_EQ(chain.unknowns(), 1444);
  EXPECT_EQ(chain.residuals(), 128);
  const Problem nonlinear = make("coupled-oscillators[mode=learn]");
  EXPECT_EQ(nonlinear.unknowns(), 2956);
  EXPECT_EQ(nonlinear.residuals(), 512);
  EXPECT_TRUE(nonlinear.network().has_kinks());
  const Problem smooth = make(
      "coupled-oscillators[mode=learn,network=mlp[layers=20-20-20,activation=tanh,"
      "precision=double,init=glorot]]");
  EXPECT_EQ(smooth.unknowns(), 2956);
  EXPECT_FALSE(smooth.network().has_kinks());
}

// Published: 1.44 before training, of one start. Of 40 starts a tenth is below that at least, and a
// tenth above.
TEST(Oscillators, OfTheChainBeginAboutThePublishedLoss) {
  std::vector<Real> losses;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Problem problem = make("linear-chain[mode=learn,loss=square]", seed);
    Batch validation;
    problem.draw_validation(validation);
    Point at;
    problem.forward(problem.start(), validation, at);
    losses.push_back(at.loss);
  }
  std::ranges::sort(losses);
  EXPECT_LT(losses[4], 1.44);
  EXPECT_GT(losses[35], 1.44);
  EXPECT_GT(losses.front(), 0.3);
  EXPECT_LT(losses.back(), 8);
}

TEST(Oscillators, GoThroughTheSameSamplesEpochByEpoch) {
  const Problem problem = make("linear-chain[mode=learn,batch=8,epoch=24]", 1);
  std::array<Batch, 4> batches;
  for (std::size_t step = 0; step < batches.size(); ++step)
    problem.draw_batch(static_cast<std::int64_t>(step), batches[step]);
  EXPECT_EQ(batches[0].target, batches[3].target);
  EXPECT_NE(batches[0].target, batches[1].target);
  EXPECT_NE(batches[1].target, batches[2].target);
  Batch fresh;
  make("linear-chain[mode=learn,batch=8,epoch=0]", 1).draw_batch(3, fresh);
  EXPECT_NE(fresh.target, batches[0].target);
  EXPECT_TRUE(problem.has_fresh_batches());  // from step to step
  EXPECT_THROW(make("linear-chain[mode=learn,batch=7,epoch=24]"), UsageError);
}

TEST(LinearChain, PublishedLossIsTwiceTheHalfSquare) {
  EXPECT_EQ(loss_at_start(make("linear-chain[loss=square]", 1)),
            2 * loss_at_start(make("linear-chain", 1)));
}

// The inverse goes to the nearest control that returns: no shorter way, and no error in x there.
TEST(LinearChain, InverseIsTheNearestSolution) {
  const Problem problem = make("linear-chain", 3);
  Point at;
  const Vector u = random(24, 1, "far");
  problem.forward(u, at);
  Matrix found(24, 1), J;
  problem.local_inverse(problem.target(), found, at);
  problem.jacobian(J, at);
  const Vector step = found - u;
  Vector multiplier;
  ASSERT_TRUE(solve_square(J * J.transpose(), J * step, multiplier));
  EXPECT_LT((step - J.transpose() * multiplier).norm(), 1e-11 * step.norm());  // no part in ker J
  EXPECT_NEAR(problem.x_error(u), step.norm(), 1e-12 * step.norm());
  EXPECT_LT(problem.x_error(found), 1e-12);
}

// A network of dead neurons: it rectifies, and every bias keeps its neurons at zero.
TEST(Oscillators, CountDeadNeuronsAsSaturated) {
  const Problem problem = make("coupled-oscillators[mode=learn]", 1);
  const auto saturated = [&](const Vector& theta) -> Real {
    Point at;
    problem.forward(theta, at);
    Vector values(static_cast<Index>(problem.series().names.size()));
    problem.series().evaluate(problem, theta, at, values);
    EXPECT_EQ(values.tail(2), at.y.col(0).head(2));  // the path in y
    return values[2];
  };
  EXPECT_EQ(problem.series().names.at(2), "saturated neurons");
  EXPECT_LT(saturated(problem.start()), 20);
  Vector dead = problem.start();
  dead.segment(4 * 20, 20).setConstant(-100);  // biases of the first layer
  EXPECT_EQ(saturated(dead), 60);              // the other layers have zero biases
}

}  // namespace
}  // namespace isoline::problems
