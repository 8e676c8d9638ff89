// Laws and figures of the grid problems and of the random fields they seek.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/decompose.h"
#include "make.h"
#include "problems/random_fields.h"

namespace isoline::problems {
namespace {

Vector forward(const Problem& problem, const Vector& x) {
  Point at;
  problem.forward(x, at);
  return at.y.reshaped();
}

// Σ_ij a_i b_j on an N×N grid as one column.
Vector outer(const Vector& a, const Vector& b) { return (a * b.transpose()).reshaped(); }

Vector sine_mode(Index p, Index N) {
  return (Vector::LinSpaced(N, 1, Real(N)) * (std::numbers::pi * Real(p) / Real(N + 1)))
      .array()
      .sin();
}

Vector cosine_mode(Index k, Index N) {
  return (Vector::LinSpaced(N, 0, Real(N - 1)) * (2 * std::numbers::pi * Real(k) / Real(N)))
      .array()
      .cos();
}

// ∇²P(x) = x by the stencil, to some hundreds of roundings of the largest y or x.
TEST(Poisson, SolvesWhatItsStencilSays) {
  for (const Index N : {2, 9, 64, 512}) {
    const Problem problem = make("poisson[N=" + std::to_string(N) + "]");
    const Vector x = RandomStream(2, "poisson", "test").normal_vector(N * N);
    const Vector y = forward(problem, x);
    Vector again = -4 * y;
    for (Index cell = 0; cell < N * N; ++cell) {
      const Index i = cell % N;
      if (i > 0) again[cell] += y[cell - 1];
      if (i < N - 1) again[cell] += y[cell + 1];
      if (cell >= N) again[cell] += y[cell - N];
      if (cell < N * N - N) again[cell] += y[cell + N];
    }
    EXPECT_LT((again - x).cwiseAbs().maxCoeff(), 1e-13 * x.cwiseAbs().maxCoeff()) << N;
  }
}

// 81 numbers a sample: each begins elsewhere between two vector registers.
TEST(Poisson, GivesASampleTheSameBitsInAnyColumn) {
  const Matrix x = RandomStream(3, "poisson", "test").normal_vector(81).replicate(1, 5);
  const Problem problem = make("poisson[mode=learn,N=9,batch=5,network=mlp]");
  Point at;
  problem.physics_forward(x, problem.batch(), at);
  for (Index b = 1; b < 5; ++b) EXPECT_EQ(at.y.col(b), at.y.col(0)) << b;
}

// (sin(64π/130)/sin(π/130))² = 1711.66, the condition of P on 64×64 cells.
TEST(Poisson, ConditionIsThePublishedOne) {
  const Problem problem = make("poisson");
  const Vector low = outer(sine_mode(1, 64), sine_mode(1, 64));
  const Vector high = outer(sine_mode(64, 64), sine_mode(64, 64));
  const Real ratio =
      forward(problem, low).norm() / low.norm() / (forward(problem, high).norm() / high.norm());
  EXPECT_NEAR(ratio, 1711.6613758258018, 1e-9);  // rounding against the smaller norm
}

// Published statistics over a batch of 128: std 13.8 of y*, mean 0.804 of |x*|.
TEST(Poisson, TargetsHaveThePublishedStatistics) {
  constexpr int kSeeds = 64;
  Real deviation = 0, magnitude = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Problem problem = make("poisson", seed);
    deviation += std::sqrt(problem.target().squaredNorm() / 4096);
    magnitude += problem.truth()->cwiseAbs().mean();
  }
  EXPECT_NEAR(deviation / kSeeds, 13.8, 0.8);     // fields spread by 1.5: four errors of 0.19
  EXPECT_NEAR(magnitude / kSeeds, 0.804, 0.005);  // the published three digits, and as much again
}

TEST(SmoothNoise, HasMeanZeroDeviationOneAndNoCoarseModes) {
  RandomStream stream(1, "noise", "test");
  const Vector field = smooth_noise(64, 10, 1, stream);
  EXPECT_NEAR(field.mean(), 0, 1e-14);                // rounding
  EXPECT_NEAR(field.squaredNorm() / 4096, 1, 1e-13);  // rounding
  const auto amplitude = [&](Index k, Index l) {      // of cos · cos
    return std::abs(field.dot(outer(cosine_mode(k, 64), cosine_mode(l, 64)))) / 4096;
  };
  EXPECT_LE(amplitude(2, 0), 1e-14);  // |n|² = 4 is not above 4.096: rounding alone
  EXPECT_LE(amplitude(1, 1), 1e-14);
  EXPECT_GE(amplitude(2, 1), 1e-4);  // |n|² = 5 is
}

// Published statistics over 128 samples: mean 0.088, std 0.238, Σ|x*| 360; y* std 0.154.
TEST(SoftRectangles, HaveThePublishedStatistics) {
  constexpr int kSeeds = 512;
  Real mean = 0, square = 0, target_square = 0, target_mean = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Problem problem = make("heat", seed);
    mean += problem.truth()->mean() / kSeeds;
    square += problem.truth()->squaredNorm() / 4096 / kSeeds;
    target_mean += problem.target().mean() / kSeeds;
    target_square += problem.target().squaredNorm() / 4096 / kSeeds;
  }
  // Four standard errors of 128 published samples, each spread by about 0.055 in the mean.
  EXPECT_NEAR(mean, 0.088, 0.02);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 0.238, 0.04);
  EXPECT_NEAR(std::sqrt(target_square - target_mean * target_mean), 0.154, 0.03);
}

TEST(SoftRectangles, ScaleWithTheGrid) {
  const Real difference = make("heat[N=128]", 1).truth()->mean() - make("heat", 1).truth()->mean();
  EXPECT_LE(std::abs(difference), 0.01);  // but for the edges, whose softness stays one cell
}

// exp(−8 (2π)²/64²), computed apart from this code.
TEST(Heat, TheLowestModeIsDampedByItsFactor) {
  const Problem problem = make("heat");
  const Vector x = outer(cosine_mode(1, 64), Vector::Ones(64));
  EXPECT_LE((forward(problem, x) - 0.925791451203618 * x).norm(), 1e-14 * x.norm());  // rounding
}

TEST(Heat, ConservesTheMean) {
  const Problem problem = make("heat");
  EXPECT_NEAR(problem.target().mean(), problem.truth()->mean(), 1e-15);  // rounding
}

Vector damped_inverse(const Problem& problem, const Vector& y, const Vector& x0) {
  Point at;
  problem.forward(x0, at);
  Matrix x(problem.inputs(), 1);
  EXPECT_TRUE(problem.local_inverse(y, x, at).all());
  return x.reshaped();
}

TEST(Heat, DampedInverseRecoversBandLimitedInput) {
  const Problem problem = make("heat");
  Vector x = Vector::Constant(4096, 0.3);
  for (const auto& [k, l] : {std::pair{1, 0}, {2, 3}, {5, 1}, {0, 7}})  // |k| < 0.2 cycles a cell
    x += 0.05 * outer(cosine_mode(k, 64), cosine_mode(l, 64));
  const Vector found = damped_inverse(problem, forward(problem, x), Vector::Zero(4096));
  // Modes without evidence hold rounding alone, and the weakest mode kept is damped to e^−3.8.
  EXPECT_LE((found - x).norm(), 1e-9 * x.norm());
}

// Where p ≥ 0.68, s > σ, so no mode grows by more than e^ℓ = N/s < N/σ ≤ N/1e-8.
TEST(Heat, DampedInverseHasBoundedGain) {
  const Problem problem = make("heat");
  RandomStream stream(1, "heat", "test");
  for (const Real size : {1e-12, 1e-6, 1.0, 1e6}) {
    const Vector d = size * stream.normal_vector(4096);
    const Real sigma = 1e-6 * d.norm() + 1e-8;
    const Vector x = damped_inverse(problem, d, Vector::Zero(4096));
    EXPECT_LE(x.norm(), std::max(1.0, 64 / sigma) * d.norm()) << size;
  }
}

// Published, from the mean of x*: Σ|x − x*| falls from 586 to 119 at the first use and, without the
// floor of 1e-8, grows to 9058 by the third. With the floor it must not grow again.
TEST(Heat, RepeatedDampedInversesFollowThePublishedErrorsAndDoNotDiverge) {
  constexpr int kSeeds = 64, kSteps = 20;
  Vector sums = Vector::Zero(kSteps + 1);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Problem problem = make("heat", seed);
    const Vector truth = problem.truth()->reshaped();
    Vector x = Vector::Constant(4096, truth.mean());
    for (int step = 0; step <= kSteps; ++step) {
      sums[step] += (x - truth).lpNorm<1>() / kSeeds;
      x = damped_inverse(problem, problem.target().reshaped(), x);
    }
  }
  EXPECT_NEAR(sums[0], 586, 90);  // four standard errors of the published 128 samples
  EXPECT_NEAR(sums[1], 119, 25);  // spreads likewise
  for (int step = 1; step < kSteps; ++step)
    EXPECT_LE(sums[step + 1], 1.001 * sums[step]) << step;  // level but for noise in weak modes
}

TEST(PoissonHig, HasThePublishedSpectrum) {
  const Problem problem = make("poisson-hig");
  Point at;
  problem.forward(problem.start(), at);
  Matrix L;
  problem.jacobian(L, at);
  EXPECT_EQ(L, L.transpose());
  SymmetricEigen eigen;
  ASSERT_TRUE(symmetric_eigen(L, eigen));
  EXPECT_NEAR(eigen.lambda[0], -7.76, 5e-3);    // as printed
  EXPECT_NEAR(eigen.lambda[63], -0.241, 5e-4);  // as printed
  EXPECT_NEAR(eigen.lambda[0] / eigen.lambda[63], 32.16, 5e-3);
  const Real s = std::sin(std::numbers::pi / 18);
  EXPECT_NEAR(eigen.lambda[63], -8 * s * s, 1e-13);
}

TEST(PoissonHig, HasThePublishedSizes) {
  const Problem problem = make("poisson-hig[mode=learn]");
  EXPECT_EQ(problem.unknowns(), 24896);
  EXPECT_EQ(problem.samples(), 64);
  EXPECT_EQ(problem.residuals(), 4096);
  EXPECT_TRUE(problem.has_fresh_batches());
  EXPECT_EQ(problem.batch().input, problem.target());
}

// White noise over |k|²: of N(0, 1) times k⁻² a mode has the power k⁻⁴. What is drawn has no mean
// and the deviation 1.
TEST(PoissonHig, TruthIsNoiseThatFallsWithTheSquareOfTheWaveNumber) {
  constexpr Index kSamples = 4000;
  const Problem problem = make("poisson-hig[mode=learn,batch=" + std::to_string(kSamples) + "]", 1);
  const Matrix& truth = problem.batch().truth;
  EXPECT_LT(truth.colwise().mean().cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((truth.colwise().squaredNorm().array() / 64 - 1).abs().maxCoeff(), 1e-13);
  const auto powers = [&](Index k) -> Eigen::ArrayXd {  // along the first axis, of each sample
    Vector wave(64), other(64);
    for (Index i = 0; i < 64; ++i) {
      const Real phase = 2 * std::numbers::pi * static_cast<Real>(k * (i % 8)) / 8;
      wave[i] = std::cos(phase);
      other[i] = std::sin(phase);
    }
    return (truth.transpose() * wave).array().square() +
           (truth.transpose() * other).array().square();
  };
  // Of the logarithm of two powers of one sample, which its normalization leaves alone, the mean is
  // exact: each power has an exponential distribution, whose logarithm deviates by π/√6.
  const Real error = std::numbers::pi / std::sqrt(3.0) / std::sqrt(Real(kSamples));
  for (Index k = 2; k <= 3; ++k) {
    const Real fall = (powers(1) / powers(k)).log().mean();
    EXPECT_NEAR(fall, 4 * std::log(static_cast<Real>(k)), 4 * error) << k;
  }
}

}  // namespace
}  // namespace isoline::problems
