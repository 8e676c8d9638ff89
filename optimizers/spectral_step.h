// V f(σ) Uᵀ w over the stacked Jacobian J = U diag(σ) Vᵀ of a batch: one step, and several
// factorizations to compute it.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/archive.h"
#include "core/decompose.h"
#include "optimizers/layered_jacobian.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

// The filter of the singular values of J = U diag(σ) Vᵀ: every spectral method steps by
// Δθ = −η V f(σ) Uᵀ g, and every f here is one formula,
//
//   f(σ) = σ (σ² + μ)^(−(κ+1)/2)  where σ > τ σ₁,  else 0,
//
// Hansen (1998), chapter 4, for κ = 1: Tikhonov with μ, the truncated inverse without.

// The reference of a filter.
struct Spectrum {
  Real largest = 0;      // σ₁
  Real mean_square = 0;  // the mean diagonal of K = JJᵀ, which is ‖J‖²/(m·B)
};

struct SpectralFilter {
  enum class Unit { largest, mean, absolute };  // of μ: σ₁², the mean diagonal of K, or 1

  Real kappa;           // κ
  Real cutoff = 0;      // τ
  bool clamps = false;  // of σ > 0 those up to the cut-off count as it, instead of nothing
  Real damping = 0;     // μ, in its unit
  Unit unit = Unit::largest;

  Real mu(const Spectrum& of) const {
    if (unit == Unit::absolute) return damping;
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

 private:
  Real power(Real sigma, const Spectrum& of, Real exponent) const {
    if (clamps && sigma > 0) return std::pow(std::max(sigma, cutoff * of.largest), -exponent);
    return sigma > cutoff * of.largest ? std::pow(sigma, -exponent) : 0;
  }
};

// σ^(−κ), discarded up to the cut-off: truncated Gauss-Newton for κ = 1.
inline SpectralFilter power_filter(Real kappa, Real cutoff) {
  return {.kappa = kappa, .cutoff = cutoff};
}
// σ/(σ² + μ), μ as a share of the mean diagonal of K: fixed damping, and SPRING's.
inline SpectralFilter tikhonov_filter(Real damping) {
  return {.kappa = 1, .damping = damping, .unit = SpectralFilter::Unit::mean};
}
// The same with μ in units of the K of r = (y − y*)/√B, which is JJᵀ/B.
inline SpectralFilter absolute_filter(Real damping, Index samples) {
  return {.kappa = 1,
          .damping = damping * static_cast<Real>(samples),
          .unit = SpectralFilter::Unit::absolute};
}
// σ/(σ² + μ)^¾ for κ = ½, μ as a share of σ₁²: the half-inverse that decays where σ vanishes.
inline SpectralFilter decaying_filter(Real kappa, Real damping) {
  return {.kappa = kappa, .damping = damping};
}

// V f(σ) Uᵀ w from products with J and Jᵀ alone: Golub-Kahan bidiagonalization, Golub, Kahan
// (1965), which is Lanczos' process on JᵀJ, or on JJᵀ where that is smaller, without squaring
// anything. With A S = T B for orthonormal S and T, B bidiagonal, and f(σ)/σ = h(σ²),
//   h(AᵀA) s₁ ≈ S h(BᵀB) e₁;
// Higham (2008), §13.2. S is kept and orthogonalized against itself, T is not (Simon, Zha, 2000).

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
  void apply(Linearization& at, bool pushes, VectorRef v, Vector& out);

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

enum class Factorization {
  automatic,
  svd,       // thin SVD of J, the reference
  qr,        // Jᵀ = QR, or J = QR where it is tall, and the SVD of R, without forming U and V
  gram,      // eigenvalues of the smaller Gram matrix, from J
  layers,    // eigenvalues of K = JJᵀ formed layer by layer, and one pullback
  split,     // the same, the small ones again from the part of J that belongs to them
  cholesky,  // of Tikhonov alone: (K + μ)⁻¹ or (JᵀJ + μ)⁻¹, which need no spectrum
  orthogonal,  // of 1/σ alone: J⁺ by a complete orthogonal factorization, the cut-off on its pivots
  lanczos,     // products with J and Jᵀ alone
};
Factorization factorization_named(std::string_view name);  // "auto", and each as it is called here

// The factorization used, in words: "the thin SVD of J".
std::string_view factorization_text(Factorization factorization);

// The length η of a step Δ with the lowest loss L(θ + η Δ) on the samples of this step, of η = rate
// · 2^(−k), k = 0 … 30; Müller, Zeinhofer (2023), section 4. 0 where no loss is finite.
// `candidate` is scratch.
Real length_on_grid(Meter& f, const Vector& theta, const Vector& step, Real rate,
                    Vector& candidate);

// The oracles that a method with a SpectralStep needs, by its factorization.
OracleSet needs_of(Factorization factorization, const SpectralFilter& filter,
                   const Problem& problem);
// The reason why it cannot treat a problem; empty if it can.
std::string objection_to(Factorization factorization, const Problem& problem);

// A spectral step by JJᵀ that recovers its smallest singular values: K = JJᵀ is rounded by ε σ₁²,
// and so are its eigenvalues. The eigenvectors V₂ of the small ones still span the right subspace,
// and Z₂ = Jᵀ V₂ is small: S = Z₂ᵀ Z₂ gives these eigenvalues again, rounded by ε (s σ₁)² if all of
// them have σ < s σ₁.
//
// V = (V₁ V₂ V₃), σ falling, V₃ discarded and far below the cut-off, has the error of the rounding
// of K. The blocks Eᵢⱼ = Vᵢᵀ K Vⱼ, i ≠ j, should be 0. They give the error to first order, if the
// eigenvalues are well separated,
//   V₁ ← V₁ + (V₂ E₂₁ + V₃ E₃₁) Λ₁⁻¹,   V₂ ← V₂ − V₁ Λ₁⁻¹ E₁₂ + V₃ E₃₂ S⁻¹,
// which needs only products of J and Jᵀ with a vector. The remaining error is of second order.

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

class SpectralStep {
 public:
  SpectralStep() = default;
  explicit SpectralStep(Factorization wanted, const KrylovLimits& limits = {})
      : wanted_(wanted), limits_(limits) {}

  // out += factor · V f(σ) Uᵀ w at `at`, w (m·B), out (n). False, said to the meter, where J or w
  // is not finite or a factorization does not converge.
  bool add(Meter& f, Linearization& at, const SpectralFilter& filter, const Vector& w, Real factor,
           Vector& out);
  void start(Meter& f) const;  // names its series, where it has any
  // About the relative error of the last step, if by a Gram matrix of all eigenvalues.
  Real error_by_gram() const { return estimate_; }
  void persist(Archive& archive) { archive(was_too_small_, factorizations_used_); }

 private:
  bool by_svd(const Matrix& J, const SpectralFilter& filter, const Vector& w, Real factor,
              Vector& out);
  bool by_qr(const Matrix& J, const SpectralFilter& filter, const Vector& w, Real factor,
             Vector& out);
  // By K = JJᵀ where J is wide, else by JᵀJ; too_small: to be done again by QR. `factorization`
  // becomes Factorization::split where it was automatic and is needed.
  enum class Outcome { done, failed, too_small };
  Outcome by_gram(Factorization& factorization, Meter& f, Linearization& at,
                  const SpectralFilter& filter, const Vector& w, Real factor, Vector& out);
  void form_gram(bool is_layered, bool is_wide, Linearization& at, const Vector& w);
  bool solve_filtered(const SpectralFilter& filter, bool is_wide, Real length);
  bool solve_damped(const SpectralFilter& filter);
  void judge(Factorization factorization, const SpectralFilter& filter, bool is_wide, Real length);

  Factorization wanted_ = Factorization::automatic;
  KrylovLimits limits_;
  // Whether the last spectrum had values too small for a Gram matrix, split or not, so that the
  // next step is by QR at once.
  bool was_too_small_ = false;
  std::uint32_t factorizations_used_ = 0;  // a bit each

  // All else is scratch, r = min(m·B, n).
  Svd svd_;
  FactoredSvd factored_;
  LayeredJacobian layered_;
  SymmetricEigen eigen_;
  SplitGram split_;
  LanczosStep lanczos_;
  Spectrum spectrum_;
  Matrix gram_, column_, tall_;    // (r, r), (r, 1), and Jᵀ (n, m·B)
  Vector right_;                   // w, or Jᵀ w
  Vector sigma_, along_, result_;  // (r), in the singular basis (r), and back
  Real estimate_ = 0;              // of the relative error by a Gram matrix
  Matrix cotangent_;               // (m, B)
  Vector gradient_;                // (n)
};

}  // namespace isoline::optimizers
