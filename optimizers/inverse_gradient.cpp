// Inverse gradient, Holl, Koltun, Thuerey (2022), inverse gradients: Δx = J⁻¹ Δy with Δy = η (y* −
// y), the linearized form of the physics inversion; the grey circles (x₁, x₂/2) of its Fig. 1.
#include <fmt/format.h>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct InverseGradient {
  Real rate = 1;

  struct State {
    Linearization at;
    Vector dy, dx;  // (m·B), (n)
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.dy = rate * (f.target() - s.at.y()).reshaped();
    if (!solve_square(s.at.jacobian(), s.dy, s.dx)) {
      f.claim("the Jacobian is singular");
      return Status::stalled;
    }
    theta += s.dx;
    return Status::running;
  }
};

void fields(InverseGradient& o, auto& field) {
  field("rate", o.rate, above(0), "step length η in y");
}

std::string objection(const OptionValues&, const Problem& problem) {
  if (problem.residuals() == problem.unknowns()) return "";
  return fmt::format("the Jacobian has no inverse: {} residuals, {} unknowns", problem.residuals(),
                     problem.unknowns());
}

}  // namespace

void register_inverse_gradient(OptimizerRegistry& registry) {
  registry.add(
      stepper_entry<InverseGradient>({.name = "inverse-gradient",
                                      .title = "Inverse gradient",
                                      .family = Family::inversion,
                                      .kind = Kind::inversion,
                                      .formula = "θ ← θ + J⁻¹ Δy,  Δy = η (y* − y)",
                                      .source = "Holl, Koltun, Thuerey (2022), inverse gradients",
                                      .needs = {Oracle::forward, Oracle::jacobian},
                                      .is_input_scale_invariant = true,
                                      .most_rank = 2048,
                                      .tunable = {.option = "rate", .below = 5},
                                      .objection = objection}));
}

}  // namespace isoline::optimizers
