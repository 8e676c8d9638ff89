// The features of any direct problem: noise, another model, scaled and rotated unknowns, few
// digits, a penalty.
#include "problems/features.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <tuple>

#include "problems/differences.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

Problem featured(const std::string& spec, const OptionValues& features, std::uint64_t seed = 0) {
  return with_features(make(spec, seed), features, Draw(seed, spec));
}

TEST(Features, NoneIsThePlainProblem) {
  const Problem plain = make("burgers[N=32]", 3);
  for (const OptionValues& none : {OptionValues{}, OptionValues{{"noise", 0.0}}}) {
    const Problem same = featured("burgers[N=32]", none, 3);
    EXPECT_EQ(plain.target(), same.target());
    EXPECT_EQ(plain.start(), same.start());
    EXPECT_EQ(plain.minimum(), same.minimum());
    EXPECT_EQ(gradient_at(plain, plain.start()), gradient_at(same, same.start()));
  }
}

TEST(Features, NoiseHasItsDeviationAndItsLossAtTheTruth) {
  const Problem plain = make("poisson[N=32]");
  const Real sigma = 0.02 * plain.target().norm() / 32, m = 1024;
  for (const char* kind : {"gaussian", "uniform"}) {
    const Problem noisy =
        featured("poisson[N=32]", {{"noise", 0.02}, {"noise-kind", std::string(kind)}});
    const Real expected = 0.5 * sigma * sigma * m;
    EXPECT_NEAR(loss_at(noisy, noisy.truth()->reshaped()), expected, 0.2 * expected) << kind;
    EXPECT_NE(noisy.target(), featured("poisson[N=32]", {{"noise", 0.02}}, 1).target());
  }
  const Problem outliers =
      featured("poisson[N=32]", {{"noise", 0.02}, {"noise-kind", std::string("outliers")}});
  EXPECT_GT((outliers.target() - plain.target()).cwiseAbs().maxCoeff(), 8 * sigma);
}

// With noise the least loss is that of a fit, and what the data allow in x is no longer 0.
TEST(Features, ANoisyProblemHasALeastLossAndAFloor) {
  const Problem noisy = featured("burgers[N=16]", {{"noise", 0.01}});
  ASSERT_TRUE(noisy.minimum());
  const Vector truth = noisy.truth()->reshaped();
  EXPECT_GT(*noisy.minimum(), 0);
  EXPECT_LE(*noisy.minimum(), loss_at(noisy, truth));
  EXPECT_GT(noisy.x_floor(noisy.batch()), 0);
  EXPECT_LT(noisy.x_floor(noisy.batch()), noisy.x_scale(noisy.batch()));
  EXPECT_THROW(featured("rosenbrock", {{"noise", 0.01}}), UsageError) << "y* is 0";
  // An error that is a mean over cells is far below a norm.
  const Problem flow = featured("navier-stokes[N=8,steps=4]", {{"noise", 1e-6}});
  EXPECT_LE(flow.x_floor(flow.batch()), flow.x_error(flow.start()));
}

// As many unknowns as data of a one-to-one P, so that some x fits the noise, too.
TEST(Features, TheLeastLossOfASquareProblemWithNoiseIsZero) {
  const Problem noisy = featured("burgers[N=64]", {{"noise", 0.01}});
  ASSERT_TRUE(noisy.minimum());
  EXPECT_LT(*noisy.minimum(), 1e-20 * loss_at_start(noisy));
}

// The distance from the fit in its standard deviations: for a linear problem that of the losses.
TEST(Features, WithTheFitAsGoalErrorsAreDistancesInStandardDeviations) {
  const OptionValues noisy{{"noise", 0.01}}, by_fit{{"noise", 0.01}, {"goal", std::string("fit")}};
  const Problem plain = featured("two-compartments", noisy),
                judged = featured("two-compartments", by_fit);
  ASSERT_TRUE(judged.truth() && judged.minimum());
  EXPECT_EQ(plain.target(), judged.target());
  const Vector fit = judged.truth()->reshaped();
  EXPECT_NEAR(loss_at(judged, fit) / *plain.minimum(), 1, 1e-9);
  EXPECT_EQ(judged.x_error(fit), 0);
  EXPECT_NEAR(x_goal(1e-6, judged.x_scale(judged.batch()), judged.x_floor(judged.batch())),
              kNearFit, 1e-12);
  const Real sigma = *judged.noise_level() / std::sqrt(static_cast<Real>(judged.outputs()));
  const Vector near = fit + 1e-5 * Vector::Ones(fit.size());
  const Real rise = 2 * (loss_at(judged, near) - loss_at(judged, fit)) / (sigma * sigma);
  EXPECT_NEAR(judged.x_error(near) / std::sqrt(rise), 1, 1e-2);
  EXPECT_THROW(featured("two-compartments", {{"goal", std::string("fit")}}), UsageError);
}

// What another model differs by is noise, too.
TEST(Features, TheErrorOfAnotherModelIsPartOfTheNoiseLevel) {
  const Matrix other = 1.1 * make("sir").target();
  const Problem alone = featured("sir", {{"noise", 0.01}}),
                both = with_features(make("sir"), {{"noise", 0.01}}, Draw(0, "sir"), other);
  const Real error = 0.1 * make("sir").target().norm();
  EXPECT_NEAR(*both.noise_level(), std::hypot(1.1 * *alone.noise_level(), error), 1e-9);
}

// At x*, the data of a finer grid differ from P(x*) less, the finer both are.
TEST(Features, DataOfAFinerGridDifferByTheDiscretizationError) {
  for (const auto& [coarse, fine] :
       {std::pair{"diffusivity[n=7,refine=2]", "diffusivity[n=31,refine=2]"},
        {"deconvolution-1d[N=32,width=3,refine=2]", "deconvolution-1d[N=128,width=12,refine=2]"}}) {
    const auto error = [](const Problem& problem) {
      Point at;
      problem.forward(*problem.truth(), at);
      const Real count = std::sqrt(static_cast<Real>(problem.outputs()));
      return (at.y - problem.target()).norm() / (count * problem.target().cwiseAbs().maxCoeff());
    };
    EXPECT_GT(error(make(coarse)), 0) << coarse;
    EXPECT_LT(error(make(fine)), 0.5 * error(make(coarse))) << coarse;
  }
}

// Jᵀ and J agree with differences of the loss; errors in x are those of the plain problem.
TEST(Features, ScaledAndRotatedUnknownsAreTheSameProblem) {
  const OptionValues mapped{{"scale", 1e3}, {"rotate", true}};
  const Problem plain = make("burgers[N=16]"), other = featured("burgers[N=16]", mapped);
  EXPECT_NEAR(loss_at_start(other), loss_at_start(plain), 1e-12 * loss_at_start(plain));
  EXPECT_NEAR(other.x_error(*other.truth()), 0, 1e-12);
  EXPECT_NEAR(other.x_error(other.start()), plain.x_error(plain.start()), 1e-12);
  Vector z = other.start();
  z.array() += 0.01;
  const Vector g = gradient_at(other, z);
  Vector step = Vector::Zero(z.size());
  Point at;
  other.forward(z, at);
  Matrix J, Jv(other.outputs(), 1);
  other.jacobian(J, at);
  for (Index i = 0; i < z.size(); i += 7) {
    step.setZero();
    const Real h = step[i] = 1e-5 / std::max<Real>(1, J.col(i).norm());
    const Real slope = (loss_at(other, z + step) - loss_at(other, z - step)) / (2 * h);
    EXPECT_NEAR(g[i], slope, 1e-6 * g.norm());
    step /= h;
    other.pushforward(step, Jv, at);
    EXPECT_NEAR((Jv - J.col(i)).norm(), 0, 1e-12 * J.col(i).norm());
  }
}

TEST(Features, AnInverseFindsTheTruthThroughTheMap) {
  const Problem other = featured("poisson[N=8]", {{"scale", 100.0}, {"rotate", true}});
  Point at;
  other.forward(other.start(), at);
  Matrix z(other.inputs(), 1);
  ASSERT_TRUE(other.local_inverse(other.target(), z, at).all());
  EXPECT_NEAR(other.x_error(z), 0, 1e-10 * other.x_scale(other.batch()));
}

TEST(Features, FewDigitsAreAttainedAtTheTruthAlone) {
  const Problem other = featured("burgers[N=16]", {{"digits", Index{4}}});
  EXPECT_EQ(loss_at(other, other.truth()->reshaped()), 0);
  EXPECT_GT(other.x_floor(other.batch()), 0);
  for (const Real y : other.target().reshaped())
    if (y != 0) {
      const Real unit = std::pow(10, 3 - std::floor(std::log10(std::abs(y))));
      EXPECT_NEAR(y * unit, std::round(y * unit), 1e-6);
    }
}

// The minimum of a linear problem with a penalty: (AᵀA + αDᵀD) x = Aᵀy*.
TEST(Features, APenaltyHasTheClosedFormOfALinearProblem) {
  for (const Index order : {0, 1}) {
    const Real alpha = 0.3;
    const Problem other = featured("poisson[N=4]", {{"tikhonov", alpha}, {"order", order}});
    const Index k = other.inputs();
    Point at;
    Matrix J;
    other.forward(Vector::Zero(k), at);
    other.jacobian(J, at);
    ASSERT_EQ(J.rows(), 2 * k - order);
    const Matrix A = J.topRows(k);
    Matrix D = Matrix::Identity(k, k);
    if (order == 1) {
      D = Matrix::Zero(k - 1, k);
      for (Index i = 0; i < k - 1; ++i) D(i, i) = -1, D(i, i + 1) = 1;
    }
    const Vector x = (A.transpose() * A + alpha * D.transpose() * D)
                         .lu()
                         .solve(A.transpose() * other.target().topRows(k).reshaped());
    EXPECT_LE(gradient_at(other, x).norm(), 1e-10 * gradient_at(other, other.start()).norm());
    ASSERT_TRUE(other.minimum());
    EXPECT_NEAR(*other.minimum(), loss_at(other, x), 1e-10 * loss_at(other, x));
  }
}

// A problem that has noise of its own knows x*, though no label attains the least loss.
TEST(Features, FurtherNoiseHasAFloorWhereTheProblemHasNoiseItself) {
  const Problem plain = make("wave-packet"), noisy = featured("wave-packet", {{"noise", 0.2}});
  EXPECT_FALSE(noisy.truth());
  ASSERT_TRUE(noisy.minimum());
  EXPECT_GT(*noisy.minimum(), *plain.minimum());
  EXPECT_GT(noisy.x_floor(noisy.batch()), 0);
  EXPECT_LT(noisy.x_floor(noisy.batch()), 0.2 * noisy.x_scale(noisy.batch()));
}

// At the least loss within the bounds no step inside them descends.
TEST(Features, ActiveBoundsHaveTheLeastLossWithinThem) {
  const Problem plain = make("burgers[N=16]");
  const Problem bounded = featured("burgers[N=16]", {{"bounds", std::string("active")}});
  const Bounds& box = *bounded.bounds();
  EXPECT_TRUE(box.hold(bounded.start()));
  EXPECT_FALSE(box.hold(plain.truth()->reshaped()));
  ASSERT_TRUE(bounded.minimum());
  EXPECT_GT(*bounded.minimum(), 1e-6 * loss_at_start(plain));
  EXPECT_LT(*bounded.minimum(), loss_at(plain, box.nearest(plain.truth()->reshaped())));
  EXPECT_GT(bounded.x_floor(bounded.batch()), 0);
  const Problem wide = featured("burgers[N=16]", {{"bounds", std::string("wide")}});
  EXPECT_EQ(*wide.minimum(), 0);
  EXPECT_FALSE(wide.bounds()->are_needed);
}

// The standard error of a share of 0.05 among 4,000 points is 0.0034.
TEST(Features, AShareOfAllXFailsButNeitherTheStartNorTheTruth) {
  for (const std::uint64_t seed : {0U, 1U, 2U}) {
    const Problem plain = make("burgers[N=16]", seed);
    const Problem failing = featured("burgers[N=16]", {{"fail", 0.05}}, seed);
    EXPECT_EQ(loss_at_start(failing), loss_at_start(plain));
    EXPECT_TRUE(std::isfinite(loss_at(failing, failing.truth()->reshaped())));
    RandomStream stream(seed, "burgers", "points of a test");
    constexpr int kPoints = 4000;
    int failed = 0;
    for (int i = 0; i < kPoints; ++i) {
      const Vector x = 20 * stream.normal_vector(16);
      const Real loss = loss_at(failing, x);
      failed += std::isnan(loss);
      if (i < 100 && !std::isnan(loss)) {
        EXPECT_EQ(loss, loss_at(plain, x));
      }
    }
    EXPECT_NEAR(static_cast<Real>(failed) / kPoints, 0.05, 5 * 0.0034);
  }
}

TEST(Features, AFailedEvaluationHasNoDerivatives) {
  const Problem failing = featured("burgers[N=16]", {{"fail", 0.5}});
  Vector x = failing.start();
  for (int i = 0; std::isfinite(loss_at(failing, x)); ++i) {
    ASSERT_LT(i, 100);
    x.array() += 0.1;
  }
  EXPECT_TRUE(gradient_at(failing, x).array().isNaN().all());
}

TEST(Features, AreForDirectProblemsOfLeastSquares) {
  EXPECT_THROW(featured("sine[mode=learn]", {{"noise", 0.1}}), UsageError);
  EXPECT_THROW(featured("poisson[N=4]", {{"order", Index{1}}}), UsageError);
}

TEST(Features, JitterIsOfTheCallsAndNotOfWhatIsJudged) {
  constexpr Real kSigma = 0.01;
  const Problem plain = make("poisson[N=32]");
  const Problem noisy = featured("poisson[N=32]", {{"jitter", kSigma}});
  EXPECT_EQ(loss_at_start(plain), loss_at_start(noisy));
  EXPECT_EQ(plain.minimum(), noisy.minimum());
  Point at;
  noisy.forward(noisy.start(), at);
  const Matrix residual = at.y - noisy.target();
  const auto relative = [&](std::uint64_t call) -> Matrix {
    Matrix y = at.y;
    noisy.jitter()->disturb(call, noisy.target(), y);
    return (y - at.y).cwiseQuotient(residual);
  };
  const Matrix first = relative(0);
  EXPECT_EQ(first, relative(0));
  EXPECT_GT((first - relative(1)).norm(), 0);
  const auto m = static_cast<Real>(first.size());
  EXPECT_NEAR(first.norm() / std::sqrt(m), kSigma, 4 * kSigma / std::sqrt(2 * m));
  EXPECT_NEAR(first.mean(), 0, 4 * kSigma / std::sqrt(m));
}

TEST(Features, DerivativesByDifferencesAreTheExactOnesAtThePriceOfTheirCalls) {
  for (const char* spec : {"brown-dennis", "wood", "burgers[N=32]"}) {
    const Problem exact = make(spec);
    Point at;
    Matrix J, differences;
    exact.forward(exact.start(), at);
    exact.jacobian(J, at);
    for (const auto& [kind, calls, tolerance] :
         {std::tuple{"forward", 1, 1e-5}, std::tuple{"central", 2, 1e-8}}) {
      const Problem problem = featured(spec, {{"derivatives", std::string(kind)}});
      Point point;
      problem.forward(problem.start(), point);
      problem.jacobian(differences, point);
      EXPECT_LE((differences - J).norm(), tolerance * J.norm()) << spec << ", " << kind;
      const auto price = problem.prices()[static_cast<std::size_t>(Oracle::jacobian)];
      EXPECT_EQ(price, calls * problem.unknowns());
    }
    const OracleSet offers = featured(spec, {{"derivatives", std::string("none")}}).offers();
    for (const Oracle oracle :
         {Oracle::pullback, Oracle::jacobian, Oracle::hessian, Oracle::inverse})
      EXPECT_FALSE(offers.contains(oracle)) << spec;
  }
}

// Steps of the square root of rounding would see steps of y instead of its slope.
TEST(Features, DifferencesKnowTheNoiseOfTheValues) {
  const std::string spec = "brown-dennis";
  const Problem exact = make(spec);
  const Problem rounded = featured(spec, {{"digits", Real{6}}});
  const Real noise = relative_noise(rounded, rounded.start());
  EXPECT_GT(noise, 1e-9);
  EXPECT_LT(noise, 1e-5);
  EXPECT_LT(relative_noise(exact, exact.start()), 1e-14);
  const Problem jittered = featured(spec, {{"jitter", 1e-3}});
  EXPECT_GT(relative_noise(jittered, jittered.start()), 1e-4);
  EXPECT_LT(relative_noise(jittered, jittered.start()), 1e-2);
  Point at, point;
  Matrix J, differences;
  exact.forward(exact.start(), at);
  exact.jacobian(J, at);
  const Problem problem =
      featured(spec, {{"digits", Real{6}}, {"derivatives", std::string("forward")}});
  problem.forward(problem.start(), point);
  problem.jacobian(differences, point);
  EXPECT_LE((differences - J).norm(), 0.05 * J.norm());
}

// θ = x/|x₀|, in which bounds, solution and products are those of x; x comes back to the last bit.
TEST(ScaledUnknowns, AreOnesAtTheStartAndOtherwiseTheSameProblem) {
  const Problem plain = featured("nist[dataset=Misra1a]", {{"bounds", std::string("wide")}});
  const Problem scaled =
      with_scaled_unknowns(featured("nist[dataset=Misra1a]", {{"bounds", std::string("wide")}}));
  const Vector& x = plain.start();
  EXPECT_EQ(scaled.start().cwiseAbs(), Vector::Ones(x.size()));
  EXPECT_EQ(scaled.in_own_units(scaled.start()), x);
  EXPECT_EQ(scaled.own_units().scales, x.cwiseAbs());
  EXPECT_EQ(loss_at(scaled, scaled.start()), loss_at(plain, x));
  EXPECT_LT((gradient_at(scaled, scaled.start()) -
             gradient_at(plain, x).cwiseProduct(scaled.own_units().scales))
                .norm(),
            1e-13 * gradient_at(scaled, scaled.start()).norm());
  EXPECT_EQ(scaled.in_own_units(scaled.bounds()->upper), plain.bounds()->upper);
  EXPECT_EQ(scaled.in_own_units(scaled.bounds()->lower), plain.bounds()->lower);
  EXPECT_NEAR(scaled.x_error(scaled.start()), plain.x_error(x), 1e-13 * plain.x_error(x));
  EXPECT_EQ(scaled.x_scale(scaled.batch()), plain.x_scale(plain.batch()));
  EXPECT_EQ(with_scaled_unknowns(make("rosenbrock")).own_units().scales.size(), 0);
}

}  // namespace
}  // namespace isoline::problems
