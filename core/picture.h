// What is shown of the first sample of a batch, one number a cell of a field.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "core/array.h"
#include "core/field.h"

namespace isoline {

// The curl of a velocity on a periodic grid, ∂v/∂i − ∂u/∂j by central differences, in units of a
// cell: u and v are the first and second half of `velocity`, column by column. (rows · columns)
Vector curl(VectorRef velocity, Index rows, Index columns);

// The states from x on, at even times, each a row of `states` (rows, columns).
using History = std::function<void(VectorRef x, BatchOut states)>;

// The sample itself, or its curl where it has two numbers a cell. Of a field that is a history all
// that follows from x; of y, of which no history is given, the last row alone, with 0 elsewhere.
// The batch outlives the picture.
class Picture {
 public:
  Picture(const Matrix& batch, const std::optional<Field>& field, const History& history = {});
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  std::span<const Real> cells() const { return cells_; }  // empty where there is no sample

 private:
  Vector drawn_;  // where it is more than the sample
  std::span<const Real> cells_;
};

}  // namespace isoline
