// Products of sparse matrices, and their factorizations by CHOLMOD (Chen, Davis, Hager,
// Rajamanickam, 2008); the only adapter to it.
#include "core/sparse.h"

#include <fmt/format.h>
#include <suitesparse/cholmod.h>

#include <algorithm>

namespace isoline {

Index SparsePattern::widest_row() const {
  int widest = 0;
  for (std::size_t i = 0; i + 1 < row_start.size(); ++i)
    widest = std::max(widest, row_start[i + 1] - row_start[i]);
  return widest;
}

int SparsePattern::block_of(int of) const {
  return static_cast<int>(std::ranges::upper_bound(parameter_block, of) - parameter_block.begin()) -
         1;
}

std::string SparsePattern::defect(Index m, Index n) const {
  const auto covers = [](const std::vector<int>& starts, Index end) {
    return !starts.empty() && starts.front() == 0 && starts.back() == end &&
           std::ranges::is_sorted(starts);
  };
  const auto divides = [&](const std::vector<int>& starts, Index end) {  // without empty parts
    return covers(starts, end) && std::ranges::adjacent_find(starts) == starts.end();
  };
  if (rows() != m || columns != n || !covers(row_start, values()) || !divides(parameter_block, n) ||
      !divides(residual_block, m))
    return fmt::format(
        "its rows and blocks do not divide the values of a matrix of {} × {} in order", m, n);
  if (std::ranges::any_of(column, [&](int each) { return each < 0 || each >= n; }))
    return fmt::format("a column is not a number below {}", n);
  std::vector<int> expected;  // columns of a residual block's rows
  for (int i = 0; i < residual_blocks(); ++i) {
    expected.clear();
    int eliminated = 0;
    for_each_block(i, [&](int block, int) {
      for (int c = parameter_block[at(block)]; c < parameter_block[at(block + 1)]; ++c)
        expected.push_back(c);
      eliminated += block >= first_eliminated;
    });
    bool is_sound = eliminated <= 1 && std::ranges::is_sorted(expected);
    for (int row = residual_block[at(i)]; row < residual_block[at(i + 1)]; ++row)
      is_sound = is_sound &&
                 std::equal(expected.begin(), expected.end(), column.begin() + row_start[at(row)],
                            column.begin() + row_start[at(row + 1)]);
    if (!is_sound)
      return fmt::format(
          "the rows of residual block {} do not consist of the same whole parameter "
          "blocks, ascending, of which at most one is eliminated",
          i);
  }
  return "";
}

void SparsePattern::multiply(const Real* values, VectorRef x, VectorOut y) const {
  for (std::size_t i = 0; i + 1 < row_start.size(); ++i) {
    Real sum = 0;
    for (int p = row_start[i]; p < row_start[i + 1]; ++p) sum += values[p] * x[column[at(p)]];
    y[static_cast<Index>(i)] = sum;
  }
}

void SparsePattern::multiply_transposed(const Real* values, VectorRef y, VectorOut x) const {
  x.setZero();
  for (std::size_t i = 0; i + 1 < row_start.size(); ++i) {
    const Real factor = y[static_cast<Index>(i)];
    for (int p = row_start[i]; p < row_start[i + 1]; ++p) x[column[at(p)]] += values[p] * factor;
  }
}

void SparsePattern::squared_columns(const Real* values, VectorOut squares) const {
  squares.setZero();
  for (std::size_t p = 0; p < column.size(); ++p) squares[column[p]] += values[p] * values[p];
}

void SparsePattern::expand(const Real* values, BatchOut J) const {
  J.setZero();
  for (std::size_t i = 0; i + 1 < row_start.size(); ++i)
    for (int p = row_start[i]; p < row_start[i + 1]; ++p)
      J(static_cast<Index>(i), column[at(p)]) = values[p];
}

void set_single_blocks(SparsePattern& pattern) {
  pattern.parameter_block.resize(static_cast<std::size_t>(pattern.columns) + 1);
  pattern.residual_block.resize(pattern.row_start.size());
  for (std::vector<int>* blocks : {&pattern.parameter_block, &pattern.residual_block})
    for (std::size_t i = 0; i < blocks->size(); ++i) (*blocks)[i] = static_cast<int>(i);
}

// CHOLMOD's state, and a view of the arrays of A.
struct SparseCholesky::Own {
  Own() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;  // one ordering, so that every machine has the same
    common.method[0].ordering = CHOLMOD_AMD;
    common.postorder = 1;
    common.final_ll = 1;  // L Lᵀ, which fails where a pivot is not positive
    common.quick_return_if_not_posdef = 1;
  }
  Own(const Own&) = delete;
  Own& operator=(const Own&) = delete;
  ~Own() {
    cholmod_free_factor(&L, &common);
    for (cholmod_dense** each : {&X, &Y, &E}) cholmod_free_dense(each, &common);
    cholmod_finish(&common);
  }

  cholmod_common common{};
  cholmod_sparse A{};
  cholmod_factor* L = nullptr;
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  // of solutions, reused
};

void SparseCholesky::analyse(Of of, Index rows, const std::vector<int>& start,
                             const std::vector<int>& index) {
  own_ = std::make_shared<Own>();
  cholmod_sparse& A = own_->A;
  A.nrow = static_cast<std::size_t>(rows);
  A.ncol = start.size() - 1;
  A.nzmax = index.size();
  A.p = const_cast<int*>(start.data());  // it is only read
  A.i = const_cast<int*>(index.data());
  A.stype = of == Of::symmetric ? -1 : 0;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_PATTERN;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  own_->L = cholmod_analyze(&A, &own_->common);
  A.xtype = CHOLMOD_REAL;
}

bool SparseCholesky::factor(const Real* values, Real mu) {
  if (!own_->L) return false;
  own_->A.x = const_cast<Real*>(values);
  double beta[2] = {mu, 0};
  const bool is_done = cholmod_factorize_p(&own_->A, beta, nullptr, 0, own_->L, &own_->common) != 0;
  return is_done && own_->common.status == CHOLMOD_OK && own_->L->minor == own_->L->n;
}

bool SparseCholesky::solve(Vector& b) {
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = static_cast<std::size_t>(b.size());
  right.ncol = 1;
  right.x = b.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, own_->L, &right, nullptr, &own_->X, nullptr, &own_->Y, &own_->E,
                      &own_->common))
    return false;
  b = Eigen::Map<const Vector>(static_cast<const Real*>(own_->X->x), b.size());
  return is_finite(b);
}

}  // namespace isoline
