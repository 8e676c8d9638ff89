// Bounds on x: methods that respect them, and the discrepancy principle, which ends a run at the
// noise.
#include <gtest/gtest.h>

#include <cmath>

#include "problems/features.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {
namespace {

using problems::Draw;
using problems::with_features;

Problem featured(const std::string& spec, const OptionValues& features) {
  return with_features(make(spec), features, Draw(0, spec));
}
const std::string kWide = "wide", kActive = "active";

// MMA and CCSA start from asymptotes at a share of the box, COBYLA and SLSQP solve subproblems that
// have a bound as a further constraint: their paths depend on the box. Powell's BOBYQA keeps its
// points of interpolation within it.
const std::vector<std::string> kSensitive = {"nlopt-mma", "nlopt-ccsaq", "nlopt-cobyla",
                                             "nlopt-slsqp", "nlopt-bobyqa"};

TEST(Bounds, ThatAreNeverActiveChangeNothing) {
  const Problem plain = make("burgers[N=16]");
  const Problem wide = featured("burgers[N=16]", {{"bounds", kWide}});
  int methods = 0;
  for (const auto& [name, entry] : optimizers()) {
    if (!entry.keeps_bounds || !entry.needs_argument.empty() ||
        std::ranges::find(kSensitive, name) != kSensitive.end())
      continue;
    const Budget budget{.iterations = 60, .work = 3000};
    const Outcome one = run(plain, name, budget), other = run(wide, name, budget);
    EXPECT_EQ(one.theta, other.theta) << name;
    EXPECT_EQ(one.trace->last.loss, other.trace->last.loss) << name;
    EXPECT_EQ(one.trace->last.iteration, other.trace->last.iteration) << name;
    ++methods;
  }
  EXPECT_GE(methods, 9);
}

TEST(Bounds, MethodsThatDoNotRespectThemRunWhereTheSolutionIsInside) {
  const Problem wide = featured("burgers[N=16]", {{"bounds", kWide}});
  const Problem active = featured("burgers[N=16]", {{"bounds", kActive}});
  for (const auto& [name, entry] : optimizers()) {
    if (!entry.needs_argument.empty()) continue;
    if (why(name, make("burgers[N=16]")).empty()) {
      EXPECT_EQ(why(name, wide), "") << name;
      EXPECT_EQ(why(name, active).empty(), entry.keeps_bounds) << name;
    }
  }
}

// ‖θ − Π(θ − ∇L)‖ is 0 at a constrained minimum, where ∇L is not.
TEST(Bounds, ASolutionOnThemSatisfiesTheConditionsOfKarushKuhnAndTucker) {
  for (const char* spec : {"burgers[N=16]", "poisson[N=4]"}) {
    const Problem problem = featured(spec, {{"bounds", kActive}});
    const Real start = gradient_at(problem, problem.start()).norm();
    for (const char* method : {"levenberg-marquardt", "nlopt-lbfgs", "nlopt-slsqp", "nlopt-mma"}) {
      const Outcome outcome = run(problem, method, {.iterations = 2000, .target = 0});
      const std::string what = std::string(method) + " on " + spec;
      EXPECT_TRUE(problem.bounds()->hold(outcome.theta)) << what;
      EXPECT_LE(outcome.trace->last.kkt_residual, 1e-6 * start) << what;
      EXPECT_GT(outcome.trace->last.gradient_norm, 1e-3 * start) << what;
      EXPECT_NEAR(outcome.trace->last.loss, *problem.minimum(), 1e-6 * *problem.minimum()) << what;
      Index active = 0;
      for (Index i = 0; i < outcome.theta.size(); ++i)
        active += outcome.theta[i] == problem.bounds()->upper[i];
      EXPECT_GT(active, 0) << what;
    }
  }
}

// Without bounds the first step ends at (10, −9). Moved onto the bound as it is, to (10, 0), it
// raises the loss, and steps that shorten until this ends hardly move.
TEST(Bounds, AStepThatLeavesThemTakesTheOtherUnknownsByTheModel) {
  const Problem problem(
      {.physics = std::make_unique<Linear>(Eigen::Matrix2d{{1, 1}, {0, 0.1}}),
       .start = Eigen::Vector2d(1, 1),
       .target = Eigen::Vector2d(1, -0.9),
       .bounds = problems::Bounds{Eigen::Vector2d(-100, 0), Eigen::Vector2d(100, 100)}});
  const Outcome outcome = run(problem, "levenberg-marquardt", {.iterations = 100, .target = 0});
  EXPECT_NEAR(outcome.theta[0], 1, 1e-6);
  EXPECT_EQ(outcome.theta[1], 0);
  EXPECT_EQ(outcome.trace->status, Status::converged);
  EXPECT_EQ(outcome.trace->rejected_steps, 0);
}

// The model of Ceres counts what the bounds cut off a step, so that its radius shrinks, and it ends
// short of the solution. It stays within the bounds, as all others do at every iterate.
TEST(Bounds, EveryMethodThatRespectsThemStaysInsideAndDescends) {
  const Problem problem = featured("burgers[N=16]", {{"bounds", kActive}});
  for (const auto& [name, entry] : optimizers()) {
    if (!entry.keeps_bounds || !entry.needs_argument.empty()) continue;
    const Outcome outcome = run(problem, name, {.iterations = 500, .target = 0});
    EXPECT_TRUE(problem.bounds()->hold(outcome.theta)) << name;
    EXPECT_LT(outcome.trace->last.loss, outcome.trace->start_loss) << name;
    EXPECT_GE(outcome.trace->best_loss, *problem.minimum() * (1 - 1e-9)) << name;
  }
}

// Sequential quadratic programming finds no less than the fit that f_L is from.
TEST(Bounds, TheLeastLossIsThatOfASolverWithAnActiveSet) {
  const Problem problem = featured("deconvolution-1d[N=64]", {{"bounds", kActive}});
  const Outcome outcome = run(problem, "nlopt-slsqp", {.iterations = 3000, .target = 0});
  EXPECT_GE(outcome.trace->best_loss, *problem.minimum());
  EXPECT_LE(outcome.trace->best_loss, 3 * *problem.minimum());
}

TEST(Bounds, ProjectedGradientDescentStaysInside) {
  const Problem problem = featured("poisson[N=4]", {{"bounds", kActive}});
  const Outcome outcome = run(problem, "gd[rate=0.5]", {.iterations = 5000, .target = 0});
  for (const Vector& theta : outcome.path) ASSERT_TRUE(problem.bounds()->hold(theta));
  EXPECT_LE(outcome.trace->last.kkt_residual, 1e-6);
  EXPECT_GT(outcome.trace->last.gradient_norm, 1e-3);
}

TEST(Bounds, ExcludeARotationAndRequireAKnownTruth) {
  EXPECT_THROW(featured("burgers[N=16]", {{"bounds", kActive}, {"rotate", true}}), UsageError);
  EXPECT_THROW(featured("linear-chain[steps=24]", {{"bounds", kActive}}), UsageError);
  const Problem scaled = featured("burgers[N=16]", {{"bounds", kActive}, {"scale", 100.0}});
  const Problem plain = featured("burgers[N=16]", {{"bounds", kActive}});
  EXPECT_NEAR(scaled.bounds()->upper[15] * 10, plain.bounds()->upper[15], 1e-12);
}

// --- the discrepancy principle

constexpr Real kDiscrepancy = 1.1;

Budget to_noise(std::int64_t most) { return {.iterations = most, .discrepancy = kDiscrepancy}; }

TEST(Discrepancy, EndsARunAtTheFirstIterateWithinTheNoise) {
  const Problem noisy = featured("burgers[N=32]", {{"noise", 0.01}});
  const Real delta = *noisy.noise_level(), m = 32;
  EXPECT_NEAR(delta, 0.01 * make("burgers[N=32]").target().norm(), 1e-12 * delta);
  EXPECT_NEAR(*featured("burgers[N=32]", {{"noise", 0.01}, {"noise-kind", std::string("outliers")}})
                   .noise_level(),
              delta * std::sqrt(10.9), 1e-12 * delta);
  ASSERT_GT(m, 0);
  for (const char* method : {"gd[rate=0.1]", "levenberg-marquardt", "ceres-lm", "nlopt-lbfgs",
                             "adam[rate=0.01]", "nlopt-bobyqa"}) {
    const Outcome outcome = run(noisy, method, to_noise(20000));
    ASSERT_EQ(outcome.status, Status::discrepancy) << method;
    const Trace& trace = *outcome.trace;
    EXPECT_LE(trace.last.discrepancy, kDiscrepancy * delta) << method;
    for (int i = 0; i + 1 < trace.points; ++i)
      EXPECT_GT(trace.point[i].discrepancy, kDiscrepancy * delta) << method << " " << i;
    // One iteration less does not suffice, kept or not.
    Budget before = to_noise(trace.last.iteration - 1);
    const Outcome shorter = run(noisy, method, before);
    EXPECT_EQ(shorter.status, Status::budget) << method;
    EXPECT_GT(shorter.trace->last.discrepancy, kDiscrepancy * delta) << method;
  }
}

// Later iterates fit the noise: the error at the end is a hundred times the one at the stop, which
// is near the least that any cut-off of the singular values leaves.
TEST(Discrepancy, StopsNearTheBestErrorOfAnIllPosedProblem) {
  const Problem noisy = featured("deconvolution-1d[N=64]", {{"noise", 0.01}});
  const Real floor = noisy.x_floor(noisy.batch());
  for (const char* method : {"nlopt-lbfgs", "nlopt-tnewton", "levenberg-marquardt-cg"}) {
    const Outcome stopped = run(noisy, method, to_noise(1000));
    const Outcome whole = run(noisy, method, {.iterations = 1000, .work = 2000, .target = 0});
    EXPECT_EQ(stopped.status, Status::discrepancy) << method;
    EXPECT_LE(stopped.trace->last.x_error, 1.1 * floor) << method;
    EXPECT_GE(whole.trace->last.x_error, 10 * floor) << method;
  }
}

// By Gauss-Newton steps with conjugate gradients, as hIPPYlib solves it.
TEST(Discrepancy, IsReachedOnACoefficientField) {
  const Problem noisy = featured("poisson-field[N=16,points=100]", {{"noise", 0.005}});
  const Outcome outcome = run(noisy, "levenberg-marquardt-cg", to_noise(100));
  EXPECT_EQ(outcome.status, Status::discrepancy);
  EXPECT_LT(outcome.trace->last.x_error, 0.7 * outcome.trace->start_x_error);
}

// The path is that of a run without the rule.
TEST(Discrepancy, DoesNotChangeThePath) {
  const Problem noisy = featured("burgers[N=32]", {{"noise", 0.01}});
  for (const char* method : {"gd[rate=0.1]", "ceres-lm", "levenberg-marquardt"}) {
    const Outcome stopped = run(noisy, method, to_noise(20000));
    const Outcome same = run(noisy, method, iterations(stopped.trace->last.iteration));
    EXPECT_EQ(stopped.theta, same.theta) << method;
    EXPECT_LE(stopped.trace->last.work - same.trace->last.work, 1) << method;
  }
}

TEST(Discrepancy, CountsTheDataAndNotThePenalty) {
  const OptionValues options{{"noise", 0.01}, {"tikhonov", 1e-3}};
  const Problem penalized = featured("burgers[N=32]", options);
  Vector far = penalized.start();
  far.setConstant(3);
  Point at;
  penalized.forward(far, at);
  const Real data = (at.y - penalized.target()).topRows(32).norm();
  EXPECT_EQ(penalized.discrepancy(at), data);
  EXPECT_GT(std::sqrt(2 * at.loss), data);
}

TEST(Discrepancy, HasNoEffectWithoutNoise) {
  const Problem exact = make("burgers[N=32]");
  const Outcome with = run(exact, "ceres-lm", to_noise(100));
  const Outcome without = run(exact, "ceres-lm", {.iterations = 100});
  EXPECT_EQ(with.theta, without.theta);
  EXPECT_EQ(with.status, Status::target);
  EXPECT_NE(std::string(with.trace->message), "");
  EXPECT_EQ(std::string(without.trace->message), "");
}

TEST(Discrepancy, IsKnownOfNoiseThatAProblemHasItself) {
  const Problem packet = make("wave-packet[sigma=0.05]");
  EXPECT_NEAR(*packet.noise_level(), 0.05 * 8, 1e-12);
  EXPECT_FALSE(make("wave-packet[sigma=0]").noise_level());
  const Problem noisier = featured("wave-packet", {{"noise", 0.1}});
  EXPECT_GT(*noisier.noise_level(), *packet.noise_level());
}

}  // namespace
}  // namespace isoline::optimizers
