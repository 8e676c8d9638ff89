// The step along an eigenvector of a Hessian that neither saddles attract nor flat directions carry
// away: Holl, Koltun, Thuerey (2022), published script for the sine; |H|⁻¹ after Dauphin et al.
// (2014). With H = V diag(S) Vᵀ and g̃ = Vᵀ∇L its length is |g̃ᵢ/Sᵢ|, and where Sᵢ is not above
// S̄ = √|S₁S₂| at most Δ/|g̃ᵢ|; it goes against g̃ᵢ. S̄ is the geometric mean of |S| for any n.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/array.h"

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

}  // namespace isoline::optimizers
