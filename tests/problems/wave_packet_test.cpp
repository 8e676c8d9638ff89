// Wave packets: the signal, its noise, what the noise leaves of x*, and the local inverse.
#include <gtest/gtest.h>

#include <cmath>

#include "make.h"

namespace isoline::problems {
namespace {

Vector signal(const Problem& problem, const Vector& x) {
  Point at;
  problem.physics_forward(x, problem.batch(), at);
  return at.y;
}

TEST(WavePacket, IsACosineUnderAGaussianAtItsTimes) {
  const Problem problem = make("wave-packet");
  const Vector y = signal(problem, Eigen::Vector4d(1.5, 0.25, 0.8, 3));
  ASSERT_EQ(y.size(), 64);
  for (Index i = 0; i < 64; ++i) {
    const Real late = -8 + 16 * static_cast<Real>(i) / 63 - 0.25;
    const Real expected = 1.5 * std::exp(-late * late / 1.28) * std::cos(3 * late);
    EXPECT_NEAR(y[i], expected, 1e-14) << i;  // rounding, of terms up to 1.5
  }
}

TEST(WavePacket, CountsNoSignOfWidthAndFrequency) {
  const Problem problem = make("wave-packet[noise=0]", 4);
  const Vector truth = *problem.truth();
  for (const Index i : {2, 3}) {
    Vector mirrored = truth;
    mirrored[i] = -truth[i];
    EXPECT_EQ(signal(problem, mirrored), signal(problem, truth)) << i;
    EXPECT_EQ(problem.x_error(mirrored), 0) << i;
  }
  EXPECT_GT(problem.x_error(-truth), 0.5);
}

// The least of ½‖r‖² over 64 samples by 4 unknowns is ½σ²χ² of 60 degrees of freedom, whose mean
// over 100 instances lies within 4 of its standard deviations, ½σ²√(120/100) each.
TEST(WavePacket, LeavesTheNoiseAsItsLeastLoss) {
  constexpr Real kNoise = 0.1, kCount = 100;
  Real sum = 0, floors = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Problem problem = make("wave-packet[noise=0.1]", seed);
    sum += problem.minimum().value();
    floors += problem.x_floor(problem.batch());
    EXPECT_FALSE(problem.truth().has_value());
  }
  const Real unit = 0.5 * kNoise * kNoise;
  EXPECT_NEAR(sum / kCount, 60 * unit, 4 * unit * std::sqrt(120 / kCount));
  EXPECT_GT(floors / kCount, 0.01);
  EXPECT_LT(floors / kCount, 0.3);
  EXPECT_EQ(make("wave-packet[noise=0]").minimum(), 0);
  EXPECT_EQ(make("wave-packet[noise=0]").x_floor(make("wave-packet[noise=0]").batch()), 0);
}

// From within a tenth of every unknown, without noise.
TEST(WavePacket, LocalInverseFindsAPacketNearby) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make("wave-packet[noise=0]", seed);
    const Vector truth = *problem.truth();
    RandomStream stream(seed, "wave-packet", "nearby");
    const Vector factors = stream.uniform_vector(4, 0.9, 1.1);
    Point at;
    problem.physics_forward(truth.cwiseProduct(factors), problem.batch(), at);
    Matrix x(4, 1);
    EXPECT_TRUE(problem.local_inverse(problem.target(), x, at).all());
    EXPECT_LT(problem.x_error(x), 1e-3 * truth.norm()) << seed;
  }
}

TEST(WavePacket, LocalInverseOfWhatIsReachedStays) {
  const Problem problem = make("wave-packet", 3);
  Point at;
  problem.forward(problem.start(), at);
  Matrix x(4, 1);
  EXPECT_TRUE(problem.local_inverse(at.y, x, at).all());
  EXPECT_EQ(x, at.x());
}

TEST(WavePacket, IsLearnedFromItsNoisySignal) {
  const Problem problem = make("wave-packet[mode=learn,noise=0.1]", 1);
  Batch batch;
  problem.draw_validation(batch);
  EXPECT_EQ(batch.input, batch.target);
  EXPECT_EQ(problem.x_error(batch.truth, batch), 0);
  Point at;
  problem.physics_forward(batch.truth, batch, at);
  const Matrix noise = batch.target - at.y;
  const Real count = static_cast<Real>(noise.size());
  EXPECT_NEAR(noise.norm() / std::sqrt(count), 0.1, 4 * 0.1 / std::sqrt(2 * count));
  const Vector least = batch.truth.rowwise().minCoeff(), most = batch.truth.rowwise().maxCoeff();
  EXPECT_TRUE((least.array() >= Eigen::Array4d(0.5, -1.5, 0.5, 2)).all()) << least;
  EXPECT_TRUE((most.array() <= Eigen::Array4d(1.5, 1.5, 1.5, 4)).all()) << most;
}

}  // namespace
}  // namespace isoline::problems
