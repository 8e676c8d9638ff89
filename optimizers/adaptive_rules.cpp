// Steps along the gradient over its own history, component by component.
//
//   adagrad   Duchi, Hazan, Singer (2011), fig. 1, diagonal: v ← v + ∇L², θ ← θ − η ∇L/(√v + ε).
//             The ε stands outside the root, as in PyTorch.
//   rmsprop   Tieleman, Hinton (2012), lecture 6e: v ← α v + (1 − α) ∇L², θ ← θ − η ∇L/(√v + ε).
//             The constants are PyTorch's: α = 0.99 where the lecture has 0.9.
//   adadelta  Zeiler (2012), algorithm 1: s ← ρ s + (1 − ρ) ∇L², Δ = √(u + ε)/√(s + ε) ∇L,
//             u ← ρ u + (1 − ρ) Δ², θ ← θ − η Δ. The rate η, 1 in the paper, is PyTorch's addition.
//   adam      Kingma, Ba (2015), algorithm 1: m ← β₁ m + (1 − β₁) ∇L, v ← β₂ v + (1 − β₂) ∇L²,
//             θ ← θ − η m̂/(√v̂ + ε), where m̂ = m/(1 − β₁ᵗ) and v̂ = v/(1 − β₂ᵗ).
//   adamw     Loshchilov, Hutter (2019), algorithm 2: θ ← (1 − η λ) θ, then Adam's step. As in
//             PyTorch the decay is multiplied by the rate η.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

void rate_field(Real& rate, auto& field) { field("rate", rate, above(0), "step length η"); }

// Rules that keep one vector from step to step.
struct WithMemory {
  struct State {
    Vector v;  // (n)
  };
  static void persist(State& s, Archive& archive) { archive(s.v); }
  State init(Index n) const { return {Vector::Zero(n)}; }
};

struct Adagrad : WithMemory {
  Real rate = 1e-2, epsilon = 1e-10;

  void update(VectorRef g, Vector& theta, State& s) const {
    s.v += g.cwiseAbs2();
    theta.array() -= rate * g.array() / (s.v.array().sqrt() + epsilon);
  }
};
void fields(Adagrad& o, auto& field) {
  rate_field(o.rate, field);
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

struct Rmsprop : WithMemory {
  Real rate = 1e-2, alpha = 0.99, epsilon = 1e-8;

  void update(VectorRef g, Vector& theta, State& s) const {
    s.v = alpha * s.v + (1 - alpha) * g.cwiseAbs2();
    theta.array() -= rate * g.array() / (s.v.array().sqrt() + epsilon);
  }
};
void fields(Rmsprop& o, auto& field) {
  rate_field(o.rate, field);
  field("alpha", o.alpha, decay(), "decay α of the mean square");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

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
  rate_field(o.rate, field);
  field("rho", o.rho, decay(), "decay ρ of the mean squares");
  field("epsilon", o.epsilon, above(0),
        "ε, which determines the first steps and bounds the "
        "scale from below");
}

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
  rate_field(o.rate, field);
  field("beta1", o.beta1, decay(), "decay β₁ of the mean gradient");
  field("beta2", o.beta2, decay(), "decay β₂ of the mean squared gradient");
  field("epsilon", o.epsilon, at_least(0), "floor ε of the scale");
}

struct Adamw : Adam {
  Real weight_decay = 1e-2;

  void update(VectorRef g, Vector& theta, State& s) const {
    theta *= 1 - rate * weight_decay;
    Adam::update(g, theta, s);
  }
};
void fields(Adamw& o, auto& field) {
  fields(static_cast<Adam&>(o), field);
  field("weight-decay", o.weight_decay, at_least(0), "decay λ of the parameters");
}

}  // namespace

void register_adaptive_rules(OptimizerRegistry& registry) {
  registry.add(rule_entry<Adagrad>({.name = "adagrad",
                                    .title = "Adagrad",
                                    .kind = Kind::adaptive,
                                    .formula = "s ← s + ∇L²,  θ ← θ − η ∇L/(√s + ε)",
                                    .source = "Duchi, Hazan, Singer (2011), fig. 1",
                                    .tunable = {.option = "rate", .below = 0}}));
  registry.add(rule_entry<Rmsprop>({.name = "rmsprop",
                                    .title = "RMSprop",
                                    .kind = Kind::adaptive,
                                    .formula = "s ← α s + (1−α) ∇L²,  θ ← θ − η ∇L/(√s + ε)",
                                    .source = "Tieleman, Hinton (2012), lecture 6e",
                                    .tunable = {.option = "rate", .below = 2}}));
  registry.add(rule_entry<Adadelta>(
      {.name = "adadelta",
       .title = "Adadelta",
       .kind = Kind::adaptive,
       .formula = "s ← ρ s + (1−ρ) ∇L²,  Δ = √(u+ε)/√(s+ε) ∇L,  u ← ρ u + (1−ρ) Δ²,  θ ← θ − η Δ",
       .source = "Zeiler (2012), algorithm 1",
       .tunable = {.option = "rate", .below = 2}}));
  registry.add(rule_entry<Adam>(
      {.name = "adam",
       .title = "Adam",
       .kind = Kind::adaptive,
       .formula = "m ← β₁ m + (1−β₁) ∇L,  v ← β₂ v + (1−β₂) ∇L²,  θ ← θ − η m̂/(√v̂ + ε)",
       .source = "Kingma, Ba (2015), algorithm 1",
       .tunable = {.option = "rate", .below = 0}}));
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
