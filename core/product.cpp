// Products of dense matrices: by OpenBLAS, and row by row.
#include "core/product.h"

#include <cblas.h>

#include <algorithm>

#include "core/errors.h"
#include "core/threads.h"

namespace isoline {
namespace {

void gemm(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, int m, int n, int k, const float* A, int lda,
          const float* B, int ldb, float keep, float* C, int ldc) {
  cblas_sgemm(CblasColMajor, a, b, m, n, k, 1, A, lda, B, ldb, keep, C, ldc);
}

void gemm(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, int m, int n, int k, const double* A, int lda,
          const double* B, int ldb, double keep, double* C, int ldc) {
  cblas_dgemm(CblasColMajor, a, b, m, n, k, 1, A, lda, B, ldb, keep, C, ldc);
}

void gemm(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, int m, int n, int k, const Complex* A, int lda,
          const Complex* B, int ldb, Complex keep, Complex* C, int ldc) {
  const Complex one = 1;
  cblas_cgemm(CblasColMajor, a, b, m, n, k, &one, A, lda, B, ldb, &keep, C, ldc);
}

void require_fit(bool do_fit) {  // `require` would build its text each time
  if (!do_fit) throw UsageError("the shapes of the matrices of a product do not match");
}

int as_int(Index n) { return static_cast<int>(n); }

template <class Array>
int stride(const Array& array) {  // BLAS requires at least one, also for an empty matrix
  return std::max(1, as_int(array.outerStride()));
}

// By sizes alone, so one number of threads gives one result. With fewer multiply-adds, half a
// millisecond on one core, waking and awaiting other threads costs more than it saves.
bool is_worth_sharing(Index m, Index n, Index k) {
  constexpr Real kLeast = 2e7;
  return static_cast<Real>(m) * static_cast<Real>(n) * static_cast<Real>(k) >= kLeast;
}

template <class Scalar>
void multiply(Form form, typename Gemm<Scalar>::In A, typename Gemm<Scalar>::In B,
              typename Gemm<Scalar>::Out C, Scalar keep) {
  const auto flag = [](bool is_adjoint) { return is_adjoint ? CblasConjTrans : CblasNoTrans; };
  const bool left = form == Form::AH_B, right = form == Form::A_BH;
  const Index m = left ? A.cols() : A.rows(), k = left ? A.rows() : A.cols();
  const Index n = right ? B.rows() : B.cols();
  require_fit(C.rows() == m && C.cols() == n && k == (right ? B.cols() : B.rows()));
  const int threads = openblas_get_num_threads();
  const bool is_alone = threads > 1 && !is_worth_sharing(m, n, k);
  if (is_alone) openblas_set_num_threads(1);
  gemm(flag(left), flag(right), as_int(m), as_int(n), as_int(k), A.data(), stride(A), B.data(),
       stride(B), keep, C.data(), stride(C));
  if (is_alone) openblas_set_num_threads(threads);
}

// Vectors of the compiler, as they lie in memory: at any address of a number.
template <class Scalar>
struct RegisterOf;
template <>
struct RegisterOf<float> {
  using Type = float __attribute__((vector_size(kRegisterBytes), aligned(4), may_alias));
};
template <>
struct RegisterOf<double> {
  using Type = double __attribute__((vector_size(kRegisterBytes), aligned(8), may_alias));
};
template <class Scalar>
using Register = typename RegisterOf<Scalar>::Type;
template <class Scalar>
constexpr Index kLanes = kRegisterBytes / Index{sizeof(Scalar)};

template <class Scalar>
Register<Scalar>& lanes(const Scalar* numbers) {
  return *reinterpret_cast<Register<Scalar>*>(const_cast<Scalar*>(numbers));
}

// Columns of a tile. Two registers of rows by as many sums hide the latency of a multiply-add;
// there are 32 registers with AVX-512 and 16 without.
constexpr int kColumns = kRegisterBytes == 64 ? 8 : 4;

// A matrix as numbers and the steps from one to the next: along the inner index, and across it.
template <class Scalar>
struct Panel {
  const Scalar* numbers;
  Index along, across;
};

template <class Scalar>
struct Result {
  Scalar* numbers;
  Index stride;
  Scalar keep;
};

// C = A B + keep C for `Registers` registers of rows and `Columns` columns.
template <int Registers, int Columns, class Scalar>
void tile(const Panel<Scalar>& A, const Panel<Scalar>& B, Index depth, const Result<Scalar>& C) {
  Register<Scalar> sum[Columns][Registers];
  const auto of_C = [&](int c, int r) -> Register<Scalar>& {
    return lanes(C.numbers + c * C.stride + r * kLanes<Scalar>);
  };
  for (int c = 0; c < Columns; ++c)
    for (int r = 0; r < Registers; ++r)
      if (C.keep == 0)
        sum[c][r] = Register<Scalar>{};
      else  // no product by 1, which might be fused with the first sum in the place of a b
        sum[c][r] = C.keep == 1 ? of_C(c, r) : C.keep * of_C(c, r);
  for (Index p = 0; p < depth; ++p) {
    Register<Scalar> a[Registers];
    for (int r = 0; r < Registers; ++r) a[r] = lanes(A.numbers + p * A.along + r * kLanes<Scalar>);
    for (int c = 0; c < Columns; ++c) {
      const Scalar b = B.numbers[p * B.along + c * B.across];
      for (int r = 0; r < Registers; ++r) sum[c][r] = a[r] * b + sum[c][r];  // fused
    }
  }
  for (int c = 0; c < Columns; ++c)
    for (int r = 0; r < Registers; ++r) of_C(c, r) = sum[c][r];
}

// All rows of `Columns` columns.
template <int Columns, class Scalar>
void columns(Panel<Scalar> A, const Panel<Scalar>& B, Index rows, Index depth, Result<Scalar> C) {
  constexpr int kTwo = 2;
  constexpr Index kStep = kTwo * kLanes<Scalar>;
  for (; rows >= kStep; rows -= kStep) {
    tile<kTwo, Columns>(A, B, depth, C);
    A.numbers += kStep;
    C.numbers += kStep;
  }
  if (rows > 0) tile<1, Columns>(A, B, depth, C);
}

// The inner index in blocks whose part of B stays in the first cache. A block leaves in C exactly
// the contents of its registers, so blocks change no bits.
template <class Scalar>
void all_columns(Panel<Scalar> A, Panel<Scalar> B, Index rows, Index width, Index depth,
                 Result<Scalar> C) {
  constexpr Index kDeepest = 256;
  for (Index p = 0; p < std::max<Index>(depth, 1); p += kDeepest) {
    const Index deep = std::min(kDeepest, depth - p);
    const auto columns_from = [&]<int Columns>(Index c) {
      const Panel<Scalar> part{B.numbers + p * B.along + c * B.across, B.along, B.across};
      columns<Columns>({A.numbers + p * A.along, A.along, A.across}, part, rows, deep,
                       {C.numbers + c * C.stride, C.stride, C.keep});
    };
    Index c = 0;
    for (; c + kColumns <= width; c += kColumns) columns_from.template operator()<kColumns>(c);
    for (; c + 2 <= width; c += 2) columns_from.template operator()<2>(c);
    if (c < width) columns_from.template operator()<1>(c);
    C.keep = 1;
  }
}

template <class Scalar>
void multiply_by_rows(Form form, typename Gemm<Scalar>::In A, typename Gemm<Scalar>::In B,
                      typename Gemm<Scalar>::Out C, Scalar keep) {
  const bool is_across = form == Form::A_BH;
  const Index rows = A.rows(), depth = A.cols(), width = is_across ? B.rows() : B.cols();
  if (form == Form::AH_B || C.rows() != rows || C.cols() != width ||
      depth != (is_across ? B.cols() : B.rows()))
    throw UsageError("the shapes of the matrices of a product by rows do not match");
  const Panel<Scalar> right{B.data(), is_across ? B.outerStride() : 1,
                            is_across ? 1 : B.outerStride()};
  const Index rest = rows % kLanes<Scalar>, whole = rows - rest;
  if (rest > 0) {  // in copies that fill a register
    constexpr Index kLane = kLanes<Scalar>, kWide = 64;
    typename Gemm<Scalar>::Array last(kLane, depth);
    Eigen::Matrix<Scalar, kLane, kWide> sums = Eigen::Matrix<Scalar, kLane, kWide>::Zero();
    last.setZero();
    last.topRows(rest) = A.bottomRows(rest);
    for (Index c = 0; c < width; c += kWide) {
      const Index wide = std::min(kWide, width - c);
      sums.topLeftCorner(rest, wide) = C.block(whole, c, rest, wide);
      all_columns<Scalar>({last.data(), kLane, 1},
                          {right.numbers + c * right.across, right.along, right.across}, kLane,
                          wide, depth, {sums.data(), kLane, keep});
      C.block(whole, c, rest, wide) = sums.topLeftCorner(rest, wide);
    }
  }
  constexpr Index kShare = 16 * kLanes<Scalar>;  // rows whose part of A stays in a cache
  const Index tasks = (whole + kShare - 1) / kShare;
  const auto share = [&](Index task, int) {
    const Index first = task * kShare;
    all_columns<Scalar>({A.data() + first, A.outerStride(), 1}, right,
                        std::min(kShare, whole - first), width, depth,
                        {C.data() + first, C.outerStride(), keep});
  };
  if (library_threads() > 1 && is_worth_sharing(rows, width, depth))
    return for_each_task(tasks, share);
  for (Index task = 0; task < tasks; ++task) share(task, 0);
}

}  // namespace

void product(Form form, Gemm<float>::In A, Gemm<float>::In B, Gemm<float>::Out C, float keep) {
  multiply<float>(form, A, B, C, keep);
}

void product(Form form, Gemm<double>::In A, Gemm<double>::In B, Gemm<double>::Out C, double keep) {
  multiply<double>(form, A, B, C, keep);
}

void lower_gram(Gemm<double>::In A, Gemm<double>::Out C) {
  require_fit(C.rows() == A.cols() && C.cols() == A.cols());
  C.setZero();
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, as_int(A.cols()), as_int(A.rows()), 1,
              A.data(), stride(A), 0, C.data(), stride(C));
}

void product(Form form, Gemm<Complex>::In A, Gemm<Complex>::In B, Gemm<Complex>::Out C,
             Complex keep) {
  multiply<Complex>(form, A, B, C, keep);
}

// Products whose rows do not depend on their place. One register holds several rows of a column; a
// tile of sums stays in registers while the inner index runs, as in Goto, van de Geijn (2008), but
// without their packing: the arrays of small networks lie in the caches as they are.

void product_by_rows(Form form, Gemm<float>::In A, Gemm<float>::In B, Gemm<float>::Out C,
                     float keep) {
  multiply_by_rows<float>(form, A, B, C, keep);
}

void product_by_rows(Form form, Gemm<double>::In A, Gemm<double>::In B, Gemm<double>::Out C,
                     double keep) {
  multiply_by_rows<double>(form, A, B, C, keep);
}

}  // namespace isoline
