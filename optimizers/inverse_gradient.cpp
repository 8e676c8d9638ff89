// Inverse gradient, Thuerey et al., Physics-based Deep Learning, chapter "Scale-Invariance and
// Inversion": Δx = J⁻¹ Δy with Δy = η (y* − y), the linearized form of the physics inversion.
#include <fmt/format.h>

#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct InverseGradient {
  Real rate = 1;
  std::string fallback = "none";

  struct State {
    Linearization at;
    Vector dy, dx;  // (m·B), (n)
    Index fallbacks = 0;
  };
  static void persist(State& s, Archive& archive) { archive(s.fallbacks); }
  State init(Meter& f, const Vector&) const {
    if (fallback == "gradient") f.name_series({"steps along the gradient"});
    return {};
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.dy = rate * (f.target() - s.at.y()).reshaped();
    if (!solve_square(s.at.jacobian(), s.dy, s.dx)) {
      f.claim("the Jacobian is singular");
      if (fallback == "none") return Status::stalled;
      s.dx.noalias() = s.at.jacobian().transpose() * s.dy;
      ++s.fallbacks;
    }
    if (fallback == "gradient") f.note(0, static_cast<Real>(s.fallbacks));
    theta += s.dx;
    return Status::running;
  }
};

void fields(InverseGradient& o, auto& field) {
  field("rate", o.rate, above(0), "step length η in y");
  field("fallback", o.fallback, Choices{"none", "gradient"},
        "where the Jacobian is singular: the method stops; or it steps by JᵀΔy, which is counted");
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
                                      .source = "Thuerey et al., Physics-based Deep Learning, "
                                                "chapter Scale-Invariance and Inversion",
                                      .needs = {Oracle::forward, Oracle::jacobian},
                                      .is_input_scale_invariant = true,
                                      .most_rank = 2048,
                                      .tunable = {.option = "rate", .below = 5},
                                      .objection = objection}));
}

}  // namespace isoline::optimizers
