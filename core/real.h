// Numbers and their places.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace isoline {

using Real = double;
using Index = std::ptrdiff_t;  // Eigen's

// Numbers in columns, for files that keep and show arrays and need no algebra of them.
class Grid {
 public:
  Grid() = default;
  Grid(Index rows, Index columns)
      : Grid(rows, columns, std::vector<Real>(static_cast<std::size_t>(rows * columns))) {}
  // As many values as rows · columns, column by column.
  Grid(Index rows, Index columns, std::vector<Real> values)
      : rows_(rows), columns_(columns), values_(std::move(values)) {}

  Index rows() const { return rows_; }
  Index columns() const { return columns_; }
  bool is_empty() const { return values_.empty(); }
  Real& operator()(Index i, Index j) { return values_[static_cast<std::size_t>(j * rows_ + i)]; }
  Real operator()(Index i, Index j) const {
    return values_[static_cast<std::size_t>(j * rows_ + i)];
  }
  const std::vector<Real>& values() const { return values_; }  // column by column
  std::span<const Real> column(Index j) const {
    return std::span(values_).subspan(static_cast<std::size_t>(j * rows_),
                                      static_cast<std::size_t>(rows_));
  }

 private:
  Index rows_ = 0, columns_ = 0;
  std::vector<Real> values_;
};

}  // namespace isoline
