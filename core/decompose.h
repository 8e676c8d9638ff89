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

// σ alone, (r), descending; false: no convergence, or numbers that are not finite.
bool singular_values(const Matrix& A, Vector& sigma);

// The same of a tall A, kept as the factors by which it is found, for a few products with U and V
// instead of the matrices: A = Q R, R = X B Yᵀ with B bidiagonal, B = C diag(σ) Dᵀ; Chan (1982).
// U = Q X C and V = Y D.
class FactoredSvd {
 public:
  bool factor(const Matrix& A);                      // (m, n), m ≥ n ≥ 1; false: no convergence
  const Vector& sigma() const { return sigma_; }     // (n), descending
  void to_left(const Vector& x, Vector& out);        // Uᵀ x, (m) -> (n)
  void from_left(const Vector& along, Vector& out);  // U along, (n) -> (m)
  void to_right(const Vector& x, Vector& out);       // Vᵀ x, (n) -> (n)
  void from_right(const Vector& along, Vector& out);  // V along, (n) -> (n)

 private:
  Matrix qr_, blocks_, bidiagonal_, C_, Dt_;  // Q as LAPACK keeps it, in blocks of columns
  Vector tau_x_, tau_y_, sigma_, above_, column_;
};

struct SymmetricEigen {
  Matrix V;       // (n, n), one eigenvector per column
  Vector lambda;  // (n), ascending
};
bool symmetric_eigen(const Matrix& A,
                     SymmetricEigen& out);  // A = V diag(λ) Vᵀ; false: no convergence

// A = L Lᵀ, A (n, n) symmetric, its lower half alone read and overwritten by L; false where A is
// not positive definite. B ← (L Lᵀ)⁻¹ B, (n, r).
bool cholesky(Matrix& A);
bool solve_by_cholesky(const Matrix& L, Matrix& B);
inline bool solve_positive_definite(Matrix& A, Matrix& B) {
  return cholesky(A) && solve_by_cholesky(A, B);
}

// The same of a band matrix, its lower half by diagonals: band(d, j) = A(j + d, j), (bands, n).
bool cholesky_of_band(Matrix& band);
bool solve_by_cholesky_of_band(const Matrix& L, VectorOut b);

// x = A⁻¹ b by LU with partial pivoting, A (n, n); false when A is exactly singular.
bool solve_square(const Matrix& A, const Vector& b, Vector& x);

// x = argmin ‖A x − b‖, of least norm if A (m, n) is rank-deficient, by a complete orthogonal
// factorization; a column with a pivot below `relative_rank` of the first counts as dependent.
bool least_squares(const Matrix& A, const Vector& b, Real relative_rank, Vector& x);

}  // namespace isoline
