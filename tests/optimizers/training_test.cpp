// Identities between training methods, also on the multilayer perceptron, where short trainings end
// as the paper says; and variants of scale-invariant physics training.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>

#include "core/decompose.h"
#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

namespace isoline::optimizers {
namespace {

// The same eigenvectors by other means: to rounding times the condition number of the Hessian.
TEST(Sip, ByNewtonIsSaddleFreeNewtonForTheIdentityNetwork) {
  for (const char* problem : {"sine[xi=1]", "sine", "rosenbrock", "exponential", "box3d"})
    for (int steps : {1, 5})
      expect_near(run(make(problem), "sip[inverse=newton]", iterations(steps)).theta,
                  run(make(problem), "saddle-free-newton", iterations(steps)).theta, 1e-9, problem);
}

TEST(Sip, ByNewtonIsNewtonWhereTheLossIsConvexAndUnlimited) {
  expect_near(
      run(make("exponential"), "sip[inverse=newton,max-loss-change=1e9]", iterations(4)).theta,
      run(make("exponential"), "newton", iterations(4)).theta, 1e-14, "k = 1");
}

// S̄ is not below S where all are equal, and the published comparison is strict.
TEST(Sip, ByNewtonLimitsEqualCurvatures) {
  const Problem round = linear(Matrix::Identity(2, 2), Eigen::Vector2d(4, 0), Vector::Zero(2));
  EXPECT_NEAR(first_step(round, "sip[inverse=newton]")[0], -0.2 / 4, 1e-15);
  const Problem rounder = linear(Matrix::Identity(3, 3), Eigen::Vector3d(4, 0, 0), Vector::Zero(3));
  EXPECT_NEAR(first_step(rounder, "sip[inverse=newton]")[0], -0.2 / 4, 1e-15);
}

TEST(Sip, InnerStepsInvertAgainFromWhereTheLastEnded) {
  const Problem problem = make("sine");
  expect_near(run(problem, "sip[inverse=newton,inner-steps=4]", iterations(1)).theta,
              run(problem, "sip[inverse=newton]", iterations(4)).theta, 1e-15, "sine");
}

// The inverse is exact, so that each step of the one finds the x̃ that the other holds.
TEST(Sip, NetworkStepsGoTowardTheSameTarget) {
  const Problem problem = learned_affine(4, 4);
  expect_near(run(problem, "sip[network-steps=6]", iterations(1)).theta,
              run(problem, "sip", iterations(6)).theta, 1e-12, "six steps");
}

TEST(Sip, SaysWhichInverseAProblemLacks) {
  EXPECT_EQ(why("sip[inverse=damped]", make("heat[N=4]")), "");
  EXPECT_TRUE(why("sip[inverse=damped]", make("sine")).ends_with("not a damped one"));
  EXPECT_NE(why("sip[inverse=damped]", make("box3d")).find("local inverse"), std::string::npos);
  EXPECT_NE(why("sip[inverse=newton]", far_root()).find("second derivatives"), std::string::npos);
  EXPECT_NE(why("sip[inverse=newton]", make("exponential[n=9]")).find("8 inputs"),
            std::string::npos);
}

TEST(Sip, RefusesABadNetworkOptimizer) {
  const OptimizerEntry& sip = optimizers().at("sip");
  for (const char* bad : {"adam[rate=-1]", "newton", "adan", "adam[rat=1]"})
    EXPECT_THROW(
        sip.make(complete_options(sip.options, "sip", {{"network-optimizer", bad}}), optimizers()),
        UsageError)
        << bad;
}

TEST(Supervised, WithAUnitStepIsSipWhereTheInverseIsUnique) {
  const Problem problem = learned_affine(4);
  expect_near(run(problem, "supervised", iterations(20)).theta,
              run(problem, "sip", iterations(20)).theta, 1e-12, "affine");
}

TEST(Truth, IsAPrivilege) {
  const Problem problem = learned_affine(4);
  for (const auto& [spec, count] : {std::pair{"supervised", 1U},
                                    {"rescaled[by=truth]", 1U},
                                    {"rescaled", 0U},
                                    {"sip[inverse=lbfgs]", 0U}}) {
    const OptimizerEntry& entry = optimizers().at(parse_spec(spec).name);
    const OracleSet needs = needs_of(entry, options_of_spec(entry, spec), problem);
    EXPECT_EQ(privileges_of(needs, problem.inverse_kind()).size(), count) << spec;
  }
}

TEST(LeastSquares, WideJacobiansGiveTheShortestStep) {
  const Problem problem = learned_affine(1, 1);
  const Vector step = first_step(problem, "gauss-newton");
  expect_near(first_step(problem, "hig[kappa=1]"), step, 1e-12, "hig");
  // Scaled by D, and so not the shortest, but a solution too.
  Point at;
  problem.forward(
      problem.start() + first_step(problem, "levenberg-marquardt[initial-damping=1e-12]"), at);
  EXPECT_LE(at.loss, 1e-18);
}

TEST(AdaHessian, DiagonalOfADiagonalHessianIsExact) {
  const Matrix M = Eigen::Vector3d(1, 2, 3).asDiagonal();
  const Problem problem = linear(M, Eigen::Vector3d(1, -2, 3), Vector::Zero(3));
  const Vector step = first_step(problem, "adahessian[rate=1,power=1,epsilon=0]");
  expect_near(step, -problem.start(), 1e-14, "Newton's step");
}

// Two kernels of two taps, or two modes of one pair of channels.
Problem kernels(Block::Kind kind) { return separate({{0, 2, 2, kind}}); }
const Eigen::Vector4d kGradient(1, 4, 9, 16);

TEST(AdaHessian, AveragesTheTapsOfAKernel) {
  const Problem problem = kernels(Block::Kind::convolution);
  const Eigen::Vector4d mean(2.5, 2.5, 12.5, 12.5);
  const std::string spec = "adahessian[rate=1,power=1,epsilon=0";
  expect_near(first_step(problem, spec + "]"), -kGradient.cwiseQuotient(mean), 1e-14, "averaged");
  expect_near(first_step(problem, spec + ",average=false]"), -Vector::Ones(4), 1e-14, "each");
}

TEST(AdaHessian, AveragesTheModesOfAPairOfChannelsTheirRealAndImaginaryParts) {
  expect_near(first_step(kernels(Block::Kind::spectrum), "adahessian[rate=1,power=1,epsilon=0]"),
              -kGradient / 7.5, 1e-14, "averaged");
}

TEST(HessianFree, SolvesALinearLeastSquaresProblemAtOnceWithoutDamping) {
  const Problem problem = learned_affine(8, 8);
  Point at;
  problem.forward(run(problem, "hessian-free[damping=1e-14]", iterations(1)).theta, at);
  EXPECT_LE(at.loss, 1e-20);
}

// Of a linear map and a square, ∇²L is JᵀJ: the same step by one product instead of two.
TEST(HessianFree, OfTheTrueHessianSolvesAQuadraticAtOnce) {
  const Outcome one = run(easy(), "hessian-free[damping=1e-14]", iterations(1)),
                other = run(easy(), "hessian-free[damping=1e-14,curvature=hessian]", iterations(1));
  expect_near(one.theta, other.theta, 1e-12, "θ");
  EXPECT_GT(other.trace->last.counts[static_cast<std::size_t>(Oracle::hessian_product)], 1);
  EXPECT_EQ(other.trace->last.counts[static_cast<std::size_t>(Oracle::pushforward)], 0);
  // Where L is concave along the gradient, JᵀJ still has a descent step.
  EXPECT_TRUE(
      run(make("sine"), "hessian-free[curvature=hessian]", iterations(3)).theta.allFinite());
}

TEST(HessianFree, LowersItsDampingWhileTheModelHolds) {
  const Outcome result =
      run(learned_affine(8), "hessian-free", {.iterations = 100, .target = 1e-10});
  EXPECT_EQ(result.status, Status::target);
  EXPECT_EQ(result.trace->rejected_steps, 0);
}

TEST(Libraries, NeedFiniteData) {
  for (const char* name : {"ceres-lbfgs", "nlopt-lbfgs", "ceres-lm", "nlopt-bobyqa"}) {
    EXPECT_NE(why(name, learned_affine(4)).find("data=N"), std::string::npos) << name;
    EXPECT_EQ(why(name, learned_affine(8, 8)), "") << name;
  }
}

TEST(Libraries, LearnFromFiniteData) {
  for (const char* name : {"ceres-lbfgs", "nlopt-lbfgs", "ceres-lm"}) {
    const Outcome result = run(learned_affine(8, 8), name, {.iterations = 200, .target = 1e-10});
    EXPECT_EQ(result.status, Status::target) << name;
  }
}

// --- on the multilayer perceptron

// 42 parameters in double; fresh samples, fewer residuals than parameters for batches up to 20.
Problem smooth(const std::string& batch) {
  return make(
      "sine[mode=learn,xi=2,network=mlp[layers=8,activation=tanh,precision=double],"
      "batch=" +
      batch + "]");
}

// What is known of a learned problem is the best loss of some run, which a longer one may better.
TEST(LearnedRuns, GoOnPastTheBestLossKnownWhereEveryToleranceIsToBePassed) {
  Problem problem = smooth("20");
  const Real start = run(problem, "adam", iterations(1)).trace->start_loss;
  problem.set_minimum(0.9 * start);
  const auto end = [&](Real target) {
    return run(problem, "adam[rate=0.01]", {.iterations = 300, .target = target}).trace->last;
  };
  EXPECT_EQ(end(0).iteration, 300);
  EXPECT_LT(end(0).loss, 0.9 * start);
  EXPECT_LT(end(1e-6).iteration, 300);
}

// κ = 1 is 1/B of the step of Gauss-Newton.
TEST(HalfInverse, KappaOneIsGaussNewtonOnANetwork) {
  expect_near(first_step(smooth("1"), "hig[kappa=1,cutoff=0]"),
              first_step(smooth("1"), "gauss-newton"), 1e-10, "1");
  expect_near(4 * first_step(smooth("4"), "hig[kappa=1,cutoff=0]"),
              first_step(smooth("4"), "gauss-newton"), 1e-9, "4");
}

TEST(LevenbergMarquardt, LearnsFromFreshBatchesWideAndTall) {
  for (const char* batch : {"10", "60"}) {
    const Outcome result = run(smooth(batch), "levenberg-marquardt", iterations(150));
    EXPECT_LT(result.trace->last.loss, 0.05 * result.trace->start_loss) << batch;
  }
}

TEST(Rescaled, DirectionsByGradientAndByTruthAgreeOnANetworkOfOneOutput) {
  const Problem problem = make("exponential[mode=learn,batch=20]");
  EXPECT_EQ(run(problem, "rescaled", iterations(20)).theta,
            run(problem, "rescaled[by=truth]", iterations(20)).theta);
}

// The labels are drawn from all branches of the inverse sine; their mean is not a solution.
TEST(Supervised, FailsOnTheSineWhereSipDoesNot) {
  const Problem problem = make("sine[mode=learn,xi=4]");
  const Real supervised = run(problem, "supervised", iterations(1500)).trace->last.x_error;
  const Real sip =
      run(problem, "sip[inverse=newton,proxy=l1]", iterations(1500)).trace->last.x_error;
  EXPECT_GT(supervised, 20 * sip);
}

TEST(TrainingMethods, LowerTheLossOfAPerceptron) {
  const Problem problem = make("sine[mode=learn,xi=1,network=mlp[layers=16-16],batch=30]");
  for (const auto& [spec, steps] : {std::pair{"adahessian", 200},
                                    {"hessian-free", 20},
                                    {"kfac[rate=0.1,damping=1]", 200},
                                    {"hig", 100},
                                    {"gauss-newton[rate=0.1,cutoff=1e-3]", 60},
                                    {"levenberg-marquardt", 60},
                                    {"muon[rate=0.01]", 300},
                                    {"soap[rate=0.01]", 300},
                                    {"shampoo[rate=0.1]", 300},
                                    {"spring[rate=0.3]", 60},
                                    {"levenberg-marquardt[damping=fixed,initial-damping=1e-2]", 60},
                                    {"hig-damped", 100}}) {
    const Outcome result = run(problem, spec, iterations(steps));
    EXPECT_LT(result.trace->last.loss, 0.1 * result.trace->start_loss) << spec;
  }
}

// Variants of scale-invariant physics training: the stopping rule of theorem 3, labels of two-stage
// training, Newton's step in x, and the series that methods record.

std::vector<std::string> series_names(const Trace& trace) {
  std::vector<std::string> names;
  std::istringstream lines(trace.series_names);
  for (std::string line; std::getline(lines, line);) names.push_back(line);
  return names;
}

// The last value of the series whose name begins so.
Real shown(const Outcome& outcome, const std::string& name) {
  const std::vector<std::string> names = series_names(*outcome.trace);
  const auto found =
      std::ranges::find_if(names, [&](const std::string& each) { return each.starts_with(name); });
  EXPECT_NE(found, names.end()) << name;
  return outcome.trace->last.series[found - names.begin()];
}

const std::string kGentle = "network-optimizer=gd[rate=0.1]";

// y* − P(x + U) = (1 − η)(y* − y): τ = 1 − (1 − η)², and ‖U‖ = η ‖M⁻¹(y* − y)‖.
TEST(SipTheorem3, MeasuresTauAndKInClosedForm) {
  const Problem problem = learned_affine(8, 8);
  for (const Real step : {1.0, 0.5, 0.1}) {
    const Outcome result =
        run(problem, "sip-theorem-3[step=" + std::to_string(step) + "]", iterations(1));
    EXPECT_NEAR(shown(result, "τ of U"), 1 - std::pow(1 - step, 2), 1e-12);  // rounding
    Point at;
    problem.forward(problem.start(), at);
    Matrix solved(2, 8);
    ASSERT_TRUE(problem.local_inverse(problem.target(), solved, at).all());
    const Real length = step * (solved - at.x()).norm() / std::sqrt(8);
    EXPECT_NEAR(shown(result, "length of U"), length, 1e-12 * length);
    const Real K = length / at.loss;
    EXPECT_NEAR(shown(result, "K of U"), K, 1e-12 * K);
  }
}

// L ≤ (1 − τ/2) L after each inversion, and not before the last of its steps.
TEST(SipTheorem3, StopsAsSoonAsHalfOfTheFallIsReached) {
  const Problem problem = learned_affine(8, 8);
  for (const char* step : {"1", "0.5"}) {
    const Real tau = 1 - std::pow(1 - std::stod(step), 2);
    Vector theta = problem.start();
    const std::string options = "[step=" + std::string(step) + "," + kGentle;
    const Outcome result = run(problem, "sip-theorem-3" + options + "]", iterations(1));
    const auto steps = static_cast<int>(shown(result, "network steps of U"));
    ASSERT_GE(steps, 2);
    const Real goal = (1 - tau / 2) * loss_at_start(problem);
    EXPECT_LE(loss_at(problem, result.theta), goal);
    const std::string fewer = ",network-steps=" + std::to_string(steps - 1) + "]";
    const Outcome before = run(problem, "sip" + options + fewer, iterations(1));
    EXPECT_GT(loss_at(problem, before.theta), goal);
    const std::string same = ",network-steps=" + std::to_string(steps) + "]";
    EXPECT_EQ(run(problem, "sip" + options + same, iterations(1)).theta, result.theta);
  }
}

// The theorem: (1 − τ/2)ⁿ after n inversions, and U = 0 at the minimum that is found.
TEST(SipTheorem3, ConvergesAsTheTheoremSays) {
  const Problem problem = learned_affine(8, 8);
  constexpr int kInversions = 40;
  const Outcome result =
      run(problem, "sip-theorem-3[most-steps=100000," + kGentle + "]", iterations(kInversions));
  Real loss = loss_at_start(problem);
  for (const Vector& theta : result.path) {
    const Real now = loss_at(problem, theta);
    EXPECT_LE(now, 0.5 * loss * (1 + 1e-12));  // τ = 1; rounding
    loss = now;
  }
  EXPECT_LE(shown(result, "length of U"), 1e-5);
}

TEST(SipTheorem3, TakesNoMoreStepsThanItMay) {
  const Outcome result =
      run(learned_affine(8, 8), "sip-theorem-3[most-steps=3,network-optimizer=gd[rate=1e-6]]",
          iterations(2));
  EXPECT_EQ(shown(result, "network steps of U"), 3);
  EXPECT_EQ(shown(result, "U not followed, share"), 1) << "of all updates, kept or not";
  EXPECT_EQ(shown(run(learned_affine(8, 8), "sip-theorem-3[most-steps=100000," + kGentle + "]",
                      iterations(2)),
                  "U not followed, share"),
            0);
}

TEST(SipTheorem3, IsSipForTheIdentityNetwork) {
  for (const char* problem : {"square", "sine[xi=1]", "exponential"}) {
    const Outcome one = run(make(problem), "sip-theorem-3[step=0.3]", iterations(5)),
                  other = run(make(problem), "sip[step=0.3]", iterations(5));
    EXPECT_EQ(one.path, other.path) << problem;
    EXPECT_EQ(shown(one, "network steps of U"), 1) << problem;
  }
}

// Theorem 2: with U = −λ ∂L/∂x the network is taught by backpropagation.
TEST(Sip, ByTheGradientIsBackpropagation) {
  const Problem problem = make(
      "sine[mode=learn,xi=2,network=mlp[layers=8-6,activation=tanh,precision=double],batch=7]");
  for (const auto& [inside, alone] :
       {std::pair{"step=1,network-optimizer=gd[rate=0.1]", "gd[rate=0.1]"},
        {"step=0.25,network-optimizer=gd[rate=0.4]", "gd[rate=0.1]"},
        {"step=1,network-optimizer=adam[rate=1e-2]", "adam[rate=1e-2]"}}) {
    const std::string spec = std::string("sip[inverse=gradient,") + inside + "]";
    const Vector one = run(problem, spec, iterations(20)).theta,
                 other = run(problem, alone, iterations(20)).theta;
    expect_near(one, other, 1e-12, inside);
  }
}

// GD_accumulate of the published script: eight steps along the gradient, as long as the first.
TEST(Sip, EightGradientStepsAreAsLongAsTheFirst) {
  const auto step = [](const char* inverse, const Problem& problem) {
    return first_step(problem, fmt::format("sip[inverse={},step=0.05]", inverse));
  };
  const Vector first = step("gradient", easy()), eight = step("gradients", easy());
  EXPECT_NEAR(eight.norm(), first.norm(), 1e-14);
  Vector x = easy().start();  // by hand
  for (int i = 0; i < 8; ++i) x -= 0.05 * gradient_at(easy(), x);
  const Vector sum = x - easy().start();
  expect_near(eight, sum * (first.norm() / sum.norm()), 1e-14, "U");
  EXPECT_GT((eight - first).norm(), 0.01 * first.norm()) << "another direction";
}

// One residual: √diag(JᵀJ) is |J|, and Adam without memory steps by J/|J| and the residual's sign.
TEST(Adam, DividesTheJacobianOfOneResidualByItsDiagonal) {
  const Eigen::RowVector3d J(2, -0.5, 1e-3);
  for (const Real target : {-1.0, 5.0}) {
    const Problem problem = linear(J, Eigen::Vector3d(1, 1, 1), Vector::Constant(1, target));
    const Real r = J.sum() - target;
    const Vector divided = (J.transpose() * J)
                               .diagonal()
                               .cwiseSqrt()
                               .cwiseInverse()
                               .cwiseProduct(J.transpose() * (r > 0 ? 1 : -1));
    expect_near(first_step(problem, "adam[rate=0.1,beta1=0,beta2=0,epsilon=0]"), -0.1 * divided,
                1e-14, "step");
  }
}

TEST(Then, GoesOnFromWhereTheFirstStopped) {
  const Problem problem = easy();
  const Outcome whole = run(problem, "then[first=adam[rate=0.01],second=gd[rate=0.1],steps=3]",
                            iterations(5)),
                start = run(problem, "adam[rate=0.01]", iterations(3)),
                end = run_from(start.theta, problem, "gd[rate=0.1]", iterations(2));
  ASSERT_EQ(whole.path.size(), 5U);
  EXPECT_EQ(whole.path[2], start.theta);
  EXPECT_EQ(whole.theta, end.theta);
  EXPECT_NE(why_inapplicable(optimizers().at("then"),
                             options_of_spec(optimizers().at("then"), "then[first=ceres-lbfgs]"),
                             problem),
            "");
}

TEST(Then, EndsWithAMethodThatSolvesInOneCall) {
  const Problem problem = easy();
  const Outcome start = run(problem, "adam[rate=0.01]", iterations(3)),
                alone = run_from(start.theta, problem, "nlopt-lbfgs", iterations(4)),
                whole = run(problem, "then[second=nlopt-lbfgs,first=adam[rate=0.01],steps=3]",
                            iterations(7));
  EXPECT_EQ(whole.theta, alone.theta);
  EXPECT_EQ(whole.trace->last.iteration, 3 + alone.trace->last.iteration);
  // The point between them is evaluated twice in a row, and counts once.
  EXPECT_EQ(whole.trace->last.work, start.trace->last.work + alone.trace->last.work - 1);
}

// L = 1000 + weight Σ ¼(y − y*)⁴, whose Newton step in y is a third of the way to y*, or away from
// it where it is concave.
class Fourth final : public problems::Loss {
 public:
  explicit Fourth(Real weight) : weight_(weight) {}
  bool is_least_squares() const override { return false; }
  Real value(BatchRef y, BatchRef target) const override {
    return 1e3 + weight_ / 4 * (y - target).array().pow(4).sum();
  }
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override {
    g = weight_ * (y - target).array().cube();
  }
  void curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const override {
    dg = weight_ * 3 * (y - target).array().square() * dy.array();
  }

 private:
  Real weight_;
};

TEST(Sip, UndoesNewtonsStepOnALossThatIsNoSquare) {
  for (const Real weight : {2.0, -2.0})
    for (const char* inverse : {"auto", "lbfgs"}) {
      const Eigen::Vector2d target(0.5, -0.3);
      const Problem problem({.physics = std::make_unique<Linear>(easy_matrix()),
                             .start = Eigen::Vector2d(1, 2),
                             .target = target,
                             .loss = std::make_unique<Fourth>(weight)});
      const Vector e = easy_matrix() * problem.start() - target;
      const std::string spec =
          "sip[difference=newton,step=0.6,inverse=" + std::string(inverse) + "]";
      const Vector after = easy_matrix() * run(problem, spec, iterations(1)).theta - target;
      expect_near(after, (weight > 0 ? 0.8 : 1.2) * e, 1e-10, inverse);
    }
  for (const std::string problem : {"square", "sine[xi=4]"})  // multiples of ‖y − y*‖²
    expect_near(first_step(make(problem), "sip[step=0.3,difference=newton]"),
                first_step(make(problem), "sip[step=0.3]"), 1e-12, problem);
  EXPECT_NE(why("sip[difference=newton]", make("poisson[N=32]")), "");
}

// U, from any x.
Vector update_at(const Problem& problem, const Vector& x) {
  return run_from(x, problem, "sip[inverse=newton,max-loss-change=1e9]", iterations(1)).theta - x;
}

// Equation 6: descent on ½‖U‖² runs into the saddle of L, which is a maximum along x₂, where U = 0,
// too; updates by U leave it.
TEST(Sip, MaximaAndSaddlesOfTheLossAttractDescentOnTheSquareOfTheUpdate) {
  const Problem problem = make("square[target=test]");  // L = (x₁ − 2)² + (x₂² − 2)²
  constexpr Real kStep = 1e-5, kRate = 0.2;
  for (const Eigen::Vector2d& start : {Eigen::Vector2d(2, 0.5), Eigen::Vector2d(1, -0.3)}) {
    Vector x = start;
    for (int i = 0; i < 200; ++i) {
      Eigen::Vector2d slope;
      for (Index j = 0; j < 2; ++j) {
        const Vector d = kStep * Vector::Unit(2, j);
        slope[j] =
            (update_at(problem, x + d).squaredNorm() - update_at(problem, x - d).squaredNorm()) /
            (4 * kStep);
      }
      x -= kRate * slope;
    }
    EXPECT_LE((x - Eigen::Vector2d(2, 0)).norm(), 1e-6);
    EXPECT_NEAR(loss_at(problem, x), 4, 1e-6);
    EXPECT_LE(
        loss_at(problem, run_from(start, problem, "sip[inverse=newton]", iterations(200)).theta),
        1e-12);
  }
}

// Figure 4: less than half of the ball ‖Δ − U‖ < ‖U‖, the steps that bring x nearer to x̃, raises L,
// and the more unknowns there are, the less. U is short, so that L is a plane within the ball, at
// an angle to U of 78°: of a disc 0.375 lies behind it.
TEST(Sip, LessThanHalfOfTheStepsTowardTheInvertedTargetRaiseTheLoss) {
  std::vector<Real> shares;
  for (const Index n : {2, 8, 32}) {
    Matrix M = Matrix::Identity(n, n);
    M(1, 1) = 10;
    const Vector start = Vector::Unit(n, 0) + 0.1 * Vector::Unit(n, 1);
    const Outcome result = run(linear(M, start, Vector::Zero(n)),
                               "sip[inverse=lbfgs,step=1e-6,count=raised]", iterations(1));
    shares.push_back(shown(result, "share that raises L"));
  }
  EXPECT_NEAR(shares[0], 0.375, 0.03);  // four deviations
  EXPECT_LT(shares[1], shares[0] - 0.03);
  EXPECT_LT(shares[2], shares[1] - 0.03);
}

// The last of four samples lies out of the physics' reach, L = ½(x² + 1)²: it moves by −2x(x² + 1),
// and the others by their inverses.
TEST(Sip, FallsBackToTheGradientWhereTheInverseFails) {
  const Problem problem = learned_line(true);
  const std::string rest = "network-optimizer=gd[rate=0.1]]";
  const Outcome moved = run(problem, "sip[fallback=gradient," + rest, iterations(1)),
                stayed = run(problem, "sip[" + rest, iterations(1));
  EXPECT_EQ(shown(moved, "samples moved"), 1);
  const Real pull = 0.1 * 2 * 1 * (1 + 1) / 4;  // at x = 1, of the mean over four, at that rate
  EXPECT_LE((moved.theta - stayed.theta + pull * Eigen::Vector2d(1, 1)).norm(), 1e-14);
  EXPECT_EQ(shown(run(problem, "sip[fallback=gradient," + rest, iterations(3)), "samples moved"),
            3);
}

TEST(Newton, FallsBackToTheGradientWhereTheHessianIsSingular) {
  const Matrix M = Eigen::Vector2d(1, 0).asDiagonal();
  const Problem problem = linear(M, Eigen::Vector2d(1, 2), Eigen::Vector2d(0, 1));
  for (const std::string name : {"newton", "inverse-gradient"}) {
    EXPECT_EQ(run(problem, name, iterations(3)).theta, problem.start()) << name;
    const Outcome result = run(problem, name + "[fallback=gradient,rate=0.5]", iterations(3));
    EXPECT_EQ(result.theta, run(problem, "gd[rate=0.5]", iterations(3)).theta) << name;
    EXPECT_EQ(shown(result, "steps along the gradient"), 3) << name;
  }
  const Outcome regular = run(easy(), "newton[fallback=gradient]", iterations(1));
  EXPECT_EQ(shown(regular, "steps along the gradient"), 0);
}

// What a method shows stands behind what the problem shows, and changes nothing.
TEST(Series, OfProblemAndMethodStandSideBySide) {
  const std::string learned = "hig-toy[network=mlp[layers=3,activation=tanh,precision=double]";
  const Outcome plain = run(make(learned + "]"), "sip-theorem-3", iterations(3)),
                watched = run(make(learned + ",watch=noise]"), "sip-theorem-3", iterations(3));
  EXPECT_EQ(plain.path, watched.path);
  EXPECT_EQ(shown(plain, "τ of U"), shown(watched, "τ of U"));
  EXPECT_EQ(shown(plain, "y1 at t = π/9"), shown(watched, "y1 at t = π/9"));
  EXPECT_TRUE(std::isfinite(shown(watched, "noise of U: direction")));
  EXPECT_EQ(series_names(*watched.trace).size(), series_names(*plain.trace).size() + 4);
  EXPECT_TRUE(std::isnan(plain.trace->point[0].series[series_names(*plain.trace).size() - 1]));
}

TEST(TwoStage, LabelsOfAnInvertibleProblemAreTheGenerators) {
  const Problem problem = learned_affine(5);
  const Outcome labelled = run(problem, "two-stage", iterations(20)),
                told = run(problem, "supervised", iterations(20));
  expect_near(labelled.theta, told.theta, 1e-10, "rounding, by Adam");
}

// x² = (2 + in)² from an untrained network that says −1: its own branch, or that of x₀ = 0, by
// which the inverse takes the positive root.
TEST(TwoStage, LearnsTheBranchWhereTheSolverStarts) {
  Matrix input(1, 4);
  input << -1, -0.5, 0.5, 1;
  const auto problem = [&] {
    return Problem({.physics = std::make_unique<Squares>(),
                    .start = Eigen::Vector2d(-1, 0),
                    .target = (2 + input.array()).square().matrix(),
                    .network = std::make_unique<Line>(),
                    .input = input,
                    .minimum = 0});
  };
  const Budget budget{.iterations = 400, .target = 0};
  const std::string rule = "network-optimizer=gd[rate=0.5]]";
  const Vector zero = run(problem(), "two-stage[from=zero," + rule, budget).theta,
               network = run(problem(), "two-stage[from=network," + rule, budget).theta;
  EXPECT_LE((zero - Eigen::Vector2d(2, 1)).norm(), 1e-6);
  EXPECT_LE((network - Eigen::Vector2d(-2, -1)).norm(), 1e-6);
}

TEST(TwoStage, LabelsFixedSamplesOnceAndFreshOnesEachTime) {
  const auto inversions = [](const Problem& problem) {
    const Outcome result = run(problem, "two-stage", iterations(7));
    return result.trace->last.counts[static_cast<std::size_t>(Oracle::inverse)];
  };
  EXPECT_EQ(inversions(learned_affine(4, 4)), 1);
  EXPECT_EQ(inversions(learned_affine(4)), 7);
}

// The calls of gradient descent at each kept iteration.
std::vector<std::int64_t> calls_at_kept_points(const Outcome& outcome, Oracle oracle) {
  std::vector<std::int64_t> calls;
  for (int i = 0; i < outcome.trace->points; ++i)
    calls.push_back(outcome.trace->point[i].counts[static_cast<std::size_t>(oracle)]);
  return calls;
}

TEST(InexactPhysics, CountsEachIterationOfASolveAsACall) {
  const std::string coarse = "poisson[mode=learn,N=4,batch=2,network=mlp[layers=4],jacobi=";
  const Outcome seven = run(make(coarse + "7]"), "gd[rate=1e-4]", iterations(3));
  for (const Oracle oracle : {Oracle::forward, Oracle::pullback})
    EXPECT_EQ(calls_at_kept_points(seven, oracle), (std::vector<std::int64_t>{0, 7, 14, 21}));
  EXPECT_EQ(seven.trace->last.work, 42);
  // Of SIP, the inverse and the network are called once.
  const Outcome sip = run(make(coarse + "7]"), "sip", iterations(3));
  EXPECT_EQ(calls_at_kept_points(sip, Oracle::forward).back(), 21);
  EXPECT_EQ(calls_at_kept_points(sip, Oracle::inverse).back(), 3);
  // Two steps cost 28: the third has no solve left.
  const Outcome limited =
      run(make(coarse + "7]"), "gd[rate=1e-4]", {.iterations = 100, .work = 34, .target = 0});
  EXPECT_EQ(limited.status, Status::budget);
  EXPECT_EQ(limited.trace->last.iteration, 2);
  EXPECT_EQ(limited.trace->last.work, 28);
}

// From 3 iterations by 1 up to 55, on 16 cells. Steps of length 0 leave the loss as it is, so that
// the first addition, after four epochs, does not help and is the only one.
TEST(InexactPhysics, IsRefinedOnceWhereNothingHelps) {
  const Problem problem =
      make("poisson[mode=learn,N=4,batch=2,network=mlp[layers=4],jacobi=progressive]");
  const problems::Refinement& of = *problem.refinement();
  EXPECT_EQ((std::array{of.first, of.step, of.most}), (std::array<Index, 3>{3, 1, 55}));
  const Outcome still = run(problem, "gd[rate=1e-300]", iterations(80));
  const auto calls = calls_at_kept_points(still, Oracle::forward);
  EXPECT_EQ(calls.at(24), 24 * of.first);
  EXPECT_EQ(calls.at(80), 24 * of.first + 56 * (of.first + of.step));
}

// P(x) = eˣ from x with the target y*: ½(eˣ − y*)² has g = (eˣ − y*) eˣ and h = 2e²ˣ − y* eˣ.
class Exponential final : public DensePhysics {
 public:
  Exponential() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = std::exp(x[0]); }
  void derivative(VectorRef x, BatchOut J) const override { J(0, 0) = std::exp(x[0]); }
  bool has_curvature() const override { return true; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    H(0, 0) = u[0] * std::exp(x[0]);
  }
};

Real newton_step(Real x, Real target, const std::string& options) {
  const Problem problem({.physics = std::make_unique<Exponential>(),
                         .start = Vector::Constant(1, x),
                         .target = Matrix::Constant(1, 1, target)});
  return run(problem, "sip-newton" + options, iterations(1)).theta[0] - x;
}

TEST(SipNewton, StepsAsThePublishedScript) {
  for (const auto& [x, target] : {std::pair{0.0, 1e-3}, {-1.0, 0.9}, {-4.0, 0.5}, {0.3, 0.2}}) {
    const Real e = std::exp(x), g = (e - target) * e, h = 2 * e * e - target * e;
    const Real sign = g > 0 ? 1 : -1;
    EXPECT_NEAR(newton_step(x, target, ""), -sign * std::abs(g / h), 1e-12 * std::abs(g / h));
    EXPECT_NEAR(newton_step(x, target, "[clip=0.1]"), -sign * std::min(0.1, std::abs(g / h)),
                1e-13);
    const Real damped = std::abs(g / (h + 0.01));
    EXPECT_NEAR(newton_step(x, target, "[damping=0.01]"), -sign * damped, 1e-12 * damped);
  }
  EXPECT_EQ(newton_step(0, 2, ""), 0);  // h = 0: no step
}

// Along eigenvectors: where the Hessian is definite it is Newton's method.
TEST(SipNewton, OfSeveralInputsIsNewtonsMethodWhereTheLossIsConvex) {
  const Vector one = run(easy(), "sip-newton", iterations(1)).theta,
               other = run(easy(), "newton", iterations(1)).theta;
  expect_near(one, other, 1e-13, "rounding by the condition, 7");
}

}  // namespace
}  // namespace isoline::optimizers
