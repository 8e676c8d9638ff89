// What the problems of Moré, Garbow and Hillstrom (1981) share.
#include "problems/classical.h"

#include <cmath>

namespace isoline::problems {

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
