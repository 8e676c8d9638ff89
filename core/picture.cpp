// Samples as they are, and curls by central differences.
#include "core/picture.h"

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

Picture::Picture(const Matrix& batch, const std::optional<Field>& field) {
  if (batch.size() == 0) return;
  const bool is_velocity = field && batch.rows() == 2 * field->rows * field->columns;
  if (is_velocity) curl_ = curl(batch.col(0), field->rows, field->columns);
  const Real* first = is_velocity ? curl_.data() : batch.data();
  cells_ = {first, static_cast<std::size_t>(is_velocity ? curl_.size() : batch.rows())};
}

}  // namespace isoline
