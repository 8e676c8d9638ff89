// Matrix factorizations, by LAPACK. Compiled once; shapes as in the field's books.
#pragma once

#include "core/array.h"

namespace isoline {

struct Svd {
  Matrix U;      // (m, r), r = min(m, n)
  Vector sigma;  // (r), descending
  Matrix Vt;     // (r, n)
};
bool thin_svd(const Matrix& A, Svd& out);  // A = U diag(σ) Vᵀ, A (m, n); false: no convergence

struct SymmetricEigen {
  Matrix V;       // (n, n), one eigenvector a column
  Vector lambda;  // (n), ascending
};
bool symmetric_eigen(const Matrix& A,
                     SymmetricEigen& out);  // A = V diag(λ) Vᵀ; false: no convergence

// B ← A⁻¹ B by Cholesky, A (n, n) symmetric and overwritten, its lower half alone read, B (n, r);
// false where A is not positive definite.
bool solve_positive_definite(Matrix& A, Matrix& B);

// x = A⁻¹ b by LU with partial pivoting, A (n, n); false when A is exactly singular.
bool solve_square(const Matrix& A, const Vector& b, Vector& x);

// x = argmin ‖A x − b‖, of least norm where A (m, n) lacks rank, by a complete orthogonal
// factorization; a column whose pivot is below `relative_rank` of the first is taken as dependent.
bool least_squares(const Matrix& A, const Vector& b, Real relative_rank, Vector& x);

}  // namespace isoline
