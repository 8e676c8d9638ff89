// The Kuramoto-Sivashinsky equation against its linear limit, an integration by another method, and
// its own steps made smaller.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/decompose.h"
#include "make.h"

namespace isoline::problems {
namespace {

constexpr Real kTau = 2 * std::numbers::pi;

Vector image_of(const Problem& problem, const Vector& x) {
  Point at;
  problem.forward(x, at);
  return at.y.col(0);
}

TEST(KuramotoSivashinsky, GrowsSmallWavesByTheLinearRate) {
  const Problem problem = make("kuramoto-sivashinsky[time=3]");
  ASSERT_EQ(problem.unknowns(), 8);
  for (Index n = 1; n <= 4; ++n) {
    const Real kappa = kTau * static_cast<Real>(n) / 22, small = 1e-7;
    Vector x = Vector::Zero(8);
    x[2 * n - 1] = small;
    const Vector y = image_of(problem, x);
    Vector wave(y.size());
    for (Index i = 0; i < y.size(); ++i)
      wave[i] = std::sin(kTau * static_cast<Real>(n * i) / static_cast<Real>(y.size()));
    const Real growth = std::exp(3 * (kappa * kappa - std::pow(kappa, 4)));
    EXPECT_LE((y - small * growth * wave).norm(), 1e-5 * small) << n;
  }
}

// u̇ of the same waves by sums over them, in steps of the classical Runge-Kutta method.
class ByRungeKutta {
 public:
  ByRungeKutta(Real length, Index N) : first_(N, N), linear_(N, N) {
    first_.setZero();
    linear_.setZero();
    for (Index n = 1; n <= N / 2; ++n) {
      const Real kappa = kTau * static_cast<Real>(n) / length;
      const Real weight = (2 * n < N ? 2.0 : 1.0) / static_cast<Real>(N);
      for (Index i = 0; i < N; ++i)
        for (Index j = 0; j < N; ++j) {
          const Real angle = kTau * static_cast<Real>(n * (i - j)) / static_cast<Real>(N);
          if (2 * n < N) first_(i, j) -= weight * kappa * std::sin(angle);
          linear_(i, j) += weight * (kappa * kappa - std::pow(kappa, 4)) * std::cos(angle);
        }
    }
  }
  Vector evolve(Vector u, Real time, int steps) const {
    const Real dt = time / steps;
    for (int t = 0; t < steps; ++t) {
      const Vector k1 = slope(u), k2 = slope(u + dt / 2 * k1), k3 = slope(u + dt / 2 * k2),
                   k4 = slope(u + dt * k3);
      u += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return u;
  }

 private:
  Vector slope(const Vector& u) const { return linear_ * u - 0.5 * (first_ * u.cwiseAbs2()); }
  Matrix first_, linear_;
};

TEST(KuramotoSivashinsky, AgreesWithAnotherIntegration) {
  const Problem problem = make("kuramoto-sivashinsky[time=4,steps=400]");
  const Vector x = problem.truth()->col(0);
  const Index N = problem.outputs();
  Vector u = Vector::Zero(N);
  for (Index n = 1; n <= 4; ++n)
    for (Index i = 0; i < N; ++i) {
      const Real angle = kTau * static_cast<Real>(n * i) / static_cast<Real>(N);
      u[i] += x[2 * n - 2] * std::cos(angle) + x[2 * n - 1] * std::sin(angle);
    }
  const Vector other = ByRungeKutta(22, N).evolve(u, 4, 2000);
  EXPECT_GT(other.norm(), 1);
  EXPECT_LE((image_of(problem, x) - other).norm(), 1e-8 * other.norm());
}

TEST(KuramotoSivashinsky, ConvergesWithTheFourthPowerOfTheStep) {
  const Vector x = make("kuramoto-sivashinsky").truth()->col(0);
  const auto end = [&](int steps) {
    return image_of(make("kuramoto-sivashinsky[steps=" + std::to_string(steps) + "]"), x);
  };
  const Vector exact = end(6400);
  const Real coarse = (end(400) - exact).norm(), fine = (end(800) - exact).norm();
  EXPECT_LE(coarse, 1e-6 * exact.norm());
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.5);
  EXPECT_NEAR(exact.sum(), 0, 1e-9) << "the mean is conserved";
}

TEST(KuramotoSivashinsky, IsWorseConditionedTheLongerItRuns) {
  Real last = 1;
  for (const char* time : {"1", "5", "20", "80"}) {
    const Problem problem = make(std::string("kuramoto-sivashinsky[time=") + time + "]");
    Point at;
    problem.forward(problem.truth()->col(0), at);
    Matrix J;
    problem.jacobian(J, at);
    Svd svd;
    ASSERT_TRUE(thin_svd(J, svd));
    const Real condition = svd.sigma[0] / svd.sigma[svd.sigma.size() - 1];
    EXPECT_GT(condition, 1.5 * last) << time;
    last = condition;
    RecordProperty(std::string("condition_at_") + time, std::to_string(condition));
  }
}

}  // namespace
}  // namespace isoline::problems
