// SPRING, Goldshlager, Abrahamsen, Lin (2024), arXiv 2401.10190: the step that the
// regularized least squares of this batch leave nearest to the last one,
//   Δ ← μ Δ₋ − Jᵀ (K + λ)⁻¹ (r + μ J Δ₋),  θ ← θ + η Δ,  K = JJᵀ, r = y − y*,
// so that what the batch says nothing of goes on as it went. λ is a share of the mean diagonal of
// K, where the paper's is absolute in units of its wave function, and the paper's bound on ‖ηΔ‖ is
// left out.
#include "optimizers/optimizer.h"
#include "optimizers/spectral_step.h"

namespace isoline::optimizers {
namespace {

struct Spring {
  Real rate = 1, momentum = 0.9, damping = 1e-3;

  struct State {
    Linearization at;
    SpectralStep spectral;
    Vector step;      // (n) Δ
    Matrix pushed;    // (m, B) J Δ₋
    Vector residual;  // (m·B)
  };
  static void persist(State& s, Archive& archive) {
    s.spectral.persist(archive);
    archive(s.step);
  }
  State init(Meter&, const Vector& theta) const {
    State s;
    s.step = Vector::Zero(theta.size());
    return s;
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.step *= momentum;
    s.pushed.resize(s.at.y().rows(), s.at.y().cols());
    s.at.pushforward(s.step, s.pushed);
    s.residual = (s.at.y() - f.target() + s.pushed).reshaped();
    if (!s.spectral.add(f, s.at, tikhonov_filter(damping), s.residual, -1, s.step))
      return Status::stalled;
    theta += rate * s.step;
    return Status::running;
  }
};

void fields(Spring& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share μ of the last step");
  field("damping", o.damping, above(0), "damping λ, as a share of the mean diagonal of JJᵀ");
}

}  // namespace

void register_spring(OptimizerRegistry& registry) {
  OptimizerEntry entry = stepper_entry<Spring>(
      {.name = "spring",
       .title = "SPRING",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "Δ ← μ Δ − Jᵀ (JJᵀ + λ)⁻¹ (y − y* + μ J Δ),  θ ← θ + η Δ",
       .source = "Goldshlager, Abrahamsen, Lin (2024)",
       .note = "Damped Gauss-Newton with projected momentum. λ is relative to the mean diagonal of "
               "JJᵀ; without the paper's bound on the length of a step.",
       .needs = {Oracle::forward, Oracle::pushforward},
       .most_rank = 2048,
       .tunable = {.option = "rate", .below = 4}});
  entry.needs_for = [](const OptionValues&, const Problem& problem) {
    OracleSet needs = needs_of(Way::automatic, tikhonov_filter(1), problem);
    needs.add(Oracle::pushforward);
    return needs;
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
