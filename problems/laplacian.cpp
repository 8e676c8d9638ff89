// The five-point Laplacian by its stencil, its inverse by the sine transform.
#include "problems/laplacian.h"

#include <cmath>
#include <numbers>

namespace isoline::problems {

Laplacian::Laplacian(Index N) : N_(N), sine_(N, N), gain_(N, N) {
  const auto s2 = [N](Index p) {
    const Real angle = std::numbers::pi * static_cast<Real>(p + 1) / static_cast<Real>(N + 1);
    return std::pow(std::sin(angle / 2), 2);
  };
  for (Index q = 0; q < N; ++q)
    for (Index p = 0; p < N; ++p) gain_(p, q) = -1 / (4 * (s2(p) + s2(q)) * sine_.round_trip());
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
  for (Index b = 0; b < x.cols(); ++b) {
    sine_.forward(x.col(b));
    sine_.spectrum().array() *= gain_.array();
    sine_.inverse(y.col(b));
  }
}

}  // namespace isoline::problems
