// Least squares under a diagonal damping, by orthogonal factorization or by Cholesky.
#include "optimizers/damped_least_squares.h"

#include <cmath>
#include <limits>

#include "core/decompose.h"
#include "core/product.h"

namespace isoline::optimizers {
namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

}  // namespace

// A parameter that has done nothing yet has no scale, and no step.
void DampedLeastSquares::set(const Matrix& J, const Vector& minus_r, const Vector& D) {
  const Index n = J.cols();
  rows = J.rows();
  scale = D;
  has_gram_ = false;
  if (is_wide() && augmented.rows() != rows)
    augmented.setZero(rows, n + rows);
  else if (!is_wide() && augmented.rows() != rows + n)
    augmented.setZero(rows + n, n);
  if (is_wide()) {
    for (Index j = 0; j < n; ++j) augmented.col(j) = J.col(j) / (scale[j] > 0 ? scale[j] : 1);
  } else {
    augmented.topRows(rows) = J;
  }
  if (right.size() != augmented.rows()) right.setZero(augmented.rows());
  right.head(rows) = minus_r;
}

bool DampedLeastSquares::solve(Real mu, Way way, Vector& d, Vector& Jd) {
  const Index n = scale.size();
  const Real root = std::sqrt(mu);
  const bool squares =
      is_wide() && (way == Way::cholesky || (way == Way::automatic && may_square(mu)));
  if (!is_wide()) {
    augmented.bottomRows(n).diagonal() = root * scale;
    if (!least_squares(augmented, right, kEpsilon, d)) return false;
    Jd.noalias() = augmented.topRows(rows) * d;
    return true;
  }
  augmented.rightCols(rows).diagonal().setConstant(root);
  if (!(squares ? by_cholesky(mu) : least_squares(augmented, right, kEpsilon, solved_)))
    return false;
  d = (scale.array() > 0).select(solved_.head(n).cwiseQuotient(scale), 0);
  Jd.noalias() = augmented.leftCols(n) * solved_.head(n);
  return true;
}

// Large enough to be worth it, and μ at least 1e-10 of a bound on the largest σ².
bool DampedLeastSquares::may_square(Real mu) const {
  constexpr Index kLeastRows = 64;
  constexpr Real kLeastShare = 1e-10;
  return rows >= kLeastRows && mu >= kLeastShare * augmented.leftCols(scale.size()).squaredNorm();
}

bool DampedLeastSquares::by_cholesky(Real mu) {
  const Eigen::Ref<const Matrix> A = augmented.leftCols(scale.size());
  if (!has_gram_) {
    gram_.resize(rows, rows);
    product(Form::A_BH, A, A, gram_);
    has_gram_ = true;
  }
  damped_ = gram_;
  damped_.diagonal().array() += mu;
  column_ = right;
  if (!solve_positive_definite(damped_, column_)) return false;
  solved_.noalias() = A.transpose() * column_.col(0);
  return true;
}

}  // namespace isoline::optimizers
