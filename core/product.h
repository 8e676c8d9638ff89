// Products of dense matrices: by OpenBLAS, compiled once and without Eigen's packing on the heap,
// and by our own sums in a fixed order where the bits of a row must not depend on its place. The
// only adapter to cblas.h.
#pragma once

#include <complex>

#include "core/array.h"

namespace isoline {

// Which product is taken; Aᴴ is the conjugate transpose, of real matrices the transpose.
enum class Form { A_B, A_BH, AH_B };

// C = A B + keep C, or with Bᴴ, or with Aᴴ. C must not overlap A or B; where `keep` is 0 it may
// hold anything.
template <class Scalar>
struct Gemm {
  using Array = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using In = const Eigen::Ref<const Array>&;
  using Out = Eigen::Ref<Array>;
};
void product(Form form, Gemm<float>::In A, Gemm<float>::In B, Gemm<float>::Out C, float keep = 0);
void product(Form form, Gemm<double>::In A, Gemm<double>::In B, Gemm<double>::Out C,
             double keep = 0);
// The lower half of C = AᵀA, above it zeros, in half the time. C may hold anything before.
void lower_gram(Gemm<double>::In A, Gemm<double>::Out C);
using Complex = std::complex<float>;
void product(Form form, Gemm<Complex>::In A, Gemm<Complex>::In B, Gemm<Complex>::Out C,
             Complex keep = 0);

// The same for A_B and A_BH, each number of C summed in the order of the inner index, one
// multiply-add a term, whatever its place: equal rows of A give equal rows of C, bit for bit, in
// any batch, whichever kernels a library picks. Rows that fill whole vector registers need no
// copies.
void product_by_rows(Form form, Gemm<float>::In A, Gemm<float>::In B, Gemm<float>::Out C,
                     float keep = 0);
void product_by_rows(Form form, Gemm<double>::In A, Gemm<double>::In B, Gemm<double>::Out C,
                     double keep = 0);

// The numbers in a vector register, and n rounded up to whole registers.
inline constexpr Index kRegisterBytes = EIGEN_MAX_STATIC_ALIGN_BYTES;
template <class Scalar>
Index whole_registers(Index n) {
  constexpr Index kLanes = kRegisterBytes / Index{sizeof(Scalar)};
  return (n + kLanes - 1) / kLanes * kLanes;
}

}  // namespace isoline
