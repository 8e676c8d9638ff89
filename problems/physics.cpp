// The default implementations of the interface Physics.
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

void Physics::curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const {
  const Index k = inputs();
  w.dense.resize(k, k * u.cols());
  curvature(u, w.dense, w);
  for (Index b = 0; b < u.cols(); ++b)
    out.col(b).noalias() = w.dense.middleCols(b * k, k) * v.col(b);
}

const Matrix& ByJacobian::saved_jacobian(Workspace& w) const {
  if (w.saved.size() < 2) w.saved.resize(2);
  Matrix& J = w.saved[0];
  if (w.saved_is_current) return J;
  J.setZero(outputs(), inputs() * w.x.cols());
  form_jacobian(J, w);
  w.saved_is_current = true;
  return J;
}

void ByJacobian::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  const Matrix& J = saved_jacobian(w);
  const Index k = v.rows();
  for (Index b = 0; b < v.cols(); ++b) Jv.col(b).noalias() = J.middleCols(b * k, k) * v.col(b);
}

void ByJacobian::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  const Matrix& J = saved_jacobian(w);
  const Index k = JTu.rows();
  for (Index b = 0; b < u.cols(); ++b)
    JTu.col(b).noalias() = J.middleCols(b * k, k).transpose() * u.col(b);
}

const Real* BySparseJacobian::saved_values(Workspace& w) const {
  if (w.saved.empty()) w.saved.resize(1);
  Matrix& values = w.saved[0];
  if (!w.saved_is_current) {
    values.resize(pattern_.values(), 1);
    sparse_jacobian(values.col(0), w);
    w.saved_is_current = true;
  }
  return values.data();
}

void BySparseJacobian::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  pattern_.multiply(saved_values(w), v.col(0), Jv.col(0));
}

void BySparseJacobian::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  pattern_.multiply_transposed(saved_values(w), u.col(0), JTu.col(0));
}

void BySparseJacobian::jacobian(BatchOut J, Workspace& w) const {
  pattern_.expand(saved_values(w), J);
}

}  // namespace isoline::problems
