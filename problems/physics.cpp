// The defaults of a physics.
#include "problems/physics.h"

namespace isoline::problems {

void Physics::jacobian(BatchOut J, Workspace& w) const {
  const Index k = inputs(), m = outputs(), samples = J.cols() / k;
  const Products has = products();
  const bool is_cheaper_by_column = k * has.pushforward_price <= m * has.pullback_price;
  const bool by_column = has.has_pushforward && (is_cheaper_by_column || !has.has_pullback);
  w.unit.setZero(by_column ? k : m, samples);
  w.product.resize(by_column ? m : k, samples);
  for (Index i = 0; i < w.unit.rows(); ++i) {
    w.unit.row(i).setOnes();
    by_column ? pushforward(w.unit, w.product, w) : pullback(w.unit, w.product, w);
    w.unit.row(i).setZero();
    for (Index b = 0; b < samples; ++b)
      if (by_column)
        J.col(b * k + i) = w.product.col(b);
      else
        J.block(i, b * k, 1, k) = w.product.col(b).transpose();
  }
}

void Physics::curvature(BatchRef, BatchOut, Workspace&) const {
  throw NotApplicable("the physics offers no second derivatives");
}

void Physics::curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const {
  const Index k = inputs();
  w.dense.resize(k, k * u.cols());
  curvature(u, w.dense, w);
  for (Index b = 0; b < u.cols(); ++b)
    out.col(b).noalias() = w.dense.middleCols(b * k, k) * v.col(b);
}

Success Physics::local_inverse(BatchRef y, BatchRef, BatchRef, BatchOut) const {
  return Success::Constant(y.cols(), false);
}

void multiply_samples(const Matrix& J, BatchRef v, BatchOut Jv) {
  const Index k = v.rows();
  for (Index b = 0; b < v.cols(); ++b) Jv.col(b).noalias() = J.middleCols(b * k, k) * v.col(b);
}

void multiply_samples_transposed(const Matrix& J, BatchRef u, BatchOut JTu) {
  const Index k = JTu.rows();
  for (Index b = 0; b < u.cols(); ++b)
    JTu.col(b).noalias() = J.middleCols(b * k, k).transpose() * u.col(b);
}

}  // namespace isoline::problems
