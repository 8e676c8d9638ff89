// V f(σ) Uᵀ w from products with J and Jᵀ alone: Golub-Kahan bidiagonalization, Golub, Kahan
// (1965), which is Lanczos' process on JᵀJ, or on JJᵀ where that is smaller, without squaring
// anything. With A S = T B for orthonormal S and T, B bidiagonal, and f(σ)/σ = h(σ²),
//   h(AᵀA) s₁ ≈ S h(BᵀB) e₁;
// Higham (2008), §13.2. S is kept and orthogonalized against itself, T is not (Simon, Zha, 2000).
#pragma once

#include "core/decompose.h"
#include "optimizers/meter.h"
#include "optimizers/spectral_filter.h"

namespace isoline::optimizers {

struct KrylovLimits {
  Real tolerance = 1e-3;  // on the estimated relative error of the step
  Index vectors = 300;    // most of them, and fewer where they would take more than 512 MiB
};

class LanczosStep {
 public:
  // out += factor · V f(σ) Uᵀ w, w (m·B), out (n); false where a product is not finite. Ends at the
  // tolerance, at the limits, or where the budget is spent; error() says how near it came.
  bool add(Meter& f, Linearization& at, const SpectralFilter& filter, const KrylovLimits& limits,
           const Vector& w, Real factor, Vector& out);
  Index vectors() const { return vectors_; }
  // ‖Δ − Δ'‖/‖Δ‖ against the step Δ' of two thirds of the vectors: about the error of Δ', which
  // that of Δ is below.
  Real error() const { return error_; }

 private:
  void start(Linearization& at, const Vector& w, Index most);
  bool extend(Linearization& at);  // by one vector; false where the space is exhausted
  void solve(const SpectralFilter& filter, Index size, Vector& out);
  Real distance(const Vector& coefficients) const;
  void forward(Linearization& at, VectorRef s, Vector& out);       // A s
  void backward(Linearization& at, const Vector& t, Vector& out);  // Aᵀ t

  bool is_over_parameters_ = false;  // A = J, else Jᵀ
  bool is_exhausted_ = false;        // no product leaves S
  Index vectors_ = 0, unknowns_ = 0;
  Real error_ = 0, length_ = 0;      // ‖s‖ of the vector that S starts with
  Matrix S_;                         // (r, most), r = min(m·B, n)
  std::vector<Real> alpha_, beta_;   // of B's diagonal and the one above it
  Vector t_, last_t_, s_, overlap_;  // (max(m·B, n)) twice, (r), (vectors)
  Vector solution_, earlier_;        // coefficients of the step in S
  Matrix cotangent_;                 // (m, B)
  Svd svd_;
};

}  // namespace isoline::optimizers
