// Learning problems: their samples, and the derivatives through a network.
#include "problems/learning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/trace.h"
#include "make.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

const std::vector<std::string> kLearned = {
    "sine[mode=learn,xi=32]",
    "exponential[mode=learn]",
    "poisson[mode=learn,N=16,batch=3,network=unet[levels=2]]",
    "heat[mode=learn,N=16,batch=3,network=unet[levels=2]]",
    "burgers[mode=learn,N=16,batch=3]",
    "hig-toy"};

Batch batch_of(const Problem& problem, std::int64_t step) {
  Batch batch;
  problem.draw_batch(step, batch);
  return batch;
}

TEST(Learning, ShuffledInputsAreThoseOfTheNextSample) {
  const std::string spec = "burgers[mode=learn,N=16,data=5,batch=5";
  const Batch plain = batch_of(make(spec + "]"), 0),
              shuffled = batch_of(make(spec + ",inputs=shuffled]"), 0);
  EXPECT_EQ(shuffled.target, plain.target);
  EXPECT_EQ(shuffled.truth, plain.truth);
  EXPECT_EQ(plain.input, plain.target);
  EXPECT_EQ(shuffled.input.leftCols(4), plain.input.rightCols(4));
  EXPECT_EQ(shuffled.input.col(4), plain.input.col(0));
}

TEST(Learning, EachStepHasItsOwnSamplesAndTheSameEveryTime) {
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, 1), again = make(spec, 1), other = make(spec, 2);
    EXPECT_EQ(batch_of(problem, 3).target, batch_of(again, 3).target) << spec;
    EXPECT_NE(batch_of(problem, 3).target, batch_of(other, 3).target) << spec;
    if (problem.has_fresh_batches()) {
      EXPECT_NE(batch_of(problem, 3).target, batch_of(problem, 4).target) << spec;
    }
    Batch validation;
    problem.draw_validation(validation);
    EXPECT_NE(validation.target.col(0), problem.target().col(0)) << spec;
  }
}

TEST(Learning, BatchSizesAndSweepsSeeTheSameSamples) {
  const Problem small = make("sine[mode=learn,batch=4]"), large = make("sine[mode=learn,batch=8]");
  EXPECT_EQ(batch_of(large, 0).target.leftCols(4), batch_of(small, 0).target);
  EXPECT_EQ(batch_of(large, 0).target.rightCols(4), batch_of(small, 1).target);
  EXPECT_EQ(batch_of(make("sine[mode=learn,xi=1]"), 5).target,
            batch_of(make("sine[mode=learn,xi=64]"), 5).target);
}

TEST(Learning, OnFiniteDataEveryStepHasAllSamples) {
  const Problem problem = make("sine[mode=learn,data=37]");
  EXPECT_FALSE(problem.has_fresh_batches());
  EXPECT_EQ(problem.samples(), 37);
  EXPECT_EQ(batch_of(problem, 9).target, problem.target());
}

// Instance 2 with start 1: the data of seed 2, θ₀ and fresh batches of seed 1.
TEST(Learning, APairHasTheDataOfItsInstanceAndTheStartOfItsStart) {
  const std::uint64_t pair = seed_of(2, 1);
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, pair), instance = make(spec, 2), start = make(spec, 1);
    EXPECT_EQ(problem.start(), start.start()) << spec;
    Batch validation, expected;
    problem.draw_validation(validation);
    instance.draw_validation(expected);
    EXPECT_EQ(validation.target, expected.target) << spec;
  }
  for (const auto& [spec, seed] : {std::pair{"sine[mode=learn]", 1U},
                                   {"sine[mode=learn,data=37]", 2U},
                                   {"quantum-dipole[mode=learn,epoch=200,batch=100]", 2U}})
    EXPECT_EQ(batch_of(make(spec, pair), 1).target, batch_of(make(spec, seed), 1).target) << spec;
}

TEST(Learning, MethodsOfOneSeedStartAlikeAndSeedsApart) {
  EXPECT_EQ(make("sine[mode=learn,xi=1]", 3).start(), make("sine[mode=learn,xi=32]", 3).start());
  EXPECT_NE(make("sine[mode=learn]", 3).start(), make("sine[mode=learn]", 4).start());
}

// The truth makes the target, and has no error in x.
TEST(Learning, TruthIsWhatWasObserved) {
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, 1);
    const Batch batch = batch_of(problem, 2);
    Point at;
    problem.physics_forward(batch.truth, batch, at);
    EXPECT_LT((at.y - batch.target).norm(), 1e-11 * batch.target.norm()) << spec;  // rounding
    EXPECT_LT(problem.x_error(batch.truth, batch), 1e-11 * batch.truth.cwiseAbs().sum()) << spec;
  }
}

TEST(Learning, ExponentialTargetsAreLogUniform) {
  Batch validation;
  make("exponential[mode=learn]").draw_validation(validation);
  const Eigen::ArrayXXd x = validation.truth;
  EXPECT_GE(x.minCoeff(), -12);
  EXPECT_LE(x.maxCoeff(), 0);
  const Real error = 12 / std::sqrt(12.0 * 1024);  // of the mean of 1,024 samples
  EXPECT_NEAR(x.mean(), -6, 4 * error);
}

TEST(Learning, SineTeachesEveryBranchOfItsInverse) {
  const Problem problem = make("sine[mode=learn,xi=1,phi=0]");
  Batch validation;
  problem.draw_validation(validation);
  const Eigen::ArrayXd phase = 10 * validation.truth.row(0).array();  // γ z₁ with ξ = 1, φ = 0
  EXPECT_LT(phase.minCoeff(), -2 * M_PI);
  EXPECT_GT(phase.maxCoeff(), 2 * M_PI);
  EXPECT_LE(validation.target.cwiseAbs().maxCoeff(), 1);
}

// Poisson's inverse is linear and exact: what SIP aims at is the label of supervised training.
TEST(Learning, PoissonTargetsOfSipAreTheLabels) {
  const Problem problem = make("poisson[mode=learn,N=16,batch=3,network=unet[levels=2]]");
  Point at;
  problem.forward(problem.start(), at);
  Matrix aimed(problem.inputs(), problem.samples());
  EXPECT_TRUE(problem.local_inverse(problem.target(), aimed, at).all());
  const Matrix& label = problem.batch().truth;
  EXPECT_LT((aimed - label).norm(), 1e-11 * label.norm());  // rounding by the condition of ∇²
}

TEST(Learning, HeatGivesTheNetworkTheMean) {
  const Problem problem = make("heat[mode=learn,N=16,batch=3,network=unet[levels=2]]");
  Point at;
  problem.forward(problem.start(), at);
  const Eigen::RowVectorXd means = at.x().colwise().mean() - problem.batch().truth.colwise().mean();
  EXPECT_LT(means.cwiseAbs().maxCoeff(), 1e-6);  // the network is of single precision
}

// ½⟨sin² 6t⟩ + ½⟨cos² 9t⟩ over t ∈ [−1, 1] is ½ + sin(18)/72 − sin(12)/48, and the second half
// alone, what a network leaves that fits y₁ only, is ¼ + sin(18)/72 = 0.2396.
TEST(Learning, ToyHasThePublishedFloors) {
  const Problem problem = make("hig-toy[lambda=0.01,data=100000]");
  const Matrix y = problem.target();
  EXPECT_NEAR(0.5 * y.row(1).squaredNorm() / 1e5, 0.25 + std::sin(18.0) / 72, 2e-3);  // 1/√1e5
  EXPECT_NEAR(0.5 * y.squaredNorm() / 1e5, 0.5005, 3e-3);
}

TEST(Learning, ToyWatchesItsNeuronsAndItsPath) {
  const Problem problem = make("hig-toy[lambda=0.01]");
  EXPECT_EQ(problem.unknowns(), 30);
  Point at;
  problem.forward(problem.start(), at);
  Vector values(static_cast<Index>(problem.series().names.size()));
  problem.series().evaluate(problem, problem.start(), at, values);
  EXPECT_LT(std::abs(values[0]), 1);  // of tanh
  EXPECT_GT(values[1], 0);
  Index nearest = 0;
  (problem.batch().input.row(0).array() - M_PI / 9).abs().minCoeff(&nearest);
  EXPECT_EQ(values.segment(2, 2), at.y.col(nearest));
}

// The series of learning problems, against closed forms and finite differences; spectra against
// single modes.

// The series of a problem as the meter traces them: on the validation.
std::map<std::string, Real> traced(const Problem& problem, const Vector& theta) {
  Batch validation;
  problem.draw_validation(validation);
  Point at;
  problem.forward(theta, validation, at);
  Vector values(static_cast<Index>(problem.series().names.size()));
  problem.series().evaluate(problem, theta, at, values);
  std::map<std::string, Real> by_name;
  for (std::size_t i = 0; i < problem.series().names.size(); ++i)
    by_name[problem.series().names[i]] = values[static_cast<Index>(i)];
  return by_name;
}

// ½Σ(x − x*)² of x = 0 is half the sum of squares of x*.
TEST(Watches, HalfTheSquaredErrorIsThatOfEachSample) {
  for (const std::string name : {"poisson", "heat"}) {
    const Problem problem =
        make(name + "[mode=learn,N=8,batch=2,network=unet[levels=2,filters=2]]", 1);
    Batch validation;
    problem.draw_validation(validation);
    Point at;
    problem.forward(problem.start(), validation, at);
    Real sum = 0;
    for (Index b = 0; b < at.x().cols(); ++b)
      for (Index i = 0; i < at.x().rows(); ++i)
        sum += 0.5 * std::pow(at.x()(i, b) - validation.truth(i, b), 2) / 64;
    EXPECT_NEAR(traced(problem, problem.start()).at("½Σ(x − x*)²"), sum, 1e-12 * sum) << name;
  }
}

TEST(Watches, VorticityIsAShareOfThatOfTheTruth) {
  const Problem problem = make(
      "navier-stokes[mode=learn,N=16,batch=1,network=unet[levels=2,filters=2],count=vorticity]");
  Batch validation;
  problem.draw_validation(validation);
  Point at;
  problem.forward(problem.start(), validation, at);
  at.physics.x = 3 * validation.truth;
  Vector values(static_cast<Index>(problem.series().names.size()));
  problem.series().evaluate(problem, problem.start(), at, values);
  EXPECT_NEAR(values[0], 3, 1e-12);
}

TEST(Watches, AreThoseAskedForAndNoMoreThanATraceHolds) {
  const std::vector<std::pair<std::string, std::size_t>> counts = {
      {"sine[mode=learn]", 0},
      {"sine[mode=learn,watch=noise]", 4},
      {"exponential[mode=learn,watch=noise]", 10},
      {"poisson[mode=learn,N=16,watch=noise]", 5},
      {"heat[mode=learn,N=16]", 1},
      {"heat[mode=learn,N=16,watch=spectrum]", 13},
      {"hig-toy", 19},
      {"hig-toy[watch=noise]", 23},
      {"hig-toy[network=mlp[layers=20-3,activation=tanh]]", 11}};
  for (const auto& [spec, count] : counts) {
    const std::vector<std::string> names = make(spec).series().names;
    std::size_t letters = 0;
    for (const std::string& name : names) letters += name.size() + 1;
    EXPECT_EQ(names.size(), count) << spec;
    EXPECT_LE(names.size(), static_cast<std::size_t>(Trace::kSeries)) << spec;
    EXPECT_LT(letters, static_cast<std::size_t>(Trace::kText)) << spec;
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), count) << spec;
  }
  EXPECT_THROW(make("sine[mode=learn,watch=spectrum]"), UsageError);
  EXPECT_THROW(make("sine[mode=learn,watch=colour]"), UsageError);
}

constexpr const char* kNoisy =
    "sine[mode=learn,xi=3,watch=noise,batch=200,network=mlp[layers=3,activation=tanh,"
    "precision=double]]";

// The gradient of f at θ by central differences.
template <class F>
Vector differences(const F& f, const Vector& theta) {
  const Real h = 1e-5;
  Vector gradient(theta.size());
  for (Index i = 0; i < theta.size(); ++i) {
    Vector plus = theta, minus = theta;
    plus[i] += h;
    minus[i] -= h;
    gradient[i] = (f(plus) - f(minus)) / (2 * h);
  }
  return gradient;
}

// Standard deviation over mean of the lengths, and 1 − the mean cosine, pair by pair.
std::pair<Real, Real> noise_by_pairs(const std::vector<Vector>& gradients) {
  Real mean = 0, square = 0, cosine = 0;
  const auto n = static_cast<Real>(gradients.size());
  for (const Vector& g : gradients) mean += g.norm() / n;
  for (const Vector& g : gradients) square += std::pow(g.norm() - mean, 2) / (n - 1);
  for (std::size_t i = 0; i < gradients.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      cosine += gradients[i].normalized().dot(gradients[j].normalized()) / (n * (n - 1) / 2);
  return {std::sqrt(square) / mean, 1 - cosine};
}

// 1,024 samples in parts of 200 make five; the last 24 are left.
TEST(Watches, NoiseIsThatOfTheGradientsOfParts) {
  const Problem problem = make(kNoisy, 1);
  const Vector theta = problem.start();
  Batch validation;
  problem.draw_validation(validation);
  std::vector<Vector> gradients, updates;
  for (Index first = 0; first + 200 <= 1024; first += 200) {
    Batch part;
    part.input = validation.input.middleCols(first, 200);
    part.target = validation.target.middleCols(first, 200);
    Point at;
    gradients.push_back(differences(
        [&](const Vector& moved) {
          problem.forward(moved, part, at);
          return at.loss;
        },
        theta));
    problem.forward(theta, part, at);
    Matrix aimed(2, 200);
    ASSERT_TRUE(problem.local_inverse(part.target, aimed, at).all());
    updates.push_back(differences(
        [&](const Vector& moved) {
          problem.forward(moved, part, at);
          return 0.5 * (at.x() - aimed).squaredNorm() / 200;
        },
        theta));
  }
  const auto found = traced(problem, theta);
  const auto [length, direction] = noise_by_pairs(gradients);
  const auto [own_length, own_direction] = noise_by_pairs(updates);
  constexpr Real kDifferences = 1e-7;  // h² of third derivatives, and ε/h of rounding
  EXPECT_NEAR(found.at("noise of ∇L: length"), length, kDifferences);
  EXPECT_NEAR(found.at("noise of ∇L: direction"), direction, kDifferences);
  EXPECT_NEAR(found.at("noise of U: length"), own_length, kDifferences);
  EXPECT_NEAR(found.at("noise of U: direction"), own_direction, kDifferences);
  EXPECT_GT(length, 1e-3);
  EXPECT_GT(direction, 1e-4);
}

// x = 0 is off by −x*, which lies between the ends of the decade in y*; the decades' errors, each
// times its count, make up the error of all.
TEST(Watches, ErrorsOfTheExponentialAreThoseOfTheDecadesOfItsTargets) {
  const Problem problem = make("exponential[mode=learn,network=mlp[layers=2,activation=tanh]]", 1);
  const auto found = traced(problem, Vector::Zero(problem.unknowns()));
  Batch validation;
  problem.draw_validation(validation);
  const std::vector<std::pair<std::string, Real>> decades = {
      {"error in x, y* from 0.1 to 1", 0.1},      {"error in x, y* from 1e-2 to 1e-1", 1e-2},
      {"error in x, y* from 1e-3 to 1e-2", 1e-3}, {"error in x, y* from 1e-4 to 1e-3", 1e-4},
      {"error in x, y* from 1e-5 to 1e-4", 1e-5}, {"error in x, y* below 1e-5", 1e-6}};
  Real all = 0;
  for (const auto& [name, low] : decades) {
    Real sum = 0, count = 0;
    for (Index b = 0; b < 1024; ++b) {
      const Real target = validation.target(0, b);
      if (target <= low || target > 10 * low) continue;
      sum -= validation.truth(0, b);
      ++count;
    }
    ASSERT_GT(count, 0) << name;
    EXPECT_NEAR(found.at(name), sum / count, 1e-12) << name;
    all += sum / 1024;
  }
  EXPECT_NEAR(problem.x_error(Matrix::Zero(1, 1024), validation), all, 1e-12);
}

TEST(Watches, ANeuronThatIsOneForEveryInputIsSaturated) {
  const Problem problem = make("hig-toy", 1);
  Vector theta = problem.start();  // the weights of the first layer, then its biases
  theta.head(14) << Vector::Constant(7, 0.5), 50, -50, 50, Vector::Zero(4);
  theta[4] = 1e-6;  // without spread as well, and not saturated
  const auto found = traced(problem, theta);
  EXPECT_EQ(found.at("saturated neurons"), 3);
  EXPECT_EQ(found.at("mean of neuron 1"), 1);
  EXPECT_EQ(found.at("mean of neuron 2"), -1);
  EXPECT_EQ(found.at("spread of neuron 3"), 0);
  EXPECT_LT(found.lower_bound("mean of the hidden")->second, 0.3);  // which shows nothing of it
  Batch validation;
  problem.draw_validation(validation);
  const Eigen::ArrayXd value = (0.5 * validation.input.row(0).array().transpose()).tanh();
  EXPECT_NEAR(found.at("mean of neuron 4"), value.mean(), 1e-14);
  EXPECT_NEAR(found.at("spread of neuron 7"), std::sqrt((value - value.mean()).square().mean()),
              1e-14);
  EXPECT_EQ(traced(problem, problem.start()).at("saturated neurons"), 0);
}

Vector values_of(const Series& series, const Problem& problem, const Vector& theta, Point& at) {
  Vector values(static_cast<Index>(series.names.size()));
  series.evaluate(problem, theta, at, values);
  return values;
}

Vector cosine_mode(Index k, Index l, Index N) {
  Matrix mode(N, N);
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      mode(i, j) =
          std::cos(2 * std::numbers::pi * static_cast<Real>(i * k + j * l) / static_cast<Real>(N));
  return mode.reshaped();
}

// Heat multiplies a mode by e^(−ℓ), ℓ = 8 (2π |k|)², so ∂L/∂x has it times e^(−2ℓ), and U, where
// the data carry evidence, whole: what is missing in x = x* − a c₂ − b c₅ on 32×32 cells.
TEST(Spectra, OfHeatAreThoseOfItsModes) {
  constexpr Index N = 32;
  const Problem problem = make("heat[N=32]", 1);
  const Real a = 0.02, b = 0.05;
  const Vector theta = problem.truth()->reshaped() - a * cosine_mode(1, 1, N) -
                       b * cosine_mode(0, 5, N);  // |k| = √2/32 = 0.044 and 5/32 = 0.156
  Point at;
  problem.forward(theta, at);
  const Vector values = values_of(spectrum(N), problem, theta, at);
  const auto kept = [](Real k) { return std::exp(-2 * 8 * std::pow(2 * std::numbers::pi * k, 2)); };
  const auto shares = [](Real low, Real high) {
    const Real total = low * low + high * high;
    return Eigen::Vector4d(low * low / total, 0, high * high / total, 0);
  };
  const Eigen::Vector4d missing = shares(a, b),
                        pulled = shares(a * kept(std::sqrt(2.0) / 32), b * kept(5.0 / 32));
  EXPECT_LT((values.head(4) - missing).norm(), 1e-12);      // rounding
  EXPECT_LT((values.segment(4, 4) - pulled).norm(), 1e-9);  // rounding, of the small against y
  EXPECT_LT((values.tail(4) - missing).norm(), 1e-6);       // modes without evidence hold rounding
  EXPECT_GT(pulled[0], 0.99);                               // the adjoint has removed the detail
}

// A wave of the highest number and one along a single axis are counted once each.
TEST(Spectra, CountEveryModeOnce) {
  constexpr Index N = 16;
  const Problem problem = make("heat[N=16]", 1);
  const Vector theta = problem.truth()->reshaped() - 0.3 * cosine_mode(N / 2, N / 2, N) -
                       0.3 * std::sqrt(2.0) * cosine_mode(2, 0, N);
  Point at;
  problem.forward(theta, at);
  const Vector values = values_of(spectrum(N), problem, theta, at);
  // A cosine has the mean square ½ but for the highest, (−1)^(i+j), which has 1.
  EXPECT_NEAR(values[2], 0.5, 1e-12);
  EXPECT_NEAR(values[3], 0.5, 1e-12);
}

}  // namespace
}  // namespace isoline::problems
