// The eigenvalues of JJᵀ in two parts, and the step by both.
#include "optimizers/split_gram.h"

#include <algorithm>

#include "core/product.h"

namespace isoline::optimizers {
namespace {

// Of the cut-off: σ that can't be kept, however they are rounded. They are left out of S where what
// is of second order in ε σ₁²/σ², which turns them into those kept, is nothing.
constexpr Real kFarBelow = 0.01, kLeastCutoff = 3e-6;

}  // namespace

bool SplitGram::solve(LayeredJacobian& J, const SymmetricEigen& eigen, const SpectralFilter& filter,
                      const Spectrum& spectrum, const Vector& w, Vector& out) {
  const Index r = w.size();
  if (spectrum.largest == 0) {
    for (Vector* zero : {&sigma_, &along_, &out}) zero->setZero(r);
    return true;
  }
  const auto count_below = [&](Real share) {
    const Real bound = share * spectrum.largest, *lambda = eigen.lambda.data();
    return std::lower_bound(lambda, lambda + r, bound * bound) - lambda;
  };
  const Index n3 = filter.cutoff >= kLeastCutoff ? count_below(kFarBelow * filter.cutoff) : 0;
  const Index n2 = std::max(count_below(kSplit), n3) - n3, n1 = r - n3 - n2;
  const Eigen::Ref<const Matrix> V3 = eigen.V.leftCols(n3), V1 = eigen.V.rightCols(n1);
  V2_ = eigen.V.middleCols(n3, n2);
  J.pullback(V2_, Z_);
  small_.V.resize(n2, n2);
  lower_gram(Z_, small_.V);
  if (n2 > 0 && !symmetric_eigen(Matrix(small_.V), small_)) return false;
  sigma_ = eigen.lambda.cwiseMax(0).cwiseSqrt();
  if (n2 > 0) sigma_.segment(n3, n2) = small_.lambda.cwiseMax(0).cwiseSqrt();

  // a = Vᵀ w, and what first order adds to a₂.
  const Vector a = eigen.V.transpose() * w;
  const Vector lambda1 = eigen.lambda.tail(n1);
  pair_.resize(r, 2);
  pair_.col(0).noalias() = V1 * a.tail(n1).cwiseQuotient(lambda1);
  pair_.col(1).noalias() = V3 * a.head(n3);
  J.pullback(pair_, z_);
  Vector b = small_.V.transpose() * (a.segment(n3, n2) - Z_.transpose() * z_.col(0));
  Vector shift = small_.V.transpose() * (Z_.transpose() * z_.col(1));
  for (Index i = 0; i < n2; ++i) {
    const Real sigma = sigma_[n3 + i], h = filter.over_sigma(sigma, spectrum);
    const Real inverse = n3 > 0 && h > 0 ? 1 / (sigma * sigma) : 0;
    b[i] = h * (b[i] + inverse * shift[i]);
    shift[i] = inverse * b[i];
  }
  along_.setZero(r);
  along_.segment(n3, n2) = b.cwiseProduct(sigma_.segment(n3, n2));

  // And what it adds to a₁ and to V.
  const Vector of_small = small_.V * b;
  triple_.resize(Z_.rows(), 3);
  triple_.col(0).noalias() = Z_ * a.segment(n3, n2) + z_.col(1);
  triple_.col(1).noalias() = Z_ * of_small;
  triple_.col(2).noalias() = Z_ * (small_.V * shift);
  J.pushforward(triple_, Y_);
  Vector c = a.tail(n1) + (V1.transpose() * Y_.col(0)).cwiseQuotient(lambda1);
  for (Index i = 0; i < n1; ++i) c[i] *= filter.over_sigma(sigma_[r - n1 + i], spectrum);
  along_.tail(n1) = c.cwiseProduct(sigma_.tail(n1));
  c -= (V1.transpose() * Y_.col(1)).cwiseQuotient(lambda1);
  out.noalias() = V1 * c + V2_ * of_small + V3 * (V3.transpose() * Y_.col(2));
  return true;
}

}  // namespace isoline::optimizers
