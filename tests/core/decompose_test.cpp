// Factorizations give back what was factorized.
#include "core/decompose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/random.h"

namespace isoline {
namespace {

constexpr Real kRound = 1e-13;  // some hundred roundings of numbers about 1

Matrix random_matrix(Index rows, Index columns) {
  RandomStream stream(1, "test", "matrix");
  return stream.normal_vector(rows * columns).reshaped(rows, columns);
}

TEST(Decompose, SvdRebuildsTheMatrix) {
  for (const auto& [m, n] : {std::pair<Index, Index>{5, 3}, {3, 5}, {4, 4}, {1, 1}}) {
    const Matrix A = random_matrix(m, n);
    Svd svd;
    ASSERT_TRUE(thin_svd(A, svd));
    EXPECT_LT((svd.U * svd.sigma.asDiagonal() * svd.Vt - A).norm(), kRound);
    EXPECT_TRUE(std::is_sorted(svd.sigma.begin(), svd.sigma.end(), std::greater<>()));
  }
}

TEST(Decompose, SingularValuesAloneAreThoseOfTheSvd) {
  for (const auto& [m, n] : {std::pair<Index, Index>{7, 3}, {3, 7}, {5, 5}, {1, 4}}) {
    const Matrix A = random_matrix(m, n);
    Svd svd;
    Vector sigma;
    ASSERT_TRUE(thin_svd(A, svd) && singular_values(A, sigma));
    EXPECT_LE((sigma - svd.sigma).norm(), kRound) << m << " × " << n;
  }
}

TEST(Decompose, OfNotANumberOrOfNothingIsRefused) {
  const Matrix nan = Matrix::Constant(2, 2, std::nan(""));
  Svd svd;
  Vector sigma;
  FactoredSvd factored;
  EXPECT_FALSE(thin_svd(nan, svd));
  EXPECT_FALSE(singular_values(nan, sigma));
  EXPECT_FALSE(singular_values(Matrix(0, 3), sigma));
  EXPECT_FALSE(factored.factor(nan));
}

TEST(Decompose, FactoredSvdIsTheThinOneKeptAsItsFactors) {
  for (const auto& [m, n] : {std::pair<Index, Index>{9, 4}, {4, 4}, {40, 17}, {1, 1}}) {
    const Matrix A = random_matrix(m, n);
    Svd svd;
    FactoredSvd factored;
    ASSERT_TRUE(thin_svd(A, svd) && factored.factor(A));
    EXPECT_LT((factored.sigma() - svd.sigma).norm(), kRound * svd.sigma[0]);
    const Vector x = random_matrix(n, 1), y = random_matrix(m, 1);
    Vector along, out;
    factored.to_right(x, along);
    along = factored.sigma().cwiseProduct(along);
    factored.from_left(along, out);
    EXPECT_LT((out - A * x).norm(), 10 * kRound * out.norm()) << m << " × " << n;
    factored.to_left(y, along);
    along = factored.sigma().cwiseProduct(along);
    factored.from_right(along, out);
    EXPECT_LT((out - A.transpose() * y).norm(), 10 * kRound * svd.sigma[0] * y.norm()) << m;
  }
}

TEST(Decompose, EigenvectorsRebuildTheMatrix) {
  const Matrix A = random_matrix(4, 4) + random_matrix(4, 4).transpose();
  SymmetricEigen eigen;
  ASSERT_TRUE(symmetric_eigen(A, eigen));
  EXPECT_LT((eigen.V * eigen.lambda.asDiagonal() * eigen.V.transpose() - A).norm(), 10 * kRound);
}

TEST(Decompose, SquareSystemsAreSolvedAndSingularOnesRefused) {
  const Matrix A = random_matrix(4, 4);
  const Vector b = Vector::LinSpaced(4, 1, 4);
  Vector x;
  ASSERT_TRUE(solve_square(A, b, x));
  EXPECT_LT((A * x - b).norm(), 10 * kRound);
  EXPECT_FALSE(solve_square(Matrix::Zero(2, 2), Vector::Ones(2), x));
}

TEST(Decompose, PositiveDefiniteSystemsAreSolvedInPlaceAndOthersRefused) {
  const Matrix root = random_matrix(4, 4), A = root * root.transpose() + Matrix::Identity(4, 4);
  Matrix factored = A, B = random_matrix(4, 3);
  const Matrix right = B;
  ASSERT_TRUE(solve_positive_definite(factored, B));
  EXPECT_LT((A * B - right).norm(), kRound);
  factored = -A;
  EXPECT_FALSE(solve_positive_definite(factored, B));
}

// Of all minimizers of ‖x1 + x2 − 2‖ the shortest is (1, 1).
TEST(Decompose, LeastSquaresTakesTheShortestMinimizer) {
  Vector x;
  ASSERT_TRUE(least_squares(Matrix::Ones(3, 2), Vector::Constant(3, 2), 1e-12, x));
  EXPECT_LT((x - Vector::Ones(2)).norm(), kRound);
}

}  // namespace
}  // namespace isoline
