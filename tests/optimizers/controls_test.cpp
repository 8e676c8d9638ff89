// The published figures of half-inverse gradients on the linear chain, the loss over the training
// data after each epoch, as the book's notebook prints it; and what the problems beside it declare.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/optimizers/run.h"

namespace isoline::optimizers {
namespace {

using problems::Batch;
using problems::Point;

// ‖y − y*‖², the mean over all 4,096 samples.
Real training_loss(const Problem& problem, const Vector& theta) {
  constexpr Index kBatches = 4096 / 32;
  Batch batch;
  Point at;
  Real sum = 0;
  for (Index step = 0; step < kBatches; ++step) {
    problem.draw_batch(step, batch);
    problem.forward(theta, batch, at);
    sum += at.loss / kBatches;
  }
  return sum;
}

// η = 1, B = 32, κ = ½, a cut-off of 1e-10, 128 steps an epoch: within a factor of 2 of what is
// printed, of another start and other samples.
TEST(Chain, HalfInverseGradientsReachThePublishedLossesEpochByEpoch) {
  constexpr std::array kPublished = {5.44e-5, 1.06e-5, 3.16e-6, 1.19e-6};
  for (const std::uint64_t seed : {0, 1, 2}) {
    const Problem problem = published("linear-chain[mode=learn,loss=square]", seed);
    const Outcome outcome = run(problem, "hig[rate=1,cutoff=1e-10]",
                                iterations(128 * static_cast<std::int64_t>(kPublished.size())));
    for (std::size_t epoch = 0; epoch < kPublished.size(); ++epoch) {
      const Real loss = training_loss(problem, outcome.path.at(128 * (epoch + 1) - 1));
      EXPECT_LT(std::abs(std::log2(loss / kPublished[epoch])), 1) << seed << " " << epoch;
    }
  }
}

// That the least loss is 0 is no matter of form: four numbers of a state are reached by 96
// controls, and the particle's 28 by 384.
TEST(Controls, OfOneProblemReachTheDeclaredMinimum) {
  const Outcome oscillators = run(published("coupled-oscillators"), "gauss-newton", iterations(10));
  EXPECT_LT(oscillators.trace->last.loss, 1e-28);
  const Outcome particle =
      run(published("quantum-dipole[loss=residual]"), "gauss-newton", iterations(20));
  EXPECT_LT(particle.trace->last.loss, 1e-24);
}

TEST(Controls, AreNoMatterOfLeastSquaresWhereTheLossIsAnOverlap) {
  for (const char* optimizer : {"gauss-newton", "levenberg-marquardt", "ceres-lm"}) {
    EXPECT_NE(why(optimizer, published("quantum-dipole")), "") << optimizer;
    EXPECT_EQ(why(optimizer, published("quantum-dipole[loss=residual]")), "") << optimizer;
  }
  for (const char* optimizer : {"hig", "gd", "sip", "nlopt-lbfgs"})
    EXPECT_EQ(why(optimizer, published("quantum-dipole")), "") << optimizer;
}

// Searches among many minima: how many instances of the wave packet end at the one sought, and what
// the reverse simulation of Burgers' equation is worth as an inverse.

// Of 200 instances, those where the search ends within a tenth of x*.
int found(const std::string& method) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Problem problem = published("wave-packet", seed);
    const Outcome outcome = run(problem, method, {.iterations = 1000, .work = 1000, .target = 0});
    const Real scale = problem.x_scale(problem.batch());
    count += problem.x_error(outcome.theta) <= 0.1 * scale;
  }
  return count;
}

// Counted once; the bounds leave room for other kernels, by which a few instances end elsewhere.
TEST(WavePacket, TrapsAStatedShareOfSearchesAndTheSameAgain) {
  const int by_damped_steps = found("levenberg-marquardt");
  EXPECT_NEAR(by_damped_steps, 87, 6);
  EXPECT_EQ(found("levenberg-marquardt"), by_damped_steps);
  EXPECT_NEAR(found("gd[rate=0.01]"), 133, 6);
  EXPECT_LT(found("newton"), 10) << "it goes to maxima and saddles as well";
}

// Not slowness: where it ends the gradient vanishes, and the loss is above the least.
TEST(WavePacket, HoldsWhatItTrapsWithTheGradientAtZero) {
  int trapped = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = published("wave-packet", seed);
    const Outcome outcome =
        run(problem, "ceres-lm", {.iterations = 1000, .work = 2000, .target = 0});
    Point at;
    problem.forward(outcome.theta, at);
    Matrix g(problem.outputs(), 1);
    Vector gradient(problem.unknowns());
    problem.cotangent(at, g);
    problem.pullback(g, gradient, at);
    if (problem.x_error(outcome.theta) < 1 || !(at.loss < 0.9 * problem.loss_of(0 * at.y)))
      continue;
    EXPECT_LT(gradient.norm(), 1e-3) << seed;
    EXPECT_GT(at.loss, 2 * problem.minimum().value()) << seed;
    ++trapped;
  }
  EXPECT_GE(trapped, 3);
}

// At equal work of 2,000 forward solves gradient descent, at the best of its tuned rates, is left
// with ten times the error.
TEST(Burgers, ReverseSimulationGoesBeyondGradientDescent) {
  const Problem problem = published("burgers");
  const Budget budget{.iterations = 100000, .work = 2000, .target = 0};
  const Real by_inverse = problem.x_error(run(problem, "sip", budget).theta);
  const Real by_gradient = problem.x_error(run(problem, "gd[rate=0.336]", budget).theta);
  EXPECT_LT(by_inverse, 1e-3 * problem.x_scale(problem.batch()));
  EXPECT_GT(by_gradient, 10 * by_inverse);
}

TEST(Burgers, ThatBlowsUpHasDivergedAndKeepsItsCurve) {
  const Problem problem = published("burgers");
  const Outcome outcome = run(problem, "gd[rate=1e4]", {.iterations = 100, .target = 0});
  EXPECT_EQ(outcome.status, Status::diverged);
  EXPECT_FALSE(outcome.path.empty());
}

}  // namespace
}  // namespace isoline::optimizers
