// Levenberg-Marquardt by products, for problems too large for a Jacobian: θ ← θ + d,
// d ≈ argmin ‖J d + r‖² + μ‖d‖² by conjugate gradients on JᵀJ + μ in the form of Paige and Saunders
// (1982), section 7.1, which forms neither. They end where the gradient of that is down to η of its
// start, η = min(0.1, √(‖g‖/‖g₀‖)), g = Jᵀr at this and the first point: inexact at first, ever
// more exact near a solution; Dembo, Eisenstat, Steihaug (1982). The damping starts at 10⁻⁴ of ‖J
// g‖²/‖g‖² and follows the gain of each step by the rule of Nielsen (1999), as that of
// levenberg-marquardt does. Unlike there, μ is in units of the unknowns: there are no columns to
// scale by.
#include <algorithm>
#include <cmath>
#include <utility>

#include "optimizers/nielsen_damping.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct LevenbergMarquardtCg {
  Index cg_iterations = 100;

  struct State {
    NielsenDamping damping;
    Real first_slope = 0;  // ‖g₀‖
    Linearization at;
    Matrix residual;        // (m, B) −r
    Vector gradient;        // (n) −g = −Jᵀr
    Matrix left, moved;     // (m, B) −r − J d, J p
    Vector step, slope, p;  // (n) d, −g − (JᵀJ + μ) d, direction
    Vector candidate;       // (n)
  };
  static void persist(State& s, Archive& archive) {
    s.damping.persist(archive);
    archive(s.first_slope);
  }
  State init(Meter&, const Vector&) const { return {}; }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.residual = f.target() - s.at.y();
    s.gradient.resize(theta.size());
    s.at.pullback(s.residual, s.gradient);
    if (s.gradient.isZero(0)) return Status::converged;
    if (s.damping.mu == 0) set_damping(s);
    if (!conjugate_gradients(f, s)) return Status::stalled;
    s.candidate = theta + s.step;
    if (s.candidate == theta && !f.has_fresh_batches()) return Status::converged;
    const Real gain = (s.at.loss() - f.loss(s.candidate)) / predicted_decrease(s);
    if (!(gain > 0)) {
      f.reject_step();
      return s.damping.reject();
    }
    theta = s.candidate;
    s.damping.accept(gain);
    return Status::running;
  }

  static void set_damping(State& s) {
    constexpr Real kInitial = 1e-4;
    s.first_slope = s.gradient.norm();
    s.moved.resizeLike(s.residual);
    s.at.pushforward(s.gradient, s.moved);
    s.damping.mu = kInitial * s.moved.squaredNorm() / s.gradient.squaredNorm();
  }

  bool conjugate_gradients(Meter& f, State& s) const {
    s.left = s.residual;
    s.moved.resizeLike(s.left);
    s.step.setZero(s.gradient.size());
    s.p = s.slope = s.gradient;
    Real slope = s.slope.squaredNorm();
    const Real forcing = std::min(0.1, std::sqrt(std::sqrt(slope) / s.first_slope));
    const Real enough = forcing * forcing * slope;
    for (Index i = 0; i < cg_iterations && slope > enough && !f.is_spent(); ++i) {
      s.at.pushforward(s.p, s.moved);
      const Real alpha = slope / (s.moved.squaredNorm() + s.damping.mu * s.p.squaredNorm());
      if (!(alpha > 0 && std::isfinite(alpha))) return i > 0;
      s.step += alpha * s.p;
      s.left -= alpha * s.moved;
      s.at.pullback(s.left, s.slope);
      s.slope -= s.damping.mu * s.step;
      const Real before = std::exchange(slope, s.slope.squaredNorm());
      s.p = s.slope + slope / before * s.p;
    }
    return is_finite(s.step);
  }

  // The predicted decrease of the loss, which is a multiple of ½‖r‖²; for ½‖r‖² and any d it is
  // ½ dᵀ(−g) + ½ dᵀ(−g − (JᵀJ + μ) d) + ½μ‖d‖².
  static Real predicted_decrease(const State& s) {
    const Real of_squares =
        0.5 * (s.step.dot(s.gradient) + s.step.dot(s.slope) + s.damping.mu * s.step.squaredNorm());
    return of_squares * s.at.loss() / (0.5 * s.residual.squaredNorm());
  }
};

void fields(LevenbergMarquardtCg& o, auto& field) {
  field("cg-iterations", o.cg_iterations, between(1, 1e6),
        "most conjugate-gradient iterations per step");
}

}  // namespace

void register_levenberg_marquardt_cg(OptimizerRegistry& registry) {
  registry.add(stepper_entry<LevenbergMarquardtCg>(
      {.name = "levenberg-marquardt-cg",
       .title = "Levenberg-Marquardt by products",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ + d,  d ≈ argmin ‖J d + r‖² + μ‖d‖² by conjugate gradients",
       .source = "Marquardt (1963); Paige, Saunders (1982), section 7.1; Nielsen (1999)",
       .note = "Never forms J: a step costs a pushforward and a pullback per iteration of the "
               "conjugate gradients. A rejected candidate is an iteration, too. The damping adapts "
               "itself, so no option is tuned.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::pushforward}}));
}

}  // namespace isoline::optimizers
