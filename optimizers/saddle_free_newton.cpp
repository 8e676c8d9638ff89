// Saddle-free Newton with a limit on the change of loss, Holl, Koltun, Thuerey (2022), sine
// problem, as inversion.h has it: θ ← θ − η V d, H = V diag(S) Vᵀ. The published script's
// transposed V is corrected.
#include "core/decompose.h"
#include "optimizers/inversion.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct SaddleFreeNewton {
  Real rate = 1, max_loss_change = 0.2;

  struct State {
    Linearization at;
    SymmetricEigen eigen;
    Vector gradient, along;  // (n), ∇L and the step in the eigenbasis
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    if (!symmetric_eigen(s.at.hessian(), s.eigen)) {
      f.claim("the Hessian has no eigenvalues in finite numbers");
      return Status::stalled;
    }
    s.along.noalias() = s.eigen.V.transpose() * s.gradient;
    const Real mean = geometric_mean(s.eigen.lambda);
    for (Index i = 0; i < s.along.size(); ++i)
      s.along[i] = saddle_free_length(s.along[i], s.eigen.lambda[i], mean, max_loss_change);
    theta.noalias() -= rate * s.eigen.V * s.along;
    return Status::running;
  }
};

void fields(SaddleFreeNewton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("max-loss-change", o.max_loss_change, above(0),
        "limit Δ on the linear change of loss along a direction of low or negative curvature");
}

}  // namespace

void register_saddle_free_newton(OptimizerRegistry& registry) {
  registry.add(stepper_entry<SaddleFreeNewton>(
      {.name = "saddle-free-newton",
       .title = "Saddle-free Newton with a step limit",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "H = V diag(S) Vᵀ, g̃ = Vᵀ∇L;  θ ← θ − η V d,  dᵢ = sign(g̃ᵢ)·(|g̃ᵢ/Sᵢ| where "
                  "Sᵢ > S̄, else min(|g̃ᵢ/Sᵢ|, Δ/|g̃ᵢ|))",
       .source = "Holl, Koltun, Thuerey (2022), published script; Dauphin et al. (2014)",
       .note =
           "S̄ is the geometric mean of |S|; there is no step along directions without curvature.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::hessian},
       .most_unknowns = 2048,
       .tunable = {.option = "rate", .below = 5}}));
}

}  // namespace isoline::optimizers
