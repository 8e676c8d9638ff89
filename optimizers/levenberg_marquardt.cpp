// Levenberg-Marquardt, Marquardt (1963), with Moré's scaling (1978) and the gain-ratio
// rule of Nielsen (1999): d = argmin ‖J d + r‖² + μ‖D d‖², Dⱼ the largest norm the j-th
// column of J has had. Steps that do not lower ‖r‖ are rejected and the damping is raised. On fresh
// samples at every step J and r are those of the step's own. With damping=fixed, the rule of
// mini-batches that cannot be compared: θ ← θ − η Jᵀ (K + μ)⁻¹ r, K = JJᵀ, μ a share of the mean
// diagonal of K, and every step is taken.
#include <cmath>
#include <limits>
#include <string>

#include "core/archive.h"
#include "core/array.h"
#include "core/decompose.h"
#include "core/product.h"
#include "optimizers/nielsen_damping.h"
#include "optimizers/optimizer.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

struct DampedLeastSquares {
  enum class Way { automatic, orthogonal, cholesky };

  void set(const Matrix& J, const Vector& minus_r, const Vector& D);
  // d and J d; false where they are not finite.
  bool solve(Real mu, Way way, Vector& d, Vector& Jd);
  Real misfit() const { return 0.5 * right.squaredNorm(); }  // ½‖r‖²
  void persist(Archive& archive) { archive(augmented, right, scale, rows); }

  Index rows = 0;    // m·B
  Matrix augmented;  // (m·B + n, n) with J on top, or (m·B, n + m·B) with JD⁻¹ left
  Vector right;      // −r, with n zeros below where J is not wide
  Vector scale;      // (n) D

 private:
  bool is_wide() const { return rows < scale.size(); }
  bool may_square(Real mu) const;
  bool by_cholesky(Real mu);

  Matrix gram_, damped_, column_;  // (m·B, m·B) twice, (m·B, 1)
  bool has_gram_ = false;
  Vector solved_;  // (z, w) or d
};

// Least squares under a diagonal damping, by orthogonal factorization or by Cholesky.

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

}  // namespace

// A parameter that has done nothing yet has no scale, and no step.
void DampedLeastSquares::set(const Matrix& J, const Vector& minus_r, const Vector& D) {
  const Index n = J.cols();
  rows = J.rows();
  scale = D;
  has_gram_ = false;
  if (is_wide() && augmented.rows() != rows)
    augmented.setZero(rows, n + rows);
  else if (!is_wide() && augmented.rows() != rows + n)
    augmented.setZero(rows + n, n);
  if (is_wide()) {
    for (Index j = 0; j < n; ++j) augmented.col(j) = J.col(j) / (scale[j] > 0 ? scale[j] : 1);
  } else {
    augmented.topRows(rows) = J;
  }
  if (right.size() != augmented.rows()) right.setZero(augmented.rows());
  right.head(rows) = minus_r;
}

bool DampedLeastSquares::solve(Real mu, Way way, Vector& d, Vector& Jd) {
  const Index n = scale.size();
  const Real root = std::sqrt(mu);
  const bool squares =
      is_wide() && (way == Way::cholesky || (way == Way::automatic && may_square(mu)));
  if (!is_wide()) {
    augmented.bottomRows(n).diagonal() = root * scale;
    if (!least_squares(augmented, right, kEpsilon, d)) return false;
    Jd.noalias() = augmented.topRows(rows) * d;
    return true;
  }
  augmented.rightCols(rows).diagonal().setConstant(root);
  if (!(squares ? by_cholesky(mu) : least_squares(augmented, right, kEpsilon, solved_)))
    return false;
  d = (scale.array() > 0).select(solved_.head(n).cwiseQuotient(scale), 0);
  Jd.noalias() = augmented.leftCols(n) * solved_.head(n);
  return true;
}

// Large enough to be worth it, and μ at least 1e-10 of a bound on the largest σ².
bool DampedLeastSquares::may_square(Real mu) const {
  constexpr Index kLeastRows = 64;
  constexpr Real kLeastShare = 1e-10;
  return rows >= kLeastRows && mu >= kLeastShare * augmented.leftCols(scale.size()).squaredNorm();
}

bool DampedLeastSquares::by_cholesky(Real mu) {
  const Eigen::Ref<const Matrix> A = augmented.leftCols(scale.size());
  if (!has_gram_) {
    gram_.resize(rows, rows);
    product(Form::A_BH, A, A, gram_);
    has_gram_ = true;
  }
  damped_ = gram_;
  damped_.diagonal().array() += mu;
  column_ = right;
  if (!solve_positive_definite(damped_, column_)) return false;
  solved_.noalias() = A.transpose() * column_.col(0);
  return true;
}

namespace {

struct LevenbergMarquardt {
  Real initial_damping = 1e-4, rate = 1;
  std::string damping = "adaptive", way = "auto";

  struct State {
    DampedLeastSquares squares;
    SpectralStep spectral;
    Vector scale;  // (n) D
    NielsenDamping damping;
    bool has_point = false;
    Linearization at, trial;
    Vector step, candidate;  // (n)
    Vector Jd, residual;     // (m·B)
  };
  static void persist(State& s, Archive& archive) {
    s.squares.persist(archive);
    s.spectral.persist(archive);
    archive(s.scale);
    s.damping.persist(archive);
    archive(s.has_point);
  }

  State init(Meter&, const Vector& theta) const {
    State s;
    s.scale = Vector::Zero(theta.size());
    s.damping.mu = initial_damping;
    s.spectral = SpectralStep(spectral_way(way));
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    return damping == "fixed" ? step_fixed(f, theta, s) : step_adaptive(f, theta, s);
  }

  Status step_adaptive(Meter& f, Vector& theta, State& s) const {
    if (!s.has_point || f.has_fresh_batches()) {
      f.linearize(theta, s.at);
      accept(f, s);
    }
    if (!s.squares.solve(s.damping.mu, least_squares_way(), s.step, s.Jd)) return Status::stalled;
    s.candidate = theta + s.step;
    if (s.candidate == theta && !f.has_fresh_batches()) return Status::converged;
    f.linearize(s.candidate, s.trial);
    const Real gain = gain_ratio(f, s);
    if (!(gain > 0)) {
      f.reject_step();
      return s.damping.reject();
    }
    theta = s.candidate;
    std::swap(s.at, s.trial);
    if (!f.has_fresh_batches()) accept(f, s);
    s.damping.accept(gain);
    return Status::running;
  }

  Status step_fixed(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.residual = (s.at.y() - f.target()).reshaped();
    const auto filter = tikhonov_filter(initial_damping);
    return s.spectral.add(f, s.at, filter, s.residual, -rate, theta) ? Status::running
                                                                     : Status::stalled;
  }

  // J, −r and D at the point just accepted.
  void accept(Meter& f, State& s) const {
    const Matrix& J = s.at.jacobian();
    s.residual = (f.target() - s.at.y()).reshaped();
    s.scale = s.scale.cwiseMax(J.colwise().norm().transpose());
    s.squares.set(J, s.residual, s.scale);
    s.has_point = true;
  }

  // Actual over predicted decrease of ½‖r‖², the latter ½‖J d‖² + μ‖D d‖² without cancellation.
  Real gain_ratio(Meter& f, const State& s) const {
    const Real after = 0.5 * (s.trial.y() - f.target()).squaredNorm();
    const Real predicted =
        0.5 * s.Jd.squaredNorm() + s.damping.mu * s.scale.cwiseProduct(s.step).squaredNorm();
    return (s.squares.misfit() - after) / predicted;
  }

  DampedLeastSquares::Way least_squares_way() const {
    using LeastSquares = DampedLeastSquares::Way;
    if (way == "cholesky") return LeastSquares::cholesky;
    return way == "orthogonal" ? LeastSquares::orthogonal : LeastSquares::automatic;
  }
  static Way spectral_way(const std::string& way) {
    if (way == "orthogonal") return Way::qr;
    return way_named(way);
  }
};

void fields(LevenbergMarquardt& o, auto& field) {
  field("initial-damping", o.initial_damping, above(0),
        "damping μ at the start, in units of D²; where it is fixed, μ as a share of the mean "
        "diagonal of JJᵀ");
  field("damping", o.damping, Choices{"adaptive", "fixed"},
        "by the gain of each step, or always the same");
  field("rate", o.rate, above(0), "of damping=fixed: step length η");
  field(
      "way", o.way, Choices{"auto", "orthogonal", "cholesky"},
      "by QR, or by Cholesky of a Gram matrix, which of networks of dense layers and damping=fixed "
      "is formed layer by layer; auto: by size and accuracy");
}

}  // namespace

void register_levenberg_marquardt(OptimizerRegistry& registry) {
  OptimizerEntry entry = stepper_entry<LevenbergMarquardt>(
      {.name = "levenberg-marquardt",
       .title = "Levenberg-Marquardt",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ + argmin ‖J d + r‖² + μ‖D d‖²",
       .source = "Marquardt (1963); Moré (1978); Nielsen (1999)",
       .note = "A rejected candidate is an iteration, too. With damping=fixed every step is taken, "
               "D is 1, and μ a share of the mean diagonal of JJᵀ.",
       .needs = {Oracle::forward, Oracle::jacobian},
       .is_input_scale_invariant = true,
       .most_rank = 2048,
       .tunable = {.option = "initial-damping", .factor = 10}});
  entry.needs_for = [](const OptionValues& options, const Problem& problem) -> OracleSet {
    if (options.text("damping") == "adaptive") return {Oracle::forward, Oracle::jacobian};
    const Way way = LevenbergMarquardt::spectral_way(options.text("way"));
    return needs_of(way, tikhonov_filter(1), problem);
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
