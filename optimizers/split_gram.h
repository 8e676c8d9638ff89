// A spectral step by JJᵀ where its least singular values would be lost in it: K = JJᵀ is rounded by
// ε σ₁², and so are its eigenvalues. Its eigenvectors V₂ of small ones still span what they belong
// to, and Z₂ = Jᵀ V₂ is small: S = Z₂ᵀ Z₂ gives these eigenvalues again, rounded by ε (s σ₁)² where
// all of them have σ < s σ₁.
//
// V = (V₁ V₂ V₃), σ falling, V₃ being discarded and far below the cut-off, is off by what K was
// rounded by. The blocks Eᵢⱼ = Vᵢᵀ K Vⱼ, i ≠ j, which should be 0, tell by how much, and to first
// order, where eigenvalues lie far apart,
//   V₁ ← V₁ + (V₂ E₂₁ + V₃ E₃₁) Λ₁⁻¹,   V₂ ← V₂ − V₁ Λ₁⁻¹ E₁₂ + V₃ E₃₂ S⁻¹,
// of which only products with a vector are needed, by J and Jᵀ. What is left is of second order.
#pragma once

#include "core/decompose.h"
#include "optimizers/layered_jacobian.h"
#include "optimizers/spectral_filter.h"

namespace isoline::optimizers {

// s, a share of σ₁: large ones are off by ε/s² where small ones are off by ε s² σ₁²/σ².
inline constexpr Real kSplit = 4e-4;

class SplitGram {
 public:
  // out (m·B) with Jᵀ out = V f(σ) Uᵀ w. `eigen`: of the K of J, as it was rounded. False: no
  // convergence.
  bool solve(LayeredJacobian& J, const SymmetricEigen& eigen, const SpectralFilter& filter,
             const Spectrum& spectrum, const Vector& w, Vector& out);
  const Vector& sigma() const { return sigma_; }  // (m·B), ascending
  const Vector& along() const { return along_; }  // f(σ) Uᵀ w, (m·B)

 private:
  Matrix V2_, Z_;                 // (m·B, p), and Z₂ (n, p)
  SymmetricEigen small_;          // of S
  Matrix pair_, z_, triple_, Y_;  // a few columns of the space of y or θ
  Vector sigma_, along_;
};

}  // namespace isoline::optimizers
