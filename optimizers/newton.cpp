// Newton's methods, and the inverse gradient.
#include <fmt/format.h>

#include "core/decompose.h"
#include "optimizers/inversion.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

// Newton's method with the exact Hessian: θ ← θ − η H⁻¹ ∇L; Nocedal, Wright (2006), eq. 3.30.
// Pure: it goes to whatever stationary point the quadratic model has, and stops where H is
// singular, or steps along the gradient there as the book's chapter on scale invariance has it.
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

// Saddle-free Newton with a limit on the change of loss, Holl, Koltun, Thuerey (2022), sine
// problem, as inversion.h has it: θ ← θ − η V d, H = V diag(S) Vᵀ. The published script's
// transposed V is corrected.
struct SaddleFreeNewton {
  Real rate = 1, max_loss_change = 0.2;

  struct State {
    Linearization at;
    SymmetricEigen eigen;
    Vector gradient, along;  // (n), ∇L and the step in the eigenbasis
  };
  static void persist(State&, Archive&) {}  // all of it is scratch
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    if (!symmetric_eigen(s.at.hessian(), s.eigen)) {
      f.claim("the Hessian has no eigenvalues in finite numbers");
      return Status::stalled;
    }
    s.along.noalias() = s.eigen.V.transpose() * s.gradient;
    const Real mean = geometric_mean(s.eigen.lambda);
    for (Index i = 0; i < s.along.size(); ++i)
      s.along[i] = saddle_free_length(s.along[i], s.eigen.lambda[i], mean, max_loss_change);
    theta.noalias() -= rate * s.eigen.V * s.along;
    return Status::running;
  }
};

void fields(SaddleFreeNewton& o, auto& field) {
  field("rate", o.rate, above(0), "step length η");
  field("max-loss-change", o.max_loss_change, above(0),
        "limit Δ on the linear change of loss along a direction of low or negative curvature");
}

// Inverse gradient, Thuerey et al., Physics-based Deep Learning, chapter "Scale-Invariance and
// Inversion": Δx = J⁻¹ Δy with Δy = η (y* − y), the linearized form of the physics inversion.
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
  registry.add(stepper_entry<SaddleFreeNewton>(
      {.name = "saddle-free-newton",
       .title = "Saddle-free Newton with a step limit",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "H = V diag(S) Vᵀ, g̃ = Vᵀ∇L;  θ ← θ − η V d,  dᵢ = sign(g̃ᵢ)·(|g̃ᵢ/Sᵢ| where "
                  "Sᵢ > S̄, else min(|g̃ᵢ/Sᵢ|, Δ/|g̃ᵢ|))",
       .source = "Holl, Koltun, Thuerey (2022), published script; Dauphin et al. (2014)",
       .note =
           "S̄ is the geometric mean of |S|; there is no step along directions without curvature.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::hessian},
       .most_unknowns = 2048,
       .tunable = {.option = "rate", .below = 5}}));
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
