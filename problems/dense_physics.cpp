// Small physics, one sample at a time, from value and derivative.
#include "problems/dense_physics.h"

#include <cmath>

namespace isoline::problems {

void DensePhysics::forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const {
  for (Index b = 0; b < x.cols(); ++b) value(x.col(b), y.col(b));
}

void DensePhysics::curvature(BatchRef u, BatchOut out, Workspace& w) const {
  out.setZero();
  for (Index b = 0; b < u.cols(); ++b)
    second(w.x.col(b), u.col(b), out.middleCols(b * inputs_, inputs_));
}

void DensePhysics::curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const {
  if (w.saved.size() < 2) w.saved.resize(2);
  Matrix& H = w.saved[1];  // (k, k), of one sample
  for (Index b = 0; b < u.cols(); ++b) {
    H.setZero(inputs_, inputs_);
    second(w.x.col(b), u.col(b), H);
    out.col(b).noalias() = H * v.col(b);
  }
}

Success DensePhysics::local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const {
  Success success(y.cols());
  for (Index b = 0; b < y.cols(); ++b) success[b] = invert(y.col(b), x0.col(b), x.col(b));
  return success;
}

Real distance_to_nearest(BatchRef x, const Matrix& minimizers) {
  return std::sqrt((minimizers.colwise() - x.col(0)).colwise().squaredNorm().minCoeff());
}

ProblemParts classical(std::unique_ptr<Physics> f, const Vector& start, const Draw& draw,
                       Real minimum, const Matrix& minimizers) {
  const Vector target = Vector::Zero(f->outputs());
  return {.physics = std::move(f),
          .start = draw.start(start),
          .target = target,
          .minimum = minimum,
          .truth = minimizers.leftCols(1),
          .x_error = [minimizers](BatchRef x, const Batch&) {
            return distance_to_nearest(x, minimizers);
          }};
}

}  // namespace isoline::problems
