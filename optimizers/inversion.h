// One step of inverting the physics alone: from where it was linearized to an x̃ that brings y
// nearer to y*, sample by sample. What scale-invariant physics training chooses between.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/array.h"
#include "core/options.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

// Between the extremes of |S| also after rounding, so that equal curvatures are never above it.
template <class Curvatures>
Real geometric_mean(const Curvatures& S) {
  if (S.size() == 2) return std::sqrt(std::abs(S[0] * S[1]));
  const Real mean = std::exp(S.array().abs().log().mean());  // 0 if any S is
  return std::clamp(mean, Real(S.cwiseAbs().minCoeff()), Real(S.cwiseAbs().maxCoeff()));
}

// The way against the gradient is this, with the sign of the slope g̃ᵢ; no curvature, no step.
inline Real saddle_free_length(Real slope, Real curvature, Real mean, Real max_loss_change) {
  if (slope == 0 || curvature == 0) return 0;
  const Real size = std::abs(curvature);
  const bool is_within = slope * slope <= max_loss_change * size;  // |g̃/S| ≤ Δ/|g̃|
  return curvature > mean || is_within ? slope / size : max_loss_change / slope;
}

// Limited-memory BFGS (Nocedal 1980) for methods that minimize a misfit f ≥ 0 inside a step, such
// as the numerical inversion of a physics. Uses Luksan's code through NLopt.

// f and its gradient at x, both (n).
using ValueAndGradient = std::function<Real(VectorRef x, VectorOut gradient)>;

struct LbfgsLimits {
  Index evaluations = 200;
  Real enough = 0;                          // stop at f ≤ enough
  std::function<bool()> is_over = nullptr;  // called before each evaluation
};

// Moves x to the best point found.
void minimize_lbfgs(const ValueAndGradient& f, const LbfgsLimits& limits, Vector& x);

class Inversion {
 public:
  virtual ~Inversion() = default;
  // found: x̃, (k, B). How many samples were moved along the gradient, their inverse having failed.
  virtual Index invert(Meter& f, Linearization& at, Matrix& found) = 0;
};

// Which, and how: the options that all methods share that invert the physics.
struct InversionOptions {
  Real step = 1, max_loss_change = 0.2;
  std::string inverse = "auto", difference = "target", fallback = "none";
  Index inverse_evaluations = 200;
};

inline void fields(InversionOptions& o, auto& field) {
  field("step", o.step, above(0), "step length η toward y*");
  field(
      "inverse", o.inverse,
      Choices{"auto", "analytic", "damped", "newton", "lbfgs", "gradient", "gradients"},
      "local inverse: the problem's own (damped requires a damped one); a saddle-free Newton "
      "step; L-BFGS; or U = −η ∂L/∂x of each sample's loss, which is backpropagation; or the sum of "
      "eight such steps, as long as the first; auto: the "
      "problem's own where there is one, else L-BFGS");
  field(
      "difference", o.difference, Choices{"target", "newton"},
      "Δy that the problem's own inverse and L-BFGS undo: y* − y, or Newton's step on the loss in "
      "y with |∂²L/∂y²|, which is the same for multiples of ‖y − y*‖²");
  field("max-loss-change", o.max_loss_change, above(0),
        "of inverse=newton: limit Δ on the linear change of a sample's loss along a direction of "
        "low or negative curvature");
  field("inverse-evaluations", o.inverse_evaluations, between(1, 1e6),
        "for inverse=lbfgs: most evaluations per step");
}

std::unique_ptr<Inversion> make_inversion(const InversionOptions& options, Inverse kind);
OracleSet needs_of(const InversionOptions& options, const Problem& problem);  // and the network
// The reason why it cannot treat a problem; empty if it can.
std::string objection_to(const InversionOptions& options, const Problem& problem);

// x̃ = x − V diag(sign(g̃ᵢ) lᵢ) Vᵀ, lᵢ = |g̃ᵢ/(Sᵢ + μ)|, at most `clip` where that is not 0: Newton's
// step on ½‖P(x) − y*‖² against the gradient, with H = V diag(S) Vᵀ and g̃ = Vᵀ∇L.
std::unique_ptr<Inversion> inversion_by_plain_newton(Real clip, Real damping);
// For a Newton step, named `what`: it needs few inputs of the physics.
std::string objection_to_newton(const Problem& problem, std::string_view what);

}  // namespace isoline::optimizers
