// Accelerated gradient, Nesterov (1983), with constant momentum as in Sutskever et al. (2013), eqs.
// 3-4: v ← μ v + ∇L, θ ← θ − η (∇L + μ v). Here θ is the shifted point at which the gradient is
// taken, as in PyTorch's SGD, so that one gradient a step is enough.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Nesterov {
  Real rate = 1e-2, momentum = 0.9;

  struct State {
    Vector v;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.v); }
  State init(Index n) const { return {Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& s) const {
    s.v = momentum * s.v + g;
    theta -= rate * (g + momentum * s.v);
  }
};

void fields(Nesterov& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share μ of the velocity that is kept");
}

}  // namespace

void register_nesterov(OptimizerRegistry& registry) {
  registry.add(rule_entry<Nesterov>(
      {.name = "nesterov",
       .title = "Nesterov's accelerated gradient",
       .kind = Kind::gradient,
       .formula = "v ← μ v + ∇L,  θ ← θ − η (∇L + μ v)",
       .source = "Nesterov (1983); Sutskever et al. (2013), eqs. 3-4",
       .note = "θ is the point at which the gradient is taken.",
       .tunable = {.option = "rate", .below = 4, .unit = Tunable::Unit::cauchy}}));
}

}  // namespace isoline::optimizers
