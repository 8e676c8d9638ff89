// The Poisson problem of half-inverse gradients: its spectrum, its noise, its sizes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/decompose.h"
#include "make.h"

namespace isoline::problems {
namespace {

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

TEST(PoissonHig, InverseIsTheTruth) {
  const Problem problem = make("poisson-hig[mode=learn,batch=3]", 2);
  Point at;
  problem.forward(problem.start(), at);
  Matrix found(64, 3);
  EXPECT_TRUE(problem.local_inverse(problem.target(), found, at).all());
  EXPECT_LT((found - problem.batch().truth).norm(), 1e-12);  // rounding, by a condition of 32
}

}  // namespace
}  // namespace isoline::problems
