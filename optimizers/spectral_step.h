// V f(σ) Uᵀ w over the stacked Jacobian J = U diag(σ) Vᵀ of a batch: one step, and several ways to
// compute it.
#pragma once

#include "core/archive.h"
#include "core/decompose.h"
#include "optimizers/lanczos_step.h"
#include "optimizers/layered_jacobian.h"
#include "optimizers/meter.h"
#include "optimizers/spectral_filter.h"
#include "optimizers/split_gram.h"
#include "optimizers/way.h"

namespace isoline::optimizers {

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
