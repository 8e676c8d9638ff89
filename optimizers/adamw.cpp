// Adam with decoupled weight decay, Loshchilov, Hutter (2019), algorithm 2: θ ← (1 − η λ) θ, then
// Adam's step. As in PyTorch the decay is multiplied by the rate η.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Adamw {
  Real rate = 1e-3, beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8, weight_decay = 1e-2;

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
    theta *= 1 - rate * weight_decay;
    theta.array() -=
        rate / (1 - s.power1) * s.m.array() / ((s.v.array() / (1 - s.power2)).sqrt() + epsilon);
  }
};

void fields(Adamw& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squared gradient");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
  field("weight-decay", o.weight_decay, at_least(0), "decay λ of the parameters");
}

}  // namespace

void register_adamw(OptimizerRegistry& registry) {
  registry.add(rule_entry<Adamw>({.name = "adamw",
                                  .title = "Adam with decoupled weight decay",
                                  .kind = Kind::adaptive,
                                  .formula = "θ ← (1 − η λ) θ − η m̂/(√v̂ + ε)",
                                  .source = "Loshchilov, Hutter (2019), algorithm 2",
                                  .note = "Its fixed point is not the minimum of L but is pulled "
                                          "toward θ = 0.",
                                  .tunable = {.option = "rate", .below = 0}}));
}

}  // namespace isoline::optimizers
