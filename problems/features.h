// Features that any direct problem can have, as options: noise in the data, data of another model,
// badly scaled or rotated unknowns, few digits, regularization, bounds, noise of the calls, no
// derivatives. Options with default values do not appear in specs, records or cells.
#pragma once

#include <optional>

#include "core/differences.h"
#include "core/options.h"
#include "problems/model.h"
#include "problems/problem.h"

namespace isoline::problems {

inline constexpr Real kNearFit = 0.1;

struct Features : ModelWords {
  Real noise = 0;
  std::string noise_kind = "gaussian", model, goal = "truth";
  Real scale = 1;
  bool rotate = false;
  Index digits = 0;
  Real tikhonov = 0;
  Index order = 0;
  std::string bounds = "none";
  Real jitter = 0;
  std::string derivatives = "exact", difference_step;
  Real fail = 0;
};
inline void fields(Features& o, auto& field) {
  field("noise", o.noise, between(0, 10),
        "standard deviation of the noise, divided by the rms of y*");
  field("noise-kind", o.noise_kind, {"gaussian", "uniform", "outliers"},
        "distribution of the noise; outliers: one value in ten has ten times the deviation");
  field("model", o.model, {}, "options of the variant of P that makes y*, as \"steps=32\"");
  field("goal", o.goal, {"truth", "fit"},
        "what errors in x are measured from: x*, or with noise the least-squares solution, in its "
        "standard deviations");
  field("scale", o.scale, between(1, 1e12), "ratio of the largest to the smallest scale of x");
  field("rotate", o.rotate, "random rotation of x, before it is scaled");
  field("digits", o.digits, between(0, 16), "significant digits of y; 0: all");
  field("tikhonov", o.tikhonov, between(0, 1e12), "α of the penalty ½α‖Dx‖²");
  field("order", o.order, between(0, 1),
        "D of the penalty; 0: identity, 1: differences of neighbours");
  field("bounds", o.bounds, {"none", "wide", "active"},
        "a box around x*: wide, or with one upper bound in three below x*, so that the solution "
        "lies on bounds");
  field("jitter", o.jitter, between(0, 10),
        "σ of the noise of each call, which multiplies each residual by 1 + σz, z ~ N(0, 1)");
  field("derivatives", o.derivatives, {"exact", "forward", "central", "none"},
        "those of the problem; by forward or central differences, at the cost of their calls; or "
        "none");
  field("difference-step", o.difference_step, {}, kStepHelp);
  field(
      "fail", o.fail, between(0, 0.5),
      "share of all x at which the evaluation fails: parallel layers that hold neither x₀ nor x*");
  fields(static_cast<ModelWords&>(o), field);
}

// Whether f_L is the loss of a fit from x*, which a run may better from elsewhere.
bool has_fitted_minimum(const OptionValues& complete_options);

// Without names that the problem itself declares.
OptionTable feature_table(const OptionTable& own);

// `target`: y* of another model, (m, 1), in place of the problem's own.
//
// x = S Q z for the unknowns z that an optimizer sees, with Q orthogonal and S diagonal from
// scale^-½ to scale^½; errors in x are those of x. With noise, or data of another model, no x makes
// y*: f_L is then the loss of the least-squares fit from x*, and the floor of the error in x that
// of the best truncated-SVD solution with the Jacobian at x*, from x₀ (Hansen 1998, section 3.2).
// Both are missing where x* is unknown and above 512 unknowns, where only the floor is known of up
// to 512 observations.
// The noise level includes what another model adds: the norm of the difference of the two y*.
// With goal=fit x* is that fit x̂, and the error in x is ‖J(x̂)(x − x̂)‖/σ, σ the noise of one
// observation: the distance in standard deviations. Solved is what is within kNearFit of them.
// With active bounds f_L is the loss of the fit within them, and the floor its distance from x*.
// UsageError if the problem is learned, if y* = 0 has noise, for a penalty on another loss than
// that of least squares, or for bounds where x* is unknown.
Problem with_features(Problem plain, const OptionValues& features, const Draw& draw,
                      const std::optional<Matrix>& target = {});

// A direct problem that declares a scale for each unknown or bounds, as methods see it: θᵢ = xᵢ/sᵢ
// with sᵢ = |xᵢ| at the start; where that is 0 the width of its bounds, if finite; else 1/‖∂y/∂xᵢ‖
// there, by one call. Others are returned as they are.
Problem with_scaled_unknowns(Problem plain);

}  // namespace isoline::problems
