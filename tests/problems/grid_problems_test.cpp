// Grid problems. Burgers' equation: its steps against the exact solution of Cole (1951) and Hopf
// (1950), its invariants, its derivatives, and the reverse simulation.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/decompose.h"
#include "make.h"
#include "problems/burgers_flow.h"
#include "problems/random_fields.h"
#include "tests/refusal.h"

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
  EXPECT_NE(refusal([] { make("burgers[N=128,steps=16]"); }).find("at least 17, got 16"),
            std::string::npos);
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
  const Problem problem = make("wave-packet[sigma=0]", 4);
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
    const Problem problem = make("wave-packet[sigma=0.1]", seed);
    sum += problem.minimum().value();
    floors += problem.x_floor(problem.batch());
    EXPECT_FALSE(problem.truth().has_value());
  }
  const Real unit = 0.5 * kNoise * kNoise;
  EXPECT_NEAR(sum / kCount, 60 * unit, 4 * unit * std::sqrt(120 / kCount));
  EXPECT_GT(floors / kCount, 0.01);
  EXPECT_LT(floors / kCount, 0.3);
  EXPECT_EQ(make("wave-packet[sigma=0]").minimum(), 0);
  EXPECT_EQ(make("wave-packet[sigma=0]").x_floor(make("wave-packet[sigma=0]").batch()), 0);
}

// From within a tenth of every unknown, without noise.
TEST(WavePacket, LocalInverseFindsAPacketNearby) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = make("wave-packet[sigma=0]", seed);
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
  const Problem problem = make("wave-packet[mode=learn,sigma=0.1]", 1);
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

// The other grid problems and the random fields of their solutions.

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

// Poisson's equation by k iterations of Jacobi's method, on 81 cells.
std::string by_jacobi(const std::string& iterations) {
  return "poisson[mode=learn,N=9,batch=3,jacobi=" + iterations +
         ",network=mlp[layers=6,activation=tanh,precision=double]]";
}

// Every sine wave is an eigenvector: of S/4 with the mean of two cosines, of ∇² with 4 times this
// less 1.
TEST(PoissonByJacobi, LeavesOfTheErrorOfAWaveThePowerOfItsFactor) {
  for (const int k : {1, 2, 7, 40}) {
    const Problem problem = make(by_jacobi(std::to_string(k)));
    for (const Index p : {1, 2, 9}) {
      const Vector wave = outer(sine_mode(p, 9), sine_mode(1, 9));
      const Real factor = (std::cos(M_PI * static_cast<Real>(p) / 10) + std::cos(M_PI / 10)) / 2;
      Point at;
      problem.physics_forward(wave.replicate(1, 3), problem.batch(), at);
      const Vector expected = (1 - std::pow(factor, k)) / (4 * (factor - 1)) * wave;
      EXPECT_LT((at.y.colwise() - expected).norm(), 1e-12 * expected.norm()) << k << " " << p;
    }
  }
}

// ⟨J v, w⟩ = ⟨v, Jᵀ w⟩, and J v against the central difference, of an error of h² y''' / 6.
TEST(PoissonByJacobi, HasTheDerivativeOfItsIterationsAndTheAdjoint) {
  constexpr Real kStep = 1e-6;
  for (const int k : {1, 7, 40}) {
    const Problem problem = make(by_jacobi(std::to_string(k)), 1);
    RandomStream random(4, "poisson", "test");
    const Vector theta = problem.start(), v = random.normal_vector(theta.size());
    const Matrix w = random.normal_vector(3 * 81).reshaped(81, 3);
    Point at;
    Matrix Jv(81, 3);
    Vector JTw(theta.size());
    problem.forward(theta + kStep * v, at);
    const Matrix above = at.y;
    problem.forward(theta - kStep * v, at);
    const Matrix difference = (above - at.y) / (2 * kStep);
    problem.forward(theta, at);
    problem.pushforward(v, Jv, at);
    problem.pullback(w, JTw, at);
    EXPECT_NEAR(Jv.cwiseProduct(w).sum(), v.dot(JTw), 1e-12 * Jv.norm() * w.norm()) << k;
    EXPECT_LT((Jv - difference).norm(), 1e-7 * Jv.norm()) << k;
  }
}

TEST(PoissonByJacobi, TendsToTheExactSolveByWhichItIsJudged) {
  const Problem exact = make(
      "poisson[mode=learn,N=9,batch=3,network=mlp[layers=6,activation=tanh,"
      "precision=double]]");
  Point at, its;
  exact.forward(exact.start(), at);
  const auto distance = [&](const std::string& iterations) {
    const Problem problem = make(by_jacobi(iterations));
    problem.forward(problem.start(), its);
    EXPECT_EQ(problem.target(), exact.target());
    return (its.y - at.y).norm() / at.y.norm();
  };
  EXPECT_LT(distance("1000"), 1e-10);
  EXPECT_LT(distance("converged"), 1e-5);
  EXPECT_GT(distance("120"), 1e-5);                                  // of 230
  EXPECT_EQ(make(by_jacobi("converged")).refinement()->first, 230);  // cos(π/10)^230 = 9.7e-6
  Batch validation;
  const Problem coarse = make(by_jacobi("2"));
  coarse.draw_validation(validation);
  coarse.forward(coarse.start(), validation, its);
  exact.forward(exact.start(), validation, at);
  EXPECT_EQ(its.y, at.y);
}

TEST(PoissonByJacobi, RefusesWhatItCannotBe) {
  for (const char* option : {"jacobi=0", "jacobi=2.5", "jacobi=fast", "jacobi=progressive,data=8"})
    EXPECT_NE(
        refusal([&] { make(std::string("poisson[mode=learn,N=4,network=mlp,") + option + "]"); }),
        "")
        << option;
  EXPECT_NE(refusal([] { make("poisson[N=4,jacobi=7]"); }), "");
}

// The mean fades by 2/9: of 1, 1, 1, 1 it is 1, of a 0.5 after these 8/9, of another one 65/81.
TEST(Refinement, AddsIterationsWhereTheLossNoLongerFallsUnlessTheLastDidNotHelp) {
  const Refinement of{.first = 5, .step = 3, .most = 10};
  Refinement::State state{.iterations = of.first};
  const auto after = [&](std::initializer_list<Real> losses) {
    for (const Real loss : losses) of.see(loss, state);
    return state.iterations;
  };
  EXPECT_EQ(after({1, 1, 1}), 5);
  EXPECT_EQ(after({1}), 8);
  EXPECT_EQ(after({1, 1, 1, 1}), 8);  // the last addition did not help
  EXPECT_EQ(after({0.5, 0.5}), 8);    // it falls
  EXPECT_NEAR(state.means[0], 0.5 + 0.5 * 49 / 81, 1e-15);
  EXPECT_EQ(after({0.8, 0.8, 0.8}), 10);  // by a tenth less, and at most 10
  EXPECT_EQ(after({3, 3, 3, 3}), 10);
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

// --- diffusivity

// The greatest distance of its fluxes at the truth from h² f over the nodes with four neighbours,
// f = −∇·(e^m ∇u) = −e^m (∇m·∇u + ∇²u) for the published m and u.
Real distance_from_source(int n) {
  const Problem problem = make("diffusivity[n=" + std::to_string(n) + "]");
  const Real h = 1.0 / (n + 1);
  Real most = 0;
  for (int column = 1; column + 1 < n; ++column)
    for (int row = 1; row + 1 < n; ++row) {
      const Real x = (row + 1) * h, y = (column + 1) * h;
      const Real u_x = M_PI * std::cos(M_PI * x) * std::sin(M_PI * y),
                 u_y = M_PI * std::sin(M_PI * x) * std::cos(M_PI * y),
                 u = std::sin(M_PI * x) * std::sin(M_PI * y);
      const Real f = -std::exp(x * x - y * y + 2 * x * y) *
                     ((2 * x + 2 * y) * u_x + (2 * x - 2 * y) * u_y - 2 * M_PI * M_PI * u);
      most = std::max(most, std::abs(problem.target()(row + n * column, 0) / (h * h) - f));
    }
  return most;
}

TEST(Diffusivity, FluxesApproachTheContinuousOperatorToSecondOrder) {
  EXPECT_NEAR(distance_from_source(31) / distance_from_source(63), 4, 0.2);  // h is halved
}

TEST(Diffusivity, HasAPriorThatVanishesAtTheTruth) {
  const Problem problem = make("diffusivity[n=12]");
  EXPECT_EQ(problem.residuals(), 12 * 12 * 2 + 10 * 10);
  EXPECT_LT(problem.target().bottomRows(10 * 10).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(problem.sparse_pattern()->widest_row(), 10);
}

}  // namespace
}  // namespace isoline::problems
