// The five-point Laplacian by its stencil, its inverse by sine transform and elimination.
#include "problems/laplacian.h"

#include <cmath>
#include <numbers>

namespace isoline::problems {

Laplacian::Laplacian(Index N) : N_(N), sine_(N), pivots_(N, N) {
  for (Index p = 0; p < N; ++p) {
    const Real angle = std::numbers::pi * static_cast<Real>(p + 1) / static_cast<Real>(N + 1);
    const Real diagonal = 2 + 4 * std::pow(std::sin(angle / 2), 2);
    Real above = 0;
    for (Index j = 0; j < N; ++j) above = pivots_(p, j) = 1 / (diagonal - above);
  }
}

void Laplacian::apply(BatchRef y, BatchOut x) const {
  for (Index b = 0; b < y.cols(); ++b) {
    const Eigen::Map<const Matrix> Y(y.col(b).data(), N_, N_);
    Eigen::Map<Matrix> X(x.col(b).data(), N_, N_);
    X = -4 * Y;
    X.topRows(N_ - 1) += Y.bottomRows(N_ - 1);
    X.bottomRows(N_ - 1) += Y.topRows(N_ - 1);
    X.leftCols(N_ - 1) += Y.rightCols(N_ - 1);
    X.rightCols(N_ - 1) += Y.leftCols(N_ - 1);
  }
}

void Laplacian::solve(BatchRef x, BatchOut y) const {
  const Real scale = -1 / sine_.round_trip();
  for (Index b = 0; b < x.cols(); ++b) {
    const Eigen::Map<const Matrix> X(x.col(b).data(), N_, N_);
    Eigen::Map<Matrix> Y(y.col(b).data(), N_, N_);
    sine_.columns(X, Y);
    Y.col(0) = scale * Y.col(0).cwiseProduct(pivots_.col(0));
    for (Index j = 1; j < N_; ++j)
      Y.col(j) = (scale * Y.col(j) + Y.col(j - 1)).cwiseProduct(pivots_.col(j));
    for (Index j = N_ - 2; j >= 0; --j) Y.col(j) += Y.col(j + 1).cwiseProduct(pivots_.col(j));
    sine_.columns(Y, Y);
  }
}

}  // namespace isoline::problems
