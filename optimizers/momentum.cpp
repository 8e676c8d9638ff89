// Heavy ball, Polyak (1964): v ← μ v + ∇L, θ ← θ − η v. Written with the velocity in units
// of the gradient, as in PyTorch's SGD; for a constant η the iterates are Polyak's.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Momentum {
  Real rate = 1e-2, momentum = 0.9;

  struct State {
    Vector v;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.v); }
  State init(Index n) const { return {Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& s) const {
    s.v = momentum * s.v + g;
    theta -= rate * s.v;
  }
};

void fields(Momentum& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share μ of the velocity that is kept");
}

}  // namespace

void register_momentum(OptimizerRegistry& registry) {
  registry.add(rule_entry<Momentum>(
      {.name = "momentum",
       .title = "Gradient descent with momentum",
       .kind = Kind::gradient,
       .formula = "v ← μ v + ∇L,  θ ← θ − η v",
       .source = "Polyak (1964)",
       .tunable = {.option = "rate", .below = 4, .unit = Tunable::Unit::cauchy}}));
}

}  // namespace isoline::optimizers
