// What a physics offers unless it says otherwise.
#include "problems/physics.h"

namespace isoline::problems {

void Physics::jacobian(BatchOut J, Workspace& w) const {
  const Index k = inputs(), m = outputs(), samples = J.cols() / k;
  const bool by_column = k <= m;
  Matrix unit = Matrix::Zero(by_column ? k : m, samples), product(by_column ? m : k, samples);
  for (Index i = 0; i < unit.rows(); ++i) {
    unit.row(i).setOnes();
    by_column ? pushforward(unit, product, w) : pullback(unit, product, w);
    unit.row(i).setZero();
    for (Index b = 0; b < samples; ++b)
      if (by_column)
        J.col(b * k + i) = product.col(b);
      else
        J.block(i, b * k, 1, k) = product.col(b).transpose();
  }
}

void Physics::curvature(BatchRef, BatchOut, Workspace&) const {
  throw NotApplicable("the physics offers no second derivatives");
}

void Physics::curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const {
  const Index k = inputs();
  Matrix H(k, k * u.cols());
  curvature(u, H, w);
  for (Index b = 0; b < u.cols(); ++b) out.col(b).noalias() = H.middleCols(b * k, k) * v.col(b);
}

Success Physics::local_inverse(BatchRef y, BatchRef, BatchRef, BatchOut) const {
  return Success::Constant(y.cols(), false);
}

}  // namespace isoline::problems
