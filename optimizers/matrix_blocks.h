// θ as the matrices that its layers multiply by, for the methods that treat a matrix as one: a
// dense layer's weights as they stand; a convolution's with one column for each channel that comes
// out, of which there are as many as biases after it; all else is a vector, of one column.
#pragma once

#include <vector>

#include "optimizers/meter.h"

namespace isoline::optimizers {

struct MatrixBlock {
  Index offset, rows, columns;
  bool is_matrix() const { return rows > 1 && columns > 1; }
  auto of(Vector& theta) const { return Eigen::Map<Matrix>(theta.data() + offset, rows, columns); }
};

inline std::vector<MatrixBlock> matrix_blocks(const std::vector<Block>& layout) {
  std::vector<MatrixBlock> all;
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const Block& block = layout[i];
    const Index size = block.rows * block.columns;
    const bool has_biases = i + 1 < layout.size() && layout[i + 1].kind == Block::Kind::bias;
    const Index outputs = has_biases ? layout[i + 1].rows : 1;
    if (block.kind == Block::Kind::weight)
      all.push_back({block.offset, block.rows, block.columns});
    else if (block.kind == Block::Kind::convolution && block.columns % outputs == 0)
      all.push_back({block.offset, size / outputs, outputs});
    else
      all.push_back({block.offset, size, 1});
  }
  return all;
}

}  // namespace isoline::optimizers
