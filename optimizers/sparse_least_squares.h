// Damped linear least squares for a sparse J whose pattern is fixed: by Cholesky factorization of
// AᵀA + μ, A = J D⁻¹, or of its Schur complement where blocks can be eliminated.
#pragma once

#include <memory>

#include "core/archive.h"
#include "core/sparse.h"

namespace isoline::optimizers {

class BlockSchur;

// s = argmin ‖A s − b‖² + μ‖s‖².
class SparseLeastSquares {
 public:
  void start(const SparsePattern& pattern);           // which outlives this
  void set(const Vector& values, VectorRef inverse);  // A = J D⁻¹, inverse (n) = D⁻¹
  // s and A s; false where they are not finite. What squaring A costs in digits is given back by
  // corrections, each from the residual by A itself; Björck (1996), section 6.6.5. Where AᵀA + μ is
  // not positive definite in rounding, a greater μ is factorized, and the corrections are those of
  // iterated regularization, which converge where A has evidence.
  bool solve(Real mu, VectorRef b, Vector& s, Vector& As);
  void persist(Archive& archive) { archive(scaled_); }

 private:
  bool factor(Real mu);
  bool apply(Vector& g);  // g ← (AᵀA + μ)⁻¹ g

  const SparsePattern* pattern_ = nullptr;
  std::shared_ptr<BlockSchur> schur_;  // where blocks can be eliminated
  SparseCholesky whole_;               // else
  Vector scaled_;                      // the values of A
  Real factored_ = -1;                 // the μ of the last factorization; negative: none
  Vector rest_, correction_;           // (m), (n)
};

}  // namespace isoline::optimizers
