// Products against their definition, and rows that do not depend on their place.
#include "core/product.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/errors.h"
#include "core/random.h"
#include "core/threads.h"

namespace isoline {
namespace {

template <class Scalar>
using Array = typename Gemm<Scalar>::Array;

template <class Scalar>
Array<Scalar> random_array(Index rows, Index columns, const std::string& name) {
  RandomStream stream(1, "product", name);
  return stream.normal_vector(rows * columns).reshaped(rows, columns).template cast<Scalar>();
}

template <class Scalar>
class ProductByRows : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(ProductByRows, Scalars);

// Depths beside and across the blocks of the inner index, widths beside whole tiles.
TYPED_TEST(ProductByRows, IsTheProduct) {
  for (const Index rows : {1, 3, 5})
    for (const Index depth : {0, 1, 33, 256, 600})
      for (const Index width : {1, 2, 7, 8, 13}) {
        const Index whole = whole_registers<TypeParam>(16 * rows);
        const Array<TypeParam> A = random_array<TypeParam>(whole, depth, "A");
        const Array<TypeParam> B = random_array<TypeParam>(depth, width, "B");
        const Array<TypeParam> before = random_array<TypeParam>(whole, width, "C");
        const Matrix exact = A.template cast<Real>() * B.template cast<Real>();
        const Real rounding = Real(depth + 1) * std::numeric_limits<TypeParam>::epsilon();
        Array<TypeParam> C = before;
        product_by_rows(Form::A_B, A, B, C);
        EXPECT_LE((C.template cast<Real>() - exact).norm(), rounding * exact.norm());
        const Array<TypeParam> first = C, transposed = B.transpose();
        product_by_rows(Form::A_BH, A, transposed, C);
        EXPECT_EQ(C, first) << depth << " × " << width;
        C = before;
        product_by_rows(Form::A_B, A, B, C, 2);
        const Matrix sum = exact + 2 * before.template cast<Real>();
        EXPECT_LE((C.template cast<Real>() - sum).norm(), 3 * rounding * sum.norm());
      }
}

// By construction: whatever OpenBLAS' kernel, the place of a row, or the number of threads.
TYPED_TEST(ProductByRows, EqualRowsGetEqualBits) {
  const Array<TypeParam> row = random_array<TypeParam>(1, 300, "row");
  const Array<TypeParam> B = random_array<TypeParam>(300, 37, "B");
  Array<TypeParam> reference;
  for (const Index rows : {1, 2, 3, 16, 17, 100}) {
    const Index whole = whole_registers<TypeParam>(rows);
    const Array<TypeParam> A = row.replicate(whole, 1);
    Array<TypeParam> C(whole, 37);
    product_by_rows(Form::A_B, A, B, C);
    if (reference.size() == 0) reference = C.row(0);
    for (Index i = 0; i < whole; ++i) EXPECT_EQ(C.row(i), reference) << rows << ", " << i;
  }
}

TYPED_TEST(ProductByRows, ThreadsChangeNoBits) {
  const Array<TypeParam> A = random_array<TypeParam>(1024, 200, "A");
  const Array<TypeParam> B = random_array<TypeParam>(200, 100, "B");
  Array<TypeParam> on_all(1024, 100), alone(1024, 100);
  product_by_rows(Form::A_B, A, B, on_all);
  {
    const OneThread one;
    product_by_rows(Form::A_B, A, B, alone);
  }
  EXPECT_EQ(on_all, alone);
}

TYPED_TEST(ProductByRows, WhatDoesNotFitIsAUsageError) {
  const Array<TypeParam> A = random_array<TypeParam>(16, 4, "A");
  Array<TypeParam> C(16, 4);
  EXPECT_THROW(product_by_rows(Form::A_B, A, A, C), UsageError);
  EXPECT_THROW(product_by_rows(Form::AH_B, A, A, C), UsageError);
  const Array<TypeParam> few = random_array<TypeParam>(1, 4, "A"),
                         square = random_array<TypeParam>(4, 4, "B");
  Array<TypeParam> out(1, 4);
  EXPECT_THROW(product_by_rows(Form::A_B, few, square, out), UsageError);  // no whole register
}

// What was there before does not show: a factorization refuses a matrix with a number that is none.
TEST(LowerGram, IsTheLowerHalfAndZerosAboveIt) {
  for (const Index rows : {0, 1, 40})
    for (const Index columns : {1, 7, 33}) {
      const Array<double> A = random_array<double>(rows, columns, "A");
      Array<double> C = Array<double>::Constant(columns, columns, std::nan(""));
      lower_gram(A, C);
      const Array<double> exact = (A.transpose() * A).triangularView<Eigen::Lower>();
      EXPECT_LE((C - exact).cwiseAbs().maxCoeff(), 1e-13) << rows << " × " << columns;
    }
  Array<double> small(2, 2);
  EXPECT_THROW(lower_gram(random_array<double>(3, 3, "A"), small), UsageError);
}

}  // namespace
}  // namespace isoline
