// Kalman methods of inversion, which call the residuals alone and all of an iteration's at once.
// With the deviations Θ (n, J) and G (m, J) of an ensemble and of its observations from their
// means, over √(J − 1), and observations of covariance α I, a Kalman update is
//   m ← m + Θ (GᵀG + α)⁻¹ Gᵀ (y* − ȳ),  which stays in the span of the ensemble.
// eki: each member by its own data y* + ξⱼ, ξⱼ ~ N(0, α); Iglesias, Law, Stuart (2013). etki: m as
// above and Θ ← Θ (I + GᵀG/α)^−½, without random data; Huang, Huang, Reich, Stuart (2022). α is
// that of Iglesias and Yang's (2021) controller of the misfits Φⱼ = ½‖y* − yⱼ‖², without its end:
// 1/α = max(m/(2 mean Φ), √(m/(2 var Φ))), which does not depend on the noise level of the data.
// uki: the ensemble are sigma points around m; Huang, Schneider, Stuart (2022), J. Comput. Phys.
// 463, with Σ_ω = C₀ and Σ_ν = 2 Σ_η. Σ_η is here a share of the mean square of r at m.
// A member whose evaluation fails is left out of the means and is drawn again from the others; of
// uki, the pair of points ±j is left out. Where too few are left, the ensemble shrinks to its last
// member with a value, the best of its step.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"
#include "core/differences.h"
#include "core/random.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

// r = y − y*, (m), at θ.
void residual_at(Meter& f, const Vector& theta, Linearization& at, Vector& r) {
  f.linearize(theta, at);
  at.residual(r);
}

struct Ensemble {
  Index members = 0;
  Real spread = 0.1;
  bool is_square_root = false;

  struct State {
    Matrix members, residuals;  // (n, J), (m, J)
    std::int64_t steps = 0;
    Linearization at;
    Vector theta, r, mean, mean_r, misfits;
    Vector best;                        // (n), of the last step in which enough members had a value
    Matrix deviations, observed, data;  // Θ, G, (m, J) data of the members
    std::vector<Index> alive;           // the members whose evaluation succeeded
  };
  static void persist(State& s, Archive& archive) { archive(s.members, s.steps, s.best); }

  State init(Meter& f, const Vector& theta) const {
    const Index n = theta.size(), J = members > 0 ? members : 2 * (n + 1);
    const Vector sizes = spread * sizes_of_unknowns(theta);
    State s;
    s.members.resize(n, J);
    RandomStream stream(0, "kalman-inversion", "ensemble");
    for (Index j = 0; j < J; ++j)
      s.members.col(j) = theta + sizes.cwiseProduct(stream.normal_vector(n));
    s.residuals.resize(f.residuals(), J);
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    if (!evaluate(f, s)) {
      if (s.best.size() > 0) theta = s.best;
      s.members = (0.5 * (s.members.colwise() - theta)).colwise() + theta;
      f.reject_step();
      return Status::running;
    }
    Index least = 0;
    s.misfits.minCoeff(&least);
    s.best = s.members.col(s.alive[static_cast<std::size_t>(least)]);
    const Index planned = s.members.cols(), J = s.residuals.cols();
    if (J < planned) s.members = s.members(Eigen::all, s.alive).eval();
    const auto m = static_cast<Real>(f.residuals());
    const Vector& misfits = s.misfits;
    const Real root = std::sqrt(static_cast<Real>(J - 1)), mean = misfits.mean();
    const Real variance = (misfits.array() - mean).matrix().squaredNorm() / (root * root);
    const Real inverse = std::max(m / (2 * mean), std::sqrt(m / (2 * variance)));
    if (!std::isfinite(inverse)) return Status::converged;  // one point, or no misfit
    s.mean = s.members.rowwise().mean();
    s.mean_r = s.residuals.rowwise().mean();
    s.deviations = (s.members.colwise() - s.mean) / root;
    s.observed = (s.residuals.colwise() - s.mean_r) / root;
    const bool is_updated = is_square_root ? transform(s, 1 / inverse) : perturb(s, 1 / inverse);
    if (J < planned) draw_again(s, planned);
    ++s.steps;
    theta = s.members.rowwise().mean();
    return is_updated && is_finite(theta) ? Status::running : Status::stalled;
  }

  // The residuals of the members whose evaluation succeeds; false if fewer than two do.
  static bool evaluate(Meter& f, State& s) {
    const Index J = s.members.cols();
    s.residuals.resize(f.residuals(), J);
    s.misfits.resize(J);
    s.alive.clear();
    f.announce(s.members);
    for (Index j = 0; j < J; ++j) {
      s.theta = s.members.col(j);
      residual_at(f, s.theta, s.at, s.r);
      if (!is_finite(s.r)) continue;
      const auto place = static_cast<Index>(s.alive.size());
      s.residuals.col(place) = s.r;
      s.misfits[place] = 0.5 * s.r.squaredNorm();
      s.alive.push_back(j);
    }
    const auto left = static_cast<Index>(s.alive.size());
    s.residuals.conservativeResize(Eigen::NoChange, left);
    s.misfits.conservativeResize(left);
    return s.alive.size() > 1;
  }
  // In the place of members that were left out: normal, by the mean and covariance of the others.
  static void draw_again(State& s, Index J) {
    const Index left = s.members.cols();
    const Vector mean = s.members.rowwise().mean();
    const Matrix deviations = (s.members.colwise() - mean) / std::sqrt(static_cast<Real>(left - 1));
    RandomStream stream(0, "kalman-inversion", "again", static_cast<std::uint64_t>(s.steps));
    s.members.conservativeResize(Eigen::NoChange, J);
    for (Index j = left; j < J; ++j)
      s.members.col(j) = mean + deviations * stream.normal_vector(left);
  }

  static bool perturb(State& s, Real alpha) {
    RandomStream stream(0, "kalman-inversion", "data", static_cast<std::uint64_t>(s.steps));
    s.data = -s.residuals;
    for (Index j = 0; j < s.data.cols(); ++j)
      s.data.col(j) += std::sqrt(alpha) * stream.normal_vector(s.data.rows());
    Matrix gram = s.observed.transpose() * s.observed, right = s.observed.transpose() * s.data;
    gram.diagonal().array() += alpha;
    if (!solve_positive_definite(gram, right)) return false;
    s.members += s.deviations * right;
    return true;
  }
  static bool transform(State& s, Real alpha) {
    SymmetricEigen gram;
    if (!symmetric_eigen(s.observed.transpose() * s.observed, gram)) return false;
    const Vector lambda = gram.lambda.cwiseMax(0);
    const Vector along = gram.V.transpose() * (s.observed.transpose() * s.mean_r);
    const Vector c = along.cwiseQuotient((lambda.array() + alpha).matrix());
    s.mean -= s.deviations * (gram.V * c);
    const Vector shrunk = (1 + lambda.array() / alpha).sqrt().inverse();
    const Matrix root = gram.V * shrunk.asDiagonal() * gram.V.transpose();
    const auto J = static_cast<Real>(s.members.cols());
    s.members = (std::sqrt(J - 1) * s.deviations * root).colwise() + s.mean;
    return true;
  }
};

void fields(Ensemble& o, auto& field) {
  field("members", o.members, between(0, 1e5), "J of the ensemble; 0: 2 (n + 1)");
  field("spread", o.spread, above(0),
        "standard deviation of the first ensemble around θ₀, in units of |θ₀|");
}

struct Transformed : Ensemble {
  Transformed() { is_square_root = true; }
};
void fields(Transformed& o, auto& field) { fields(static_cast<Ensemble&>(o), field); }

struct Unscented {
  Real spread = 0.1, noise = 0.1;

  struct State {
    Vector prior;  // (n), the diagonal of C₀
    Vector mean;   // (n) m
    Matrix C;      // (n, n)
    Linearization at;
    Vector theta, r, center;
    Vector last;  // (n), m of the last step whose evaluation succeeded
    SymmetricEigen eigen;
    Matrix points;                      // (n, 2n + 1), m and the others
    Matrix root, deviations, observed;  // √Ĉ (n, n), Θ (n, 2n), G (m, 2n)
  };
  static void persist(State& s, Archive& archive) { archive(s.prior, s.mean, s.C, s.last); }

  State init(Meter&, const Vector& theta) const {
    State s;
    s.prior = (spread * sizes_of_unknowns(theta)).cwiseAbs2();
    s.mean = theta;
    s.C = s.prior.asDiagonal();
    return s;
  }

  // With α = 1: m̂ = m, Ĉ = C + C₀.
  Status step(Meter& f, Vector& theta, State& s) const {
    const Index n = theta.size();
    const auto N = static_cast<Real>(n);
    const Real spacing = std::min(std::sqrt(4 / N), 1.0) * std::sqrt(N);  // √(n + λ)
    const Real weight = 1 / (std::sqrt(2.0) * spacing);                   // √ of 1/(2(n + λ))
    s.C.diagonal() += s.prior;
    if (!symmetric_eigen(s.C, s.eigen)) return Status::stalled;
    s.root = s.eigen.V * s.eigen.lambda.cwiseMax(0).cwiseSqrt().asDiagonal();
    const auto side_of = [&](Index j) { return j < n ? spacing : -spacing; };
    s.points.resize(n, 2 * n + 1);
    s.points.col(0) = s.mean;
    for (Index j = 0; j < 2 * n; ++j) {
      s.theta = s.mean + side_of(j) * s.root.col(j % n);
      s.points.col(j + 1) = s.theta;
    }
    f.announce(s.points);
    residual_at(f, s.mean, s.at, s.center);
    s.deviations.resize(n, 2 * n);
    s.observed.resize(s.center.size(), 2 * n);
    for (Index j = 0; j < 2 * n; ++j) {
      s.theta = s.points.col(j + 1);
      residual_at(f, s.theta, s.at, s.r);
      s.deviations.col(j) = weight * side_of(j) * s.root.col(j % n);
      s.observed.col(j) = weight * (s.r - s.center);
    }
    if (!is_finite(s.center)) {  // back to the last mean that had a value, with a smaller C
      if (s.last.size() == 0) return Status::diverged;
      s.mean = 0.5 * (s.mean + s.last);
      s.C = (s.C - Matrix(s.prior.asDiagonal())) / 4;
      theta = s.mean;
      f.reject_step();
      return Status::running;
    }
    s.last = s.mean;
    for (Index j = 0; j < n; ++j)
      if (!s.observed.col(j).allFinite() || !s.observed.col(j + n).allFinite()) {
        s.observed.col(j).setZero();
        s.observed.col(j + n).setZero();
      }
    const Real nu = 2 * noise * noise * s.center.squaredNorm() / static_cast<Real>(s.center.size());
    if (nu == 0) return Status::converged;
    if (!symmetric_eigen(s.observed.transpose() * s.observed, s.eigen)) return Status::stalled;
    const Vector lambda = s.eigen.lambda.cwiseMax(0);
    const Vector along = s.eigen.V.transpose() * (s.observed.transpose() * s.center);
    s.mean -=
        s.deviations * (s.eigen.V * along.cwiseQuotient((lambda.array() + nu).matrix())).eval();
    const Matrix turned = s.deviations * s.eigen.V;  // C = Θ (I + GᵀG/ν)⁻¹ Θᵀ
    const Vector shrunk = (1 + lambda.array() / nu).inverse();
    s.C = turned * shrunk.asDiagonal() * turned.transpose();
    theta = s.mean;
    return is_finite(theta) ? Status::running : Status::stalled;
  }
};

void fields(Unscented& o, auto& field) {
  field("spread", o.spread, above(0), "standard deviations of C₀ around θ₀, in units of |θ₀|");
  field("noise", o.noise, above(0), "of Σ_η, relative to the root mean square of r at m");
}

template <class Method>
void add(OptimizerRegistry& registry, OptimizerEntry entry) {
  entry.family = Family::curvature;
  entry.kind = Kind::least_squares;
  entry.needs = {Oracle::forward};
  entry.needs_same_samples = true;
  entry.most_unknowns = 256;
  entry.tunable = {.option = "spread", .below = 4};
  entry.in_all = false;  // of the suite forward
  registry.add(stepper_entry<Method>(std::move(entry)));
}

constexpr const char* kMeanNote =
    "θ is the mean of the ensemble. A member without a value is left out of a step, and drawn again "
    "from the others.";

}  // namespace

void register_kalman_inversion(OptimizerRegistry& registry) {
  add<Ensemble>(registry, {.name = "eki",
                           .title = "Ensemble Kalman inversion",
                           .formula = "θⱼ ← θⱼ + C^θy (C^yy + α)⁻¹ (y* + ξⱼ − yⱼ)",
                           .source = "Iglesias, Law, Stuart (2013); Iglesias, Yang (2021)",
                           .note = kMeanNote,
                           .is_input_scale_invariant = true});
  add<Transformed>(registry, {.name = "etki",
                              .title = "Ensemble transform Kalman inversion",
                              .formula = "m ← m + C^θy (C^yy + α)⁻¹ (y* − ȳ),  "
                                         "Θ ← Θ (I + GᵀG/α)^−½",
                              .source = "Huang, Huang, Reich, Stuart (2022)",
                              .note = kMeanNote,
                              .is_input_scale_invariant = true});
  add<Unscented>(registry, {.name = "uki",
                            .title = "Unscented Kalman inversion",
                            .formula = "m ← m + C^θy (C^yy + Σ_ν)⁻¹ (y* − y(m)),  C by 2n+1 points",
                            .source = "Huang, Schneider, Stuart (2022)",
                            .note = "A step leaves out both points of a pair ±j of which one has "
                                    "no value."});
}

}  // namespace isoline::optimizers
