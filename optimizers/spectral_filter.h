// The filter of the singular values of J = U diag(σ) Vᵀ: every spectral method steps by
// Δθ = −η V f(σ) Uᵀ g, and every f here is one formula,
//
//   f(σ) = σ (σ² + μ)^(−(κ+1)/2)  where σ > τ σ₁,  else 0,
//
// Hansen (1998), chapter 4, for κ = 1: Tikhonov with μ, the truncated inverse without.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/real.h"

namespace isoline::optimizers {

// The reference of a filter.
struct Spectrum {
  Real largest = 0;      // σ₁
  Real mean_square = 0;  // the mean diagonal of K = JJᵀ, which is ‖J‖²/(m·B)
};

struct SpectralFilter {
  enum class Unit { largest, mean };  // of μ: σ₁², or the mean diagonal of K

  Real kappa;           // κ
  Real cutoff = 0;      // τ
  bool clamps = false;  // of σ > 0 those up to the cut-off count as it, instead of nothing
  Real damping = 0;     // μ, in its unit
  Unit unit = Unit::largest;

  Real mu(const Spectrum& of) const {
    return damping * (unit == Unit::largest ? of.largest * of.largest : of.mean_square);
  }
  Real operator()(Real sigma, const Spectrum& of) const {
    if (damping > 0) return sigma * over_sigma(sigma, of);
    return power(sigma, of, kappa);
  }
  // f(σ)/σ, which is what a function of JJᵀ or JᵀJ has to be.
  Real over_sigma(Real sigma, const Spectrum& of) const {
    if (damping > 0) return std::pow(sigma * sigma + mu(of), -(kappa + 1) / 2);
    if (clamps) return sigma > 0 ? power(sigma, of, kappa) / sigma : 0;
    return power(sigma, of, kappa + 1);
  }
  // Whether σ adds to the step.
  bool keeps(Real sigma, const Spectrum& of) const {
    return clamps ? sigma > 0 : sigma > cutoff * of.largest;
  }
  // Below which σ makes no difference to f(σ)/σ any more, however small it is.
  Real least_that_matters(const Spectrum& of) const {
    return std::max(cutoff * of.largest, std::sqrt(mu(of)));
  }

 private:
  Real power(Real sigma, const Spectrum& of, Real exponent) const {
    if (clamps && sigma > 0) return std::pow(std::max(sigma, cutoff * of.largest), -exponent);
    return sigma > cutoff * of.largest ? std::pow(sigma, -exponent) : 0;
  }
};

// σ^(−κ), discarded up to the cut-off, or clamped to it.
inline SpectralFilter power_filter(Real kappa, Real cutoff) {
  return {.kappa = kappa, .cutoff = cutoff};
}
inline SpectralFilter clamped_power_filter(Real kappa, Real cutoff) {
  return {.kappa = kappa, .cutoff = cutoff, .clamps = true};
}
// 1/σ above the cut-off: truncated Gauss-Newton.
inline SpectralFilter truncated_inverse_filter(Real cutoff) { return power_filter(1, cutoff); }
// σ/(σ² + μ), μ as a share of the mean diagonal of K: fixed damping, and SPRING's.
inline SpectralFilter tikhonov_filter(Real damping) {
  return {.kappa = 1, .damping = damping, .unit = SpectralFilter::Unit::mean};
}
// σ/(σ² + μ)^¾ for κ = ½, μ as a share of σ₁²: the half-inverse that decays where σ vanishes.
inline SpectralFilter decaying_filter(Real kappa, Real damping) {
  return {.kappa = kappa, .damping = damping};
}

}  // namespace isoline::optimizers
