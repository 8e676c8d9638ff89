// Adam, Kingma, Ba (2015), algorithm 1: m ← β₁ m + (1 − β₁) ∇L, v ← β₂ v + (1 − β₂) ∇L²,
// θ ← θ − η m̂/(√v̂ + ε), where m̂ = m/(1 − β₁ᵗ) and v̂ = v/(1 − β₂ᵗ).
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Adam {
  Real rate = 1e-3, beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;

  struct State {
    Vector m, v;                  // (n)
    Real power1 = 1, power2 = 1;  // β₁ᵗ, β₂ᵗ
  };
  static void persist(State& s, Archive& archive) { archive(s.m, s.v, s.power1, s.power2); }
  State init(Index n) const { return {Vector::Zero(n), Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& s) const {
    s.m = beta1 * s.m + (1 - beta1) * g;
    s.v = beta2 * s.v + (1 - beta2) * g.cwiseAbs2();
    s.power1 *= beta1;
    s.power2 *= beta2;
    theta.array() -=
        rate / (1 - s.power1) * s.m.array() / ((s.v.array() / (1 - s.power2)).sqrt() + epsilon);
  }
};

void fields(Adam& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squared gradient");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

}  // namespace

void register_adam(OptimizerRegistry& registry) {
  registry.add(rule_entry<Adam>(
      {.name = "adam",
       .title = "Adam",
       .kind = Kind::adaptive,
       .formula = "m ← β₁ m + (1−β₁) ∇L,  v ← β₂ v + (1−β₂) ∇L²,  θ ← θ − η m̂/(√v̂ + ε)",
       .source = "Kingma, Ba (2015), algorithm 1",
       .tunable = {.option = "rate", .below = 0}}));
}

}  // namespace isoline::optimizers
