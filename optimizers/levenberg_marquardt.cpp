// Levenberg-Marquardt, Marquardt (1963), with Moré's scaling (1978) and the gain-ratio
// rule of Nielsen (1999): d = argmin ‖J d + r‖² + μ‖D d‖², Dⱼ the largest norm the j-th
// column of J has had. By QR of the augmented matrix (J; √μ D), which the normal equations' squared
// condition number would spoil. Steps that do not lower ‖r‖ are rejected and the damping is raised.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

struct LevenbergMarquardt {
  Real initial_damping = 1e-4;

  struct State {
    Linearization at, trial;
    Vector step, candidate, scale;  // (n), D
    Vector Jd;                      // (m·B)
    Matrix augmented;               // (m·B + n, n)
    Vector right;                   // (m·B + n)
    Real damping = 0, growth = 2;   // μ, and its factor at the next rejection
    bool has_point = false;
  };

  State init(Meter& f, const Vector& theta) const {
    State s;
    s.scale = Vector::Zero(theta.size());
    s.augmented.setZero(f.residuals() + theta.size(), theta.size());
    s.right.setZero(f.residuals() + theta.size());
    s.damping = initial_damping;
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    if (!s.has_point) {
      f.linearize(theta, s.at);
      accept(f, s);
    }
    if (!solve(s)) return Status::stalled;
    s.candidate = theta + s.step;
    if (s.candidate == theta) return Status::converged;
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
    accept(f, s);
    s.damping *= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
    s.growth = 2;
    return Status::running;
  }

  // J, −r and D at the point just accepted.
  void accept(Meter& f, State& s) const {
    const Matrix& J = s.at.jacobian();
    s.right.head(J.rows()) = (f.target() - s.at.y()).reshaped();
    s.augmented.topRows(J.rows()) = J;
    s.scale = s.scale.cwiseMax(J.colwise().norm().transpose());
    s.has_point = true;
  }

  bool solve(State& s) const {
    const Index n = s.scale.size();
    s.augmented.bottomRows(n).diagonal() = std::sqrt(s.damping) * s.scale;
    return least_squares(s.augmented, s.right, kEpsilon, s.step);
  }

  // Actual over predicted decrease of ½‖r‖², the latter ½‖J d‖² + μ‖D d‖² without cancellation.
  Real gain_ratio(Meter& f, State& s) const {
    const Real before = 0.5 * s.right.squaredNorm();
    const Real after = 0.5 * (s.trial.y() - f.target()).squaredNorm();
    s.Jd.noalias() = s.at.jacobian() * s.step;
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
                                         .formula = "θ ← θ + argmin ‖J d + r‖² + μ‖D d‖²",
                                         .source = "Marquardt (1963); Moré (1978); Nielsen (1999)",
                                         .note = "A rejected candidate is an iteration too.",
                                         .needs = {Oracle::forward, Oracle::jacobian},
                                         .is_input_scale_invariant = true,
                                         .most_unknowns = 4096,
                                         .most_rank = 2048}));
}

}  // namespace isoline
