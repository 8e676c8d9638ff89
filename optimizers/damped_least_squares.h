// d = argmin ‖J d + r‖² + μ‖D d‖² for one J and many μ: Tikhonov's filter over the spectrum of
// JD⁻¹, which needs no spectrum. By QR of the augmented matrix (J; √μ D), which the normal
// equations' squared condition number would spoil; where J is wide, as the shortest (z, w) with
// JD⁻¹ z + √μ w = −r, d = D⁻¹ z, which is the same d. Where J is wide and large and μ far above
// rounding, by Cholesky of (JD⁻¹)(JD⁻¹)ᵀ + μ, of which the first term is formed once.
#pragma once

#include <string>

#include "core/archive.h"
#include "core/array.h"

namespace isoline::optimizers {

struct DampedLeastSquares {
  enum class Way { automatic, orthogonal, cholesky };

  void set(const Matrix& J, const Vector& minus_r, const Vector& D);
  // d and J d; false where they are not finite.
  bool solve(Real mu, Way way, Vector& d, Vector& Jd);
  Real misfit() const { return 0.5 * right.squaredNorm(); }  // ½‖r‖²
  void persist(Archive& archive) { archive(augmented, right, scale, rows); }

  Index rows = 0;    // m·B
  Matrix augmented;  // (m·B + n, n) with J on top, or (m·B, n + m·B) with JD⁻¹ left
  Vector right;      // −r, with n zeros below where J is not wide
  Vector scale;      // (n) D

 private:
  bool is_wide() const { return rows < scale.size(); }
  bool may_square(Real mu) const;
  bool by_cholesky(Real mu);

  Matrix gram_, damped_, column_;  // (m·B, m·B) twice, (m·B, 1)
  bool has_gram_ = false;
  Vector solved_;  // (z, w) or d
};

}  // namespace isoline::optimizers
