// Burgers' equation: its steps against the exact solution of Cole (1951) and Hopf (1950), what they
// keep, their derivatives, and the simulation backward.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "make.h"
#include "problems/burgers_flow.h"

namespace isoline::problems {
namespace {

constexpr Real kWave = 2 * M_PI;

// u = −2ν φ'/φ, where φ is any positive solution of φ̇ = νφ'': here
// φ = 1 + A e^(−νk²t) cos ks + B e^(−4νk²t) sin 2ks.
Vector exact(Index N, Real viscosity, Real time) {
  constexpr Real A = 0.8, B = 0.15;
  const Real first = A * std::exp(-viscosity * kWave * kWave * time);
  const Real second = B * std::exp(-4 * viscosity * kWave * kWave * time);
  Vector u(N);
  for (Index j = 0; j < N; ++j) {
    const Real s = kWave * static_cast<Real>(j) / static_cast<Real>(N);
    const Real phi = 1 + first * std::cos(s) + second * std::sin(2 * s);
    const Real slope = kWave * (2 * second * std::cos(2 * s) - first * std::sin(s));
    u[j] = -2 * viscosity * slope / phi;
  }
  return u;
}

Vector evolved(const BurgersFlow& flow, const Vector& x) {
  Vector y(x.size());
  flow.evolve(x, y);
  return y;
}

Matrix states(Index N, Index samples) {
  Matrix x(N, samples);
  for (Index b = 0; b < samples; ++b)
    x.col(b) = *make("burgers[N=" + std::to_string(N) + "]", static_cast<std::uint64_t>(b)).truth();
  return x;
}

TEST(Burgers, ApproachesTheExactSolutionAtSecondOrder) {
  constexpr Real kViscosity = 0.03, kTime = 0.25;
  std::array<Real, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Index N = Index(32) << i;
    const BurgersFlow flow(N, 5 * N, kViscosity, kTime);  // Δt falls with h
    const Vector y = evolved(flow, exact(N, kViscosity, 0));
    errors[i] = (y - exact(N, kViscosity, kTime)).cwiseAbs().maxCoeff();
  }
  EXPECT_LT(errors[0], 0.02);
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 2, 0.15) << i;  // the next order is O(h²)
}

// Momentum to rounding; energy without viscosity but for Heun's third order, and less with it.
TEST(Burgers, KeepsMomentumAndEnergyAsTheEquationDoes) {
  const Vector x = states(64, 1).col(0).array() + 0.3;
  const Vector y = evolved(BurgersFlow(64, 0, 0.005, 0.25), x);
  EXPECT_NEAR(y.sum(), x.sum(), 1e-12 * x.cwiseAbs().sum());
  EXPECT_LT(y.squaredNorm(), 0.9 * x.squaredNorm());
  const auto gain = [&x](Index steps) {
    return evolved(BurgersFlow(64, steps, 0, 0.05), x).squaredNorm() / x.squaredNorm() - 1;
  };
  EXPECT_LT(std::abs(gain(16)), 1e-3);
  EXPECT_GT(std::abs(gain(16) / gain(32)), 6);  // 8 in the limit
}

// Heun's steps of Δt and −Δt undo each other to fourth order, so all of them to third.
TEST(Burgers, RunBackwardWithoutViscosityGivesASmoothStateBack) {
  const Vector x = exact(64, 0.03, 0.2);
  std::array<Real, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const BurgersFlow flow(64, Index(16) << i, 0, 0.1);
    Vector back(64);
    flow.reverse(evolved(flow, x), back);
    errors[i] = (back - x).cwiseAbs().maxCoeff();
  }
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 3, 0.2) << i;  // the next order is O(Δt)
}

TEST(Burgers, LocalInverseStaysWhereYIsReached) {
  const Problem problem = make("burgers", 1);
  Point at;
  problem.forward(problem.start(), at);
  Matrix x(problem.inputs(), 1);
  EXPECT_TRUE(problem.local_inverse(at.y, x, at).all());
  EXPECT_LT((x - at.x()).norm(), 1e-13 * at.x().norm());
}

// From rest, again and again: each time it takes up some of what viscosity took.
TEST(Burgers, LocalInverseRepeatedComesCloserToTheStateSought) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Problem problem = make("burgers", seed);
    Matrix x = Matrix::Zero(problem.inputs(), 1);
    Point at;
    std::vector<Real> errors;
    for (int i = 0; i < 30; ++i) {
      problem.physics_forward(x, problem.batch(), at);
      EXPECT_TRUE(problem.local_inverse(problem.target(), x, at).all());
      errors.push_back((x - *problem.truth()).norm() / problem.truth()->norm());
    }
    EXPECT_LT(errors[0], 0.6) << seed;
    EXPECT_LT(errors[4], 0.7 * errors[0]) << seed;
    EXPECT_LT(errors[29], 0.7 * errors[4]) << seed;
  }
}

TEST(Burgers, TooFewStepsAreAUsageErrorThatSaysHowMany) {
  EXPECT_NO_THROW(make("burgers[N=128]"));
  EXPECT_NO_THROW(make("burgers[N=128,steps=64]"));
  try {
    make("burgers[N=128,steps=16]");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("steps must be at least 17, got 16"),
              std::string::npos)
        << error.what();
  }
  EXPECT_THROW(make("burgers[viscosity=-1]"), UsageError);
  EXPECT_THROW(make("burgers[time=0]"), UsageError);
}

// Wave packets: the signal, its noise, what the noise leaves of x*, and the local inverse.

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
