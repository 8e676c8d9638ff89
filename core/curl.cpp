// Central differences, by periods.
#include "core/curl.h"

namespace isoline {

Vector curl(VectorRef velocity, Index rows, Index columns) {
  const Index cells = rows * columns;
  const Eigen::Map<const Matrix> u(velocity.data(), rows, columns);
  const Eigen::Map<const Matrix> v(velocity.data() + cells, rows, columns);
  Vector out(cells);
  for (Index j = 0; j < columns; ++j) {
    const Index above = (j + 1) % columns, below = (j + columns - 1) % columns;
    for (Index i = 0; i < rows; ++i) {
      const Index right = (i + 1) % rows, left = (i + rows - 1) % rows;
      out[i + rows * j] = 0.5 * (v(right, j) - v(left, j) - u(i, above) + u(i, below));
    }
  }
  return out;
}

}  // namespace isoline
