// Adagrad, Duchi, Hazan, Singer (2011), fig. 1, diagonal: s ← s + ∇L², θ ← θ − η ∇L/(√s + ε). The ε
// stands outside the root, as in PyTorch.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Adagrad {
  Real rate = 1e-2, epsilon = 1e-10;

  struct State {
    Vector s;  // (n), sum of squared gradients
  };
  static void persist(State& s, Archive& archive) { archive(s.s); }
  State init(Index n) const { return {Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& state) const {
    state.s += g.cwiseAbs2();
    theta.array() -= rate * g.array() / (state.s.array().sqrt() + epsilon);
  }
};

void fields(Adagrad& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

}  // namespace

void register_adagrad(OptimizerRegistry& registry) {
  registry.add(rule_entry<Adagrad>({.name = "adagrad",
                                    .title = "Adagrad",
                                    .kind = Kind::adaptive,
                                    .formula = "s ← s + ∇L²,  θ ← θ − η ∇L/(√s + ε)",
                                    .source = "Duchi, Hazan, Singer (2011), fig. 1",
                                    .tunable = {.option = "rate", .below = 0}}));
}

}  // namespace isoline::optimizers
