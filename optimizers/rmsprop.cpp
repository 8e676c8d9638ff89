// RMSprop, Tieleman, Hinton (2012), lecture 6e: s ← α s + (1 − α) ∇L², θ ← θ − η ∇L/(√s + ε). The
// constants are PyTorch's: α = 0.99 where the lecture has 0.9.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Rmsprop {
  Real rate = 1e-2, alpha = 0.99, epsilon = 1e-8;

  struct State {
    Vector s;  // (n), mean of squared gradients
  };
  static void persist(State& s, Archive& archive) { archive(s.s); }
  State init(Index n) const { return {Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& state) const {
    state.s = alpha * state.s + (1 - alpha) * g.cwiseAbs2();
    theta.array() -= rate * g.array() / (state.s.array().sqrt() + epsilon);
  }
};

void fields(Rmsprop& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("alpha", o.alpha, decay(), "decay α of the mean square");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

}  // namespace

void register_rmsprop(OptimizerRegistry& registry) {
  registry.add(rule_entry<Rmsprop>({.name = "rmsprop",
                                    .title = "RMSprop",
                                    .kind = Kind::adaptive,
                                    .formula = "s ← α s + (1−α) ∇L²,  θ ← θ − η ∇L/(√s + ε)",
                                    .source = "Tieleman, Hinton (2012), lecture 6e",
                                    .tunable = {.option = "rate", .below = 2}}));
}

}  // namespace isoline::optimizers
