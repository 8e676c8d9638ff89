// CMA-ES, the evolution strategy with adaptation of the covariance matrix, with active weights and
// cumulative step-size adaptation; Hansen (2016), arXiv 1604.00772, figure 6 and table 1.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"
#include "core/random.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct CmaEs {
  Real sigma = 0.1;
  Index population = 0, draws = 0;

  // The parameters of Hansen's table 1, by n and λ.
  struct Rates {
    Vector w;  // (λ), by rank
    Real mu_eff = 0, sigma = 0, damping = 0, c = 0, c1 = 0, cmu = 0, normal = 0;

    Rates() = default;
    Rates(Index n, Index lambda) : w(lambda) {
      const auto N = static_cast<Real>(n), count = static_cast<Real>(lambda);
      for (Index i = 0; i < lambda; ++i)
        w[i] = std::log((count + 1) / 2) - std::log(static_cast<Real>(i + 1));
      const Index mu = lambda / 2;
      const auto effective = [](const auto& part) {
        return part.sum() * part.sum() / part.squaredNorm();
      };
      mu_eff = effective(w.head(mu));
      const Real mu_worse = effective(w.tail(lambda - mu));
      sigma = (mu_eff + 2) / (N + mu_eff + 5);
      damping = 1 + 2 * std::max<Real>(0, std::sqrt((mu_eff - 1) / (N + 1)) - 1) + sigma;
      c = (4 + mu_eff / N) / (N + 4 + 2 * mu_eff / N);
      c1 = 2 / ((N + 1.3) * (N + 1.3) + mu_eff);
      cmu = std::min(1 - c1, 2 * (0.25 + mu_eff + 1 / mu_eff - 2) / ((N + 2) * (N + 2) + mu_eff));
      const Real worst =
          std::min({1 + c1 / cmu, 1 + 2 * mu_worse / (mu_eff + 2), (1 - c1 - cmu) / (N * cmu)});
      const Real better = w.cwiseMax(0).sum(), worse = w.cwiseMin(0).cwiseAbs().sum();
      for (Real& each : w) each *= each >= 0 ? 1 / better : worst / worse;
      normal = std::sqrt(N) * (1 - 1 / (4 * N) + 1 / (21 * N * N));  // E‖N(0, I)‖
    }
  };

  struct State {
    Rates rates;
    std::int64_t generation = 0;
    Real sigma = 0;
    Vector mean, p_sigma, p_c;  // (n)
    Matrix C, X, Y;             // (n, n), (n, λ) points, (n, λ) their steps over σ
    SymmetricEigen eigen;       // of C
    Vector losses, z, shift, theta;
    std::vector<Index> order;  // of the points, best first
  };
  static void persist(State& s, Archive& archive) {
    archive(s.generation, s.sigma, s.mean, s.p_sigma, s.p_c, s.C);
  }

  State init(Meter&, const Vector& theta) const {
    const Index n = theta.size();
    const Index lambda =
        population > 0 ? population : 4 + static_cast<Index>(3 * std::log(static_cast<Real>(n)));
    State s;
    s.rates = Rates(n, lambda);
    s.sigma = sigma * std::max<Real>(1, theta.lpNorm<Eigen::Infinity>());
    s.mean = theta;
    s.p_sigma = s.p_c = Vector::Zero(n);
    s.C = Matrix::Identity(n, n);
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    const Index n = theta.size();
    if (!symmetric_eigen(s.C, s.eigen) || !(s.eigen.lambda[0] > 0)) return Status::stalled;
    sample(f, s);
    const Rates& a = s.rates;
    const auto lambda = a.w.size();
    s.shift.setZero(n);
    for (Index i = 0; i < lambda / 2; ++i) s.shift += a.w[i] * s.Y.col(ranked(s, i));
    s.mean += s.sigma * s.shift;
    const Vector lengths = s.eigen.lambda.cwiseSqrt();
    const auto whiten = [&](const Vector& y) -> Vector {  // C^−½ y
      return s.eigen.V * (s.eigen.V.transpose() * y).cwiseQuotient(lengths);
    };
    s.p_sigma =
        (1 - a.sigma) * s.p_sigma + std::sqrt(a.sigma * (2 - a.sigma) * a.mu_eff) * whiten(s.shift);
    ++s.generation;
    const Real settled = std::sqrt(1 - std::pow(1 - a.sigma, 2 * static_cast<Real>(s.generation)));
    const bool is_short =
        s.p_sigma.norm() / settled < (1.4 + 2 / (static_cast<Real>(n) + 1)) * a.normal;
    s.p_c *= 1 - a.c;
    if (is_short) s.p_c += std::sqrt(a.c * (2 - a.c) * a.mu_eff) * s.shift;
    const Real lost = is_short ? 0 : a.c1 * a.c * (2 - a.c);
    s.C *= 1 + lost - a.c1 - a.cmu * a.w.sum();
    s.C += a.c1 * s.p_c * s.p_c.transpose();
    for (Index i = 0; i < lambda; ++i) {
      const Vector y = s.Y.col(ranked(s, i));
      const Real shrunk =
          a.w[i] >= 0 ? 1 : static_cast<Real>(n) / std::max(whiten(y).squaredNorm(), 1e-300);
      s.C += a.cmu * a.w[i] * shrunk * y * y.transpose();
    }
    s.sigma *= std::exp(a.sigma / a.damping * (s.p_sigma.norm() / a.normal - 1));
    theta = s.X.col(ranked(s, 0));
    return std::isfinite(s.sigma) && is_finite(s.C) ? Status::running : Status::stalled;
  }

  static Index ranked(const State& s, Index i) { return s.order[static_cast<std::size_t>(i)]; }

  void sample(Meter& f, State& s) const {
    const Index n = s.mean.size(), lambda = s.rates.w.size();
    RandomStream stream(static_cast<std::uint64_t>(draws), "cma-es", "population",
                        static_cast<std::uint64_t>(s.generation));
    s.X.resize(n, lambda);
    s.Y.resize(n, lambda);
    s.losses.resize(lambda);
    s.order.resize(static_cast<std::size_t>(lambda));
    std::iota(s.order.begin(), s.order.end(), 0);
    for (Index i = 0; i < lambda; ++i) {
      s.z = stream.normal_vector(n);
      // By C^½, which does not depend on the signs of eigenvectors.
      s.z = s.eigen.lambda.cwiseSqrt().cwiseProduct(s.eigen.V.transpose() * s.z);
      s.Y.col(i) = s.eigen.V * s.z;
      s.theta = s.mean + s.sigma * s.Y.col(i);
      s.X.col(i) = s.theta;
    }
    f.announce(s.X);
    for (Index i = 0; i < lambda; ++i) {
      s.theta = s.X.col(i);
      const Real loss = f.loss(s.theta);
      s.losses[i] = std::isfinite(loss) ? loss : std::numeric_limits<Real>::infinity();
    }
    std::ranges::stable_sort(s.order, {}, [&](Index i) { return s.losses[i]; });
  }
};

void fields(CmaEs& o, auto& field) {
  field("sigma", o.sigma, above(0), "initial standard deviation σ, in units of max(1, ‖θ₀‖∞)");
  field("population", o.population, between(0, 1e5), "points λ of a generation; 0: 4 + ⌊3 ln n⌋");
  field("draws", o.draws, between(0, 1e6), "seed of the random numbers");
}

}  // namespace

void register_cma_es(OptimizerRegistry& registry) {
  registry.add(
      stepper_entry<CmaEs>({.name = "cma-es",
                            .title = "Evolution strategy with covariance matrix adaptation",
                            .family = Family::curvature,
                            .kind = Kind::derivative_free,
                            .formula = "θᵢ ~ m + σ N(0, C),  m, σ and C by the ranks of L(θᵢ)",
                            .source = "Hansen (2016), arXiv 1604.00772",
                            .note = "An iteration is a generation; θ is its best point. "
                                    "A point without a value has the last rank.",
                            .needs = {Oracle::forward},
                            .needs_same_samples = true,
                            .most_unknowns = 256,
                            .tunable = {.option = "sigma", .below = 4},
                            .in_all = false}));  // of the suite forward
}

}  // namespace isoline::optimizers
