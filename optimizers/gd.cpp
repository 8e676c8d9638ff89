// Steepest descent, Cauchy (1847): θ ← θ − η ∇L.
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

}  // namespace

void register_gd(OptimizerRegistry& registry) {
  registry.add(rule_entry<GradientDescent>(
      {.name = "gd",
       .title = "Gradient descent",
       .kind = Kind::gradient,
       .formula = "θ ← θ − η ∇L",
       .source = "Cauchy (1847)",
       .tunable = {.option = "rate", .below = 4, .unit = Tunable::Unit::cauchy}}));
}

}  // namespace isoline::optimizers
