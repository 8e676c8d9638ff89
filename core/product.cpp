// Products of dense matrices, by OpenBLAS.
#include "core/product.h"

#include <cblas.h>

#include "core/errors.h"

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

void require_fit(bool do_fit) {  // `require` would make its text
  if (!do_fit) throw UsageError("the shapes of the matrices of a product do not match");
}

int as_int(Index n) { return static_cast<int>(n); }

template <class Array>
int stride(const Array& array) {  // BLAS wants at least one, of an empty matrix too
  return std::max(1, as_int(array.outerStride()));
}

template <class Scalar>
void multiply(Form form, typename Gemm<Scalar>::In A, typename Gemm<Scalar>::In B,
              typename Gemm<Scalar>::Out C, Scalar keep) {
  const auto flag = [](bool is_adjoint) { return is_adjoint ? CblasConjTrans : CblasNoTrans; };
  const bool left = form == Form::AH_B, right = form == Form::A_BH;
  const Index m = left ? A.cols() : A.rows(), k = left ? A.rows() : A.cols();
  const Index n = right ? B.rows() : B.cols();
  require_fit(C.rows() == m && C.cols() == n && k == (right ? B.cols() : B.rows()));
  gemm(flag(left), flag(right), as_int(m), as_int(n), as_int(k), A.data(), stride(A), B.data(),
       stride(B), keep, C.data(), stride(C));
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

}  // namespace isoline
