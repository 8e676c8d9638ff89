// Steps along the gradient, alone or with momentum.
//
//   gd        Cauchy (1847): θ ← θ − η ∇L
//   momentum  heavy ball, Polyak (1964): v ← μ v + ∇L, θ ← θ − η v. The velocity is in units of the
//             gradient, as in PyTorch's SGD; for a constant η the iterates are Polyak's.
//   nesterov  Nesterov (1983), with constant momentum as in Sutskever et al. (2013), eqs. 3-4:
//             v ← μ v + ∇L, θ ← θ − η (∇L + μ v). Here θ is the shifted point at which the gradient
//             is taken, as in PyTorch's SGD, so that one gradient a step is enough.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct GradientDescent {
  Real rate = 1e-2;

  struct State {};
  State init(Index) const { return {}; }
  void update(VectorRef g, Vector& theta, State&) const { theta -= rate * g; }
};
void fields(GradientDescent& o, auto& field) { field("rate", o.rate, above(0), "step length η"); }

template <bool looks_ahead>
struct Momentum {
  Real rate = 1e-2, momentum = 0.9;

  struct State {
    Vector v;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.v); }
  State init(Index n) const { return {Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& s) const {
    s.v = momentum * s.v + g;
    if constexpr (looks_ahead)
      theta -= rate * (g + momentum * s.v);
    else
      theta -= rate * s.v;
  }
};
template <bool looks_ahead>
void fields(Momentum<looks_ahead>& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("momentum", o.momentum, between(0, 1), "share μ of the velocity that is kept");
}

const Tunable kByCauchy{.option = "rate", .below = 4, .unit = Tunable::Unit::cauchy};

}  // namespace

void register_gd(OptimizerRegistry& registry) {
  registry.add(rule_entry<GradientDescent>({.name = "gd",
                                            .title = "Gradient descent",
                                            .kind = Kind::gradient,
                                            .formula = "θ ← θ − η ∇L",
                                            .source = "Cauchy (1847); Goldstein (1964)",
                                            .note = "Each iterate is projected onto the bounds of "
                                                    "the problem, if there are any.",
                                            .keeps_bounds = true,
                                            .tunable = kByCauchy}));
  registry.add(rule_entry<Momentum<false>>({.name = "momentum",
                                            .title = "Gradient descent with momentum",
                                            .kind = Kind::gradient,
                                            .formula = "v ← μ v + ∇L,  θ ← θ − η v",
                                            .source = "Polyak (1964)",
                                            .tunable = kByCauchy}));
  registry.add(
      rule_entry<Momentum<true>>({.name = "nesterov",
                                  .title = "Nesterov's accelerated gradient",
                                  .kind = Kind::gradient,
                                  .formula = "v ← μ v + ∇L,  θ ← θ − η (∇L + μ v)",
                                  .source = "Nesterov (1983); Sutskever et al. (2013), eqs. 3-4",
                                  .note = "θ is the point at which the gradient is taken.",
                                  .tunable = kByCauchy}));
}

}  // namespace isoline::optimizers
