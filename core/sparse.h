// Sparse matrices with a fixed pattern: the pattern of a Jacobian, its products, and Cholesky
// factorizations by CHOLMOD.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/array.h"

namespace isoline {

// The positions of the values of a sparse J (m, n), by compressed rows: those of row i are
// row_start[i] … row_start[i + 1] − 1, and column[p] ascends within a row.
//
// J may consist of blocks: residual block i of the rows residual_block[i] … residual_block[i + 1] −
// 1 depends on some parameter blocks, j of the columns parameter_block[j] … parameter_block[j + 1]
// − 1, and has values for all their columns in all its rows. Blocks from `first_eliminated` on can
// be eliminated first, each on its own: no residual block depends on two of them.
struct SparsePattern {
  Index columns = 0;                                       // n
  std::vector<int> row_start = {0}, column = {};           // (m + 1), (values)
  std::vector<int> parameter_block, residual_block;        // the last entries are n and m
  int first_eliminated = std::numeric_limits<int>::max();  // of the parameter blocks

  Index rows() const { return static_cast<Index>(row_start.size()) - 1; }
  Index values() const { return static_cast<Index>(column.size()); }
  int parameter_blocks() const { return static_cast<int>(parameter_block.size()) - 1; }
  int residual_blocks() const { return static_cast<int>(residual_block.size()) - 1; }
  bool has_eliminated() const { return first_eliminated < parameter_blocks(); }
  Index widest_row() const;
  // The parameter blocks of a residual block, ascending: those of its first row.
  template <class Visit>  // (parameter block, its first place in a row)
  void for_each_block(int residual, Visit visit) const {
    const int first = row_start[at(residual_block[at(residual)])];
    const int end = row_start[at(residual_block[at(residual)] + 1)];
    for (int p = first; p < end;) {
      const int block = block_of(column[at(p)]);
      visit(block, p - first);
      p += size_of(block);
    }
  }
  int size_of(int block) const {
    return parameter_block[at(block + 1)] - parameter_block[at(block)];
  }
  // Why this is not the pattern of a J (m, n); empty if it is.
  std::string defect(Index m, Index n) const;

  // With the values of J: y = J x, x = Jᵀ y, the squared norms of its columns, and J itself.
  void multiply(const Real* values, VectorRef x, VectorOut y) const;
  void multiply_transposed(const Real* values, VectorRef y, VectorOut x) const;
  void squared_columns(const Real* values, VectorOut squares) const;
  void expand(const Real* values, BatchOut J) const;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int block_of(int column) const;  // that it lies in
};

// Where each block stands alone: a parameter and a residual each.
void set_single_blocks(SparsePattern& pattern);

// P (AAᵀ + μ) Pᵀ = L Lᵀ for A of compressed columns, or P S Pᵀ for the lower half of a symmetric S.
// The permutation P and the pattern of L are found once for each pattern.
class SparseCholesky {
 public:
  enum class Of { gram, symmetric };
  // The arrays outlive the factorization. `rows` of A or S.
  void analyse(Of of, Index rows, const std::vector<int>& start, const std::vector<int>& index);
  bool factor(const Real* values, Real mu);  // false: not positive definite in rounding
  bool solve(Vector& b);                     // b ← (L Lᵀ)⁻¹ b, (rows)

 private:
  struct Own;
  std::shared_ptr<Own> own_;
};

}  // namespace isoline
