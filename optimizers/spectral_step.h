// V f(σ) Uᵀ w over the stacked Jacobian J = U diag(σ) Vᵀ of a batch: one step, and several ways to
// compute it.
#pragma once

#include <string>
#include <string_view>

#include "core/archive.h"
#include "core/decompose.h"
#include "optimizers/lanczos_step.h"
#include "optimizers/layered_jacobian.h"
#include "optimizers/meter.h"
#include "optimizers/spectral_filter.h"

namespace isoline::optimizers {

enum class Way {
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
Way way_named(std::string_view name);  // "auto", and each as it is called here

// The factorization used, in words: "the thin SVD of J".
std::string_view way_text(Way way);

// The choice of `automatic`. A Gram matrix squares the condition number. It is used if the
// estimated relative error of the step is at most 2e-9, and if the smallest σ that matters is at
// least 1e-5 of the largest (1e-7 if split in two). It is not tried if the cut-off is so near its
// rounding that this could not be detected.
inline constexpr Real kMostErrorByGram = 2e-9, kLeastShareByGram = 1e-5, kLeastShareBySplit = 1e-7;
inline constexpr Real kLeastCutoffByGram = 1e-7;

// For `automatic`: whether every spectrum excludes a Gram matrix.
bool never_by_gram(const SpectralFilter& filter);
// Whether one number is enough of a spectrum: Tikhonov's filter with μ in units of the mean.
bool is_tikhonov(const SpectralFilter& filter);

// The oracles that a method with a SpectralStep needs, by its factorization.
OracleSet needs_of(Way way, const SpectralFilter& filter, const Problem& problem);
// The reason why it cannot treat a problem; empty if it can.
std::string objection_to(Way way, const Problem& problem);

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
  explicit SpectralStep(Way wanted, const KrylovLimits& limits = {})
      : wanted_(wanted), limits_(limits) {}

  // out += factor · V f(σ) Uᵀ w at `at`, w (m·B), out (n). False, said to the meter, where J or w
  // is not finite or a factorization does not converge.
  bool add(Meter& f, Linearization& at, const SpectralFilter& filter, const Vector& w, Real factor,
           Vector& out);
  void start(Meter& f) const;  // names its series, where it has any
  // About the relative error of the last step, if by a Gram matrix of all eigenvalues.
  Real error_by_gram() const { return estimate_; }
  void persist(Archive& archive) { archive(was_too_small_, ways_taken_); }

 private:
  Way choose(const Meter& f, const SpectralFilter& filter, bool is_wide) const;
  bool by_svd(const Matrix& J, const SpectralFilter& filter, const Vector& w, Real factor,
              Vector& out);
  bool by_qr(const Matrix& J, const SpectralFilter& filter, const Vector& w, Real factor,
             Vector& out);
  bool by_pivots(const Matrix& J, const SpectralFilter& filter, const Vector& w, Real factor,
                 Vector& out);
  // By K = JJᵀ where J is wide, else by JᵀJ; too_small: to be done again by QR. `way` becomes
  // Way::split where it was automatic and is needed.
  enum class Outcome { done, failed, too_small };
  Outcome by_gram(Way& way, Meter& f, Linearization& at, const SpectralFilter& filter,
                  const Vector& w, Real factor, Vector& out);
  void form_gram(bool is_layered, bool is_wide, Linearization& at, const Vector& w);
  bool solve_filtered(const SpectralFilter& filter, bool is_wide, Real length);
  bool solve_damped(const SpectralFilter& filter);
  bool solve_split(const SpectralFilter& filter, const Vector& w);
  void judge(Way way, const SpectralFilter& filter, bool is_wide, Real length);
  void say(Meter& f, Way way);

  Way wanted_ = Way::automatic;
  KrylovLimits limits_;
  // Whether the last spectrum had values too small for a Gram matrix, split or not, so that the
  // next step is by QR at once.
  bool was_too_small_ = false;
  std::uint32_t ways_taken_ = 0;  // a bit each

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
