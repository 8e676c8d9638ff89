// Levenberg-Marquardt, Marquardt (1963), with Moré's scaling (1978) and the gain-ratio
// rule of Nielsen (1999): d = argmin ‖J d + r‖² + μ‖D d‖², Dⱼ the largest norm the j-th
// column of J has had. By QR of the augmented matrix (J; √μ D), which the normal equations' squared
// condition number would spoil; where J is wide, as the shortest (z, w) with JD⁻¹ z + √μ w = −r,
// d = D⁻¹ z, which is the same d. Steps that do not lower ‖r‖ are rejected and the damping is
// raised. On fresh samples at every step J and r are those of the step's own.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

struct LevenbergMarquardt {
  Real initial_damping = 1e-4;

  struct State {
    Matrix augmented;  // (m·B + n, n) with J on top, or (m·B, n + m·B) with JD⁻¹ left
    Vector right;      // −r, with n zeros below where J is not wide
    Vector scale;      // (n) D
    Real damping = 0, growth = 2;  // μ, and its factor at the next rejection
    bool has_point = false;
    Linearization at, trial;
    Vector solved, step, candidate;  // (z, w) or d, (n)
    Vector Jd;                       // (m·B)
  };
  static void persist(State& s, Archive& archive) {
    archive(s.augmented, s.right, s.scale, s.damping, s.growth, s.has_point);
  }

  State init(Meter& f, const Vector& theta) const {
    const Index rows = f.residuals(), n = theta.size();
    State s;
    s.scale = Vector::Zero(n);
    if (rows < n)
      s.augmented.setZero(rows, n + rows);
    else
      s.augmented.setZero(rows + n, n);
    s.right.setZero(s.augmented.rows());
    s.damping = initial_damping;
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    if (!s.has_point || f.has_fresh_batches()) {
      f.linearize(theta, s.at);
      accept(f, s);
    }
    if (!solve(f, s)) return Status::stalled;
    s.candidate = theta + s.step;
    if (s.candidate == theta && !f.has_fresh_batches()) return Status::converged;
    f.linearize(s.candidate, s.trial);
    const Real gain = gain_ratio(f, s);
    if (!(gain > 0)) {
      f.reject_step();
      s.damping *= s.growth;
      s.growth *= 2;
      return std::isfinite(s.damping) ? Status::running : Status::converged;
    }
    theta = s.candidate;
    std::swap(s.at, s.trial);
    if (!f.has_fresh_batches()) accept(f, s);
    s.damping *= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
    s.growth = 2;
    return Status::running;
  }

  // J, −r and D at the point just accepted.
  void accept(Meter& f, State& s) const {
    const Matrix& J = s.at.jacobian();
    s.right.head(J.rows()) = (f.target() - s.at.y()).reshaped();
    s.scale = s.scale.cwiseMax(J.colwise().norm().transpose());
    if (J.rows() < J.cols()) {  // a parameter that has done nothing yet has no scale, and no step
      for (Index j = 0; j < J.cols(); ++j)
        s.augmented.col(j) = J.col(j) / (s.scale[j] > 0 ? s.scale[j] : 1);
    } else {
      s.augmented.topRows(J.rows()) = J;
    }
    s.has_point = true;
  }

  // d, and J d
  bool solve(Meter& f, State& s) const {
    const Index rows = f.residuals(), n = s.scale.size();
    const Real root = std::sqrt(s.damping);
    if (rows < n) {
      s.augmented.rightCols(rows).diagonal().setConstant(root);
      if (!least_squares(s.augmented, s.right, kEpsilon, s.solved)) return false;
      s.step = (s.scale.array() > 0).select(s.solved.head(n).cwiseQuotient(s.scale), 0);
      s.Jd.noalias() = s.augmented.leftCols(n) * s.solved.head(n);
    } else {
      s.augmented.bottomRows(n).diagonal() = root * s.scale;
      if (!least_squares(s.augmented, s.right, kEpsilon, s.step)) return false;
      s.Jd.noalias() = s.augmented.topRows(rows) * s.step;
    }
    return true;
  }

  // Actual over predicted decrease of ½‖r‖², the latter ½‖J d‖² + μ‖D d‖² without cancellation.
  Real gain_ratio(Meter& f, const State& s) const {
    const Real before = 0.5 * s.right.squaredNorm();
    const Real after = 0.5 * (s.trial.y() - f.target()).squaredNorm();
    const Real predicted =
        0.5 * s.Jd.squaredNorm() + s.damping * s.scale.cwiseProduct(s.step).squaredNorm();
    return (before - after) / predicted;
  }
};

void fields(LevenbergMarquardt& o, auto& field) {
  field("initial-damping", o.initial_damping, above(0), "damping μ at the start, in units of D²");
}

}  // namespace

void register_levenberg_marquardt(OptimizerRegistry& registry) {
  registry.add(
      stepper_entry<LevenbergMarquardt>({.name = "levenberg-marquardt",
                                         .title = "Levenberg-Marquardt",
                                         .family = Family::curvature,
                                         .kind = Kind::least_squares,
                                         .formula = "θ ← θ + argmin ‖J d + r‖² + μ‖D d‖²",
                                         .source = "Marquardt (1963); Moré (1978); Nielsen (1999)",
                                         .note = "A rejected candidate is an iteration too.",
                                         .needs = {Oracle::forward, Oracle::jacobian},
                                         .is_input_scale_invariant = true,
                                         .most_rank = 2048,
                                         .tunable = {.option = "initial-damping", .factor = 10}}));
}

}  // namespace isoline::optimizers
