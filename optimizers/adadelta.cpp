// Adadelta, Zeiler (2012), algorithm 1: s ← ρ s + (1 − ρ) ∇L², Δ = √(u + ε)/√(s + ε) ∇L, u ← ρ u +
// (1 − ρ) Δ², θ ← θ − η Δ. The rate η, 1 in the paper, is PyTorch's addition.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Adadelta {
  Real rate = 1, rho = 0.9, epsilon = 1e-6;

  struct State {
    Vector s, u, step;  // (n) mean squares of gradients and of steps, and Δ
  };
  static void persist(State& s, Archive& archive) { archive(s.s, s.u); }
  State init(Index n) const { return {Vector::Zero(n), Vector::Zero(n), Vector::Zero(n)}; }
  void update(VectorRef g, Vector& theta, State& state) const {
    auto& [s, u, step] = state;
    s = rho * s + (1 - rho) * g.cwiseAbs2();
    step = ((u.array() + epsilon) / (s.array() + epsilon)).sqrt() * g.array();
    u = rho * u + (1 - rho) * step.cwiseAbs2();
    theta -= rate * step;
  }
};

void fields(Adadelta& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("rho", o.rho, decay(), "decay ρ of the mean squares");
  field("epsilon", o.epsilon, above(0), "ε: makes the first steps and floors the scale");
}

}  // namespace

void register_adadelta(OptimizerRegistry& registry) {
  registry.add(rule_entry<Adadelta>(
      {.name = "adadelta",
       .title = "Adadelta",
       .kind = Kind::adaptive,
       .formula = "s ← ρ s + (1−ρ) ∇L²,  Δ = √(u+ε)/√(s+ε) ∇L,  u ← ρ u + (1−ρ) Δ²,  θ ← θ − η Δ",
       .source = "Zeiler (2012), algorithm 1",
       .tunable = {.option = "rate", .below = 2}}));
}

}  // namespace isoline::optimizers
