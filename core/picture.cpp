// Samples as they are, curls by central differences, and histories.
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

Picture::Picture(const Matrix& batch, const std::optional<Field>& field, const History& history) {
  if (batch.size() == 0) return;
  cells_ = {batch.data(), static_cast<std::size_t>(batch.rows())};
  if (!field) return;
  const Index rows = field->rows, columns = field->columns;
  if (field->is_history()) {
    Matrix states = Matrix::Zero(rows, columns);
    if (history)
      history(batch.col(0), states);
    else
      states.row(rows - 1) = batch.col(0).transpose();
    drawn_ = states.reshaped();
  } else if (batch.rows() == 2 * rows * columns) {
    drawn_ = curl(batch.col(0), rows, columns);
  } else {
    return;
  }
  cells_ = {drawn_.data(), static_cast<std::size_t>(drawn_.size())};
}

}  // namespace isoline
