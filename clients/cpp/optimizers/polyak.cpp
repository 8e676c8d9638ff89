// θ ← θ − ((L − f_L) / ‖∇L‖²) ∇L, a step that needs f_L instead of a rate: Polyak (1969).
// f_L is an option, 0 if the data can be fitted exactly.
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Polyak {
  Real minimum = 0;

  struct State {
    Linearization at;
    Vector g;  // (n)
  };
  static void persist(State&, Archive&) {}  // no state survives a step

  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.g);
    const Real slope = s.g.squaredNorm();
    if (slope == 0) return Status::converged;
    theta -= ((s.at.loss() - minimum) / slope) * s.g;
    return Status::running;
  }
};

void fields(Polyak& o, auto& field) { field("minimum", o.minimum, at_least(0), "least loss f_L"); }

}  // namespace

void register_polyak(OptimizerRegistry& registry) {
  registry.add(stepper_entry<Polyak>({.name = "polyak",
                                      .title = "Polyak's step",
                                      .kind = Kind::gradient,
                                      .formula = "θ ← θ − ((L − f_L) / ‖∇L‖²) ∇L",
                                      .source = "Polyak (1969)",
                                      .needs = {Oracle::forward, Oracle::pullback}}));
}

}  // namespace isoline::optimizers
