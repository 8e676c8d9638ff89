// Factorizations by LAPACKE; the only adapter to it.
#include "core/decompose.h"

#include <lapacke.h>

#include <algorithm>
#include <limits>

namespace isoline {
namespace {

lapack_int as_int(Index n) { return static_cast<lapack_int>(n); }

constexpr lapack_int kBlock = 64;  // columns of a QR that are applied at once

// A product that LAPACK refuses is not a number: it must not pass for the factor left out.
void keep(lapack_int info, Vector& product) {
  if (info != 0) product.setConstant(std::numeric_limits<Real>::quiet_NaN());
}

}  // namespace

bool thin_svd(const Matrix& A, Svd& out) {
  const Index m = A.rows(), n = A.cols(), r = std::min(m, n);
  if (r == 0 || !is_finite(A)) return false;
  out.U.resize(m, r);
  out.sigma.resize(r);
  out.Vt.resize(r, n);
  Matrix scratch = A;
  if (LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', as_int(m), as_int(n), scratch.data(), as_int(m),
                     out.sigma.data(), out.U.data(), as_int(m), out.Vt.data(), as_int(r)) == 0)
    return true;
  scratch = A;  // the divide-and-conquer form fails now and then where QR iteration does not
  Vector superdiagonal(r);
  return LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'S', 'S', as_int(m), as_int(n), scratch.data(), as_int(m),
                        out.sigma.data(), out.U.data(), as_int(m), out.Vt.data(), as_int(r),
                        superdiagonal.data()) == 0;
}

bool singular_values(const Matrix& A, Vector& sigma) {
  const lapack_int m = as_int(A.rows()), n = as_int(A.cols()), r = std::min(m, n);
  if (r == 0 || !is_finite(A)) return false;
  sigma.resize(r);
  Matrix scratch = A;
  double nothing = 0;
  return LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'N', m, n, scratch.data(), m, sigma.data(), &nothing, 1,
                        &nothing, 1) == 0;
}

bool FactoredSvd::factor(const Matrix& A) {
  const lapack_int m = as_int(A.rows()), n = as_int(A.cols());
  if (n == 0 || !is_finite(A)) return false;
  qr_ = A;
  for (Vector* vector : {&tau_x_, &tau_y_, &sigma_, &above_}) vector->setZero(n);
  const lapack_int block = std::min(n, kBlock);
  blocks_.setZero(block, n);  // LAPACK leaves parts of it, and refuses what is not a number there
  if (LAPACKE_dgeqrt(LAPACK_COL_MAJOR, m, n, block, qr_.data(), m, blocks_.data(), block) != 0)
    return false;
  bidiagonal_ = qr_.topRows(n).triangularView<Eigen::Upper>();
  if (LAPACKE_dgebrd(LAPACK_COL_MAJOR, n, n, bidiagonal_.data(), n, sigma_.data(), above_.data(),
                     tau_x_.data(), tau_y_.data()) != 0)
    return false;
  C_.resize(n, n);
  Dt_.resize(n, n);
  return LAPACKE_dbdsdc(LAPACK_COL_MAJOR, 'U', 'I', n, sigma_.data(), above_.data(), C_.data(), n,
                        Dt_.data(), n, nullptr, nullptr) == 0;
}

void FactoredSvd::to_left(const Vector& x, Vector& out) {
  const lapack_int m = as_int(qr_.rows()), n = as_int(qr_.cols());
  const lapack_int block = as_int(blocks_.rows());
  column_ = x;
  keep(LAPACKE_dgemqrt(LAPACK_COL_MAJOR, 'L', 'T', m, 1, n, block, qr_.data(), m, blocks_.data(),
                       block, column_.data(), m),
       column_);
  keep(LAPACKE_dormbr(LAPACK_COL_MAJOR, 'Q', 'L', 'T', n, 1, n, bidiagonal_.data(), n,
                      tau_x_.data(), column_.data(), m),
       column_);
  out.noalias() = C_.transpose() * column_.head(n);
}

void FactoredSvd::from_left(const Vector& along, Vector& out) {
  const lapack_int m = as_int(qr_.rows()), n = as_int(qr_.cols());
  const lapack_int block = as_int(blocks_.rows());
  out.setZero(m);
  out.head(n).noalias() = C_ * along;
  keep(LAPACKE_dormbr(LAPACK_COL_MAJOR, 'Q', 'L', 'N', n, 1, n, bidiagonal_.data(), n,
                      tau_x_.data(), out.data(), m),
       out);
  keep(LAPACKE_dgemqrt(LAPACK_COL_MAJOR, 'L', 'N', m, 1, n, block, qr_.data(), m, blocks_.data(),
                       block, out.data(), m),
       out);
}

void FactoredSvd::to_right(const Vector& x, Vector& out) {
  const lapack_int n = as_int(qr_.cols());
  column_ = x;
  keep(LAPACKE_dormbr(LAPACK_COL_MAJOR, 'P', 'L', 'T', n, 1, n, bidiagonal_.data(), n,
                      tau_y_.data(), column_.data(), n),
       column_);
  out.noalias() = Dt_ * column_;
}

void FactoredSvd::from_right(const Vector& along, Vector& out) {
  const lapack_int n = as_int(qr_.cols());
  out.noalias() = Dt_.transpose() * along;
  keep(LAPACKE_dormbr(LAPACK_COL_MAJOR, 'P', 'L', 'N', n, 1, n, bidiagonal_.data(), n,
                      tau_y_.data(), out.data(), n),
       out);
}

bool symmetric_eigen(const Matrix& A, SymmetricEigen& out) {
  if (!is_finite(A)) return false;
  out.V = A;
  out.lambda.resize(A.rows());
  return LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', as_int(A.rows()), out.V.data(),
                        as_int(A.rows()), out.lambda.data()) == 0;
}

bool cholesky(Matrix& A) {
  const lapack_int n = as_int(A.rows());
  return is_finite(A) && LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, A.data(), n) == 0;
}

bool solve_by_cholesky(const Matrix& L, Matrix& B) {
  const lapack_int n = as_int(L.rows());
  return is_finite(B) && LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', n, as_int(B.cols()), L.data(), n,
                                        B.data(), as_int(B.rows())) == 0;
}

bool cholesky_of_band(Matrix& band) {
  const lapack_int bands = as_int(band.rows()), n = as_int(band.cols());
  return is_finite(band) &&
         LAPACKE_dpbtrf(LAPACK_COL_MAJOR, 'L', n, bands - 1, band.data(), bands) == 0;
}

bool solve_by_cholesky_of_band(const Matrix& L, VectorOut b) {
  const lapack_int bands = as_int(L.rows()), n = as_int(L.cols());
  return LAPACKE_dpbtrs(LAPACK_COL_MAJOR, 'L', n, bands - 1, 1, L.data(), bands, b.data(), n) == 0;
}

bool solve_square(const Matrix& A, const Vector& b, Vector& x) {
  if (!is_finite(A) || !is_finite(b)) return false;
  Matrix lu = A;
  Eigen::Matrix<lapack_int, Eigen::Dynamic, 1> pivots(A.rows());
  x = b;
  return LAPACKE_dgesv(LAPACK_COL_MAJOR, as_int(A.rows()), 1, lu.data(), as_int(A.rows()),
                       pivots.data(), x.data(), as_int(A.rows())) == 0;
}

bool least_squares(const Matrix& A, const Vector& b, Real relative_rank, Vector& x) {
  if (!is_finite(A) || !is_finite(b)) return false;
  const Index m = A.rows(), n = A.cols(), rows = std::max(m, n);
  Matrix factored = A;
  Vector right = Vector::Zero(rows);
  right.head(m) = b;
  Eigen::Matrix<lapack_int, Eigen::Dynamic, 1> pivots =
      Eigen::Matrix<lapack_int, Eigen::Dynamic, 1>::Zero(n);
  lapack_int rank = 0;
  const bool solved =
      LAPACKE_dgelsy(LAPACK_COL_MAJOR, as_int(m), as_int(n), 1, factored.data(), as_int(m),
                     right.data(), as_int(rows), pivots.data(), relative_rank, &rank) == 0;
  x = right.head(n);
  return solved;
}

}  // namespace isoline
