// Newton's method with the exact Hessian: θ ← θ − η H⁻¹ ∇L; Nocedal, Wright (2006), eq. 3.30.
// Pure: it goes to whatever stationary point the quadratic model has, and stops where H is
// singular, or steps along the gradient there as the book's chapter on scale invariance has it.
#include "core/decompose.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Newton {
  Real rate = 1;
  std::string fallback = "none";

  struct State {
    Linearization at;
    Vector gradient, step;  // (n)
    Index fallbacks = 0;
  };
  static void persist(State& s, Archive& archive) { archive(s.fallbacks); }
  State init(Meter& f, const Vector&) const {
    if (fallback == "gradient") f.name_series({"steps along the gradient"});
    return {};
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    if (!solve_square(s.at.hessian(), s.gradient, s.step)) {
      f.claim("the Hessian is singular");
      if (fallback == "none") return Status::stalled;
      s.step = s.gradient;
      ++s.fallbacks;
    }
    if (fallback == "gradient") f.note(0, static_cast<Real>(s.fallbacks));
    theta -= rate * s.step;
    return Status::running;
  }
};

void fields(Newton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field(
      "fallback", o.fallback, Choices{"none", "gradient"},
      "where the Hessian is singular: the method stops; or it steps along the gradient at the same "
      "rate, which is counted");
}

}  // namespace

void register_newton(OptimizerRegistry& registry) {
  registry.add(stepper_entry<Newton>(
      {.name = "newton",
       .title = "Newton's method",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "θ ← θ − η H⁻¹ ∇L,  H = ∇²L",
       .source = "Nocedal, Wright (2006), eq. 3.30",
       .note = "Without safeguards: saddle points and maxima attract it, too.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::hessian},
       .is_input_scale_invariant = true,
       .most_unknowns = 2048,
       .tunable = {.option = "rate", .below = 5}}));
}

}  // namespace isoline::optimizers
