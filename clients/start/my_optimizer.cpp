// My optimizer: v ← β v − η ∇L, θ ← θ + v. State the formula, its source, and any
// deviation from the source.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct MyOptimizerRule {
  Real rate = 1e-3, momentum = 0.9;

  struct State {
    Vector v;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.v); }

  State init(Index n) const { return {.v = Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& s) const {
    s.v = momentum * s.v - rate * g;
    theta += s.v;
  }
};

void fields(MyOptimizerRule& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share β of the last step");
}

}  // namespace

void register_my_optimizer(OptimizerRegistry& registry) {
  registry.add(rule_entry<MyOptimizerRule>({.name = "my-optimizer",
                                            .title = "My optimizer",
                                            .formula = "v ← β v − η ∇L,  θ ← θ + v",
                                            .source = "author (year), equation",
                                            .tunable = {.option = "rate"}}));
}

}  // namespace isoline::optimizers
