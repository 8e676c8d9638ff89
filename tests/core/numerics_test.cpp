// Arrays and numeric libraries: random streams, products, factorizations, transforms, convolutions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "core/convolution.h"
#include "core/decompose.h"
#include "core/differences.h"
#include "core/errors.h"
#include "core/fourier.h"
#include "core/product.h"
#include "core/random.h"
#include "core/threads.h"

namespace isoline {
namespace {

TEST(RandomStream, TheSameKeyGivesTheSameDraws) {
  RandomStream a(1, "sine", "start"), b(1, "sine", "start");
  EXPECT_EQ(a.normal_vector(100), b.normal_vector(100));
}

TEST(RandomStream, EveryPartOfTheKeyMatters) {
  const Vector drawn = RandomStream(1, "sine", "start", 0).normal_vector(4);
  EXPECT_NE(RandomStream(2, "sine", "start", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "heat", "start", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "sine", "target", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "sine", "start", 1).normal_vector(4), drawn);
}

// Means and variances of n draws lie within five standard errors of the law's own: a fixed seed
// makes the outcome certain, and a wrong law misses by far more.
TEST(RandomStream, UniformAndNormalHaveTheirMoments) {
  constexpr Index kDraws = 100'000;
  RandomStream stream(3, "test", "moments");
  const Vector uniform = stream.uniform_vector(kDraws, 0, 1);
  const Vector normal = stream.normal_vector(kDraws);
  const Real root = std::sqrt(Real(kDraws));
  EXPECT_GE(uniform.minCoeff(), 0);
  EXPECT_LT(uniform.maxCoeff(), 1);
  EXPECT_NEAR(uniform.mean(), 0.5, 5 * std::sqrt(1.0 / 12) / root);
  EXPECT_NEAR(normal.mean(), 0, 5 / root);
  EXPECT_NEAR(normal.squaredNorm() / kDraws, 1, 5 * std::sqrt(2.0) / root);
}

TEST(RandomStream, SignsAreFairAndOfBothKinds) {
  constexpr Index kCount = 100001;  // no multiple of what one draw yields
  Vector z(kCount);
  RandomStream(1, "test", "signs").signs(z);
  EXPECT_TRUE((z.cwiseAbs().array() == 1).all());
  EXPECT_LT(std::abs(z.mean()), 4 / std::sqrt(kCount));  // four standard deviations
  EXPECT_LT(std::abs(z.head(kCount - 1).dot(z.tail(kCount - 1)) / kCount), 4 / std::sqrt(kCount));
}

// Products against their definition, and rows that do not depend on their place.

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
        const Index whole = whole_registers<TypeParam>(16 * rows) + rows % 5;
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
    const Array<TypeParam> A = row.replicate(rows, 1);
    Array<TypeParam> C(rows, 37);
    product_by_rows(Form::A_B, A, B, C);
    if (reference.size() == 0) reference = C.row(0);
    for (Index i = 0; i < rows; ++i) EXPECT_EQ(C.row(i), reference) << rows << ", " << i;
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
}

// The previous contents are overwritten: a factorization refuses a matrix with NaN.
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

// The product of the factors is the matrix.

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

// Fourier and sine transforms against their definitions.

constexpr Index kGridRows = 6, kGridColumns = 5;  // not square, one even, one odd
constexpr Real kRounding = 1e-13;                 // thirty terms of order one in double

Vector random_grid(Index size = kGridRows * kGridColumns) {
  RandomStream stream(1, "fourier", "test");
  return stream.normal_vector(size);
}

TEST(RealFourier, SpectrumIsTheDefiningSum) {
  using namespace std::complex_literals;
  const Vector x = random_grid();
  RealFourier2d fourier(kGridRows, kGridColumns);
  fourier.forward(x);
  ASSERT_EQ(fourier.spectrum().rows(), kGridRows / 2 + 1);
  for (Index k = 0; k <= kGridRows / 2; ++k) {
    for (Index l = 0; l < kGridColumns; ++l) {
      std::complex<Real> sum = 0;
      for (Index i = 0; i < kGridRows; ++i)
        for (Index j = 0; j < kGridColumns; ++j)
          sum += x[i + j * kGridRows] *
                 std::exp(-2i * std::numbers::pi *
                          (Real(i * k) / Real(kGridRows) + Real(j * l) / Real(kGridColumns)));
      EXPECT_LT(std::abs(fourier.spectrum()(k, l) - sum), kRounding);
    }
  }
}

TEST(RealFourier, InverseUndoesForwardButForItsFactorAndLeavesTheInputAlone) {
  const Vector x = random_grid(), given = x;
  RealFourier2d first(kGridRows, kGridColumns);
  RealFourier2d transform = std::move(first);
  Vector back(x.size());
  transform.forward(given);
  EXPECT_EQ(given, x);
  transform.inverse(back);
  EXPECT_LT((back / transform.round_trip() - x).norm(), kRounding);
}

TEST(RealFourier, EqualInputGivesEqualBitsWhereverItLies) {
  const Vector x = random_grid();
  RealFourier2d transform(kGridRows, kGridColumns);
  transform.forward(x);
  const auto spectrum = transform.spectrum();
  Vector back(x.size());
  transform.inverse(back);
  for (Index offset = 1; offset < 8; ++offset) {
    Vector in(x.size() + 8), out(x.size() + 8);
    in.segment(offset, x.size()) = x;
    RealFourier2d another(kGridRows, kGridColumns);
    another.forward(in.segment(offset, x.size()));
    EXPECT_EQ(another.spectrum(), spectrum) << offset;
    another.inverse(out.segment(offset, x.size()));
    EXPECT_EQ(out.segment(offset, x.size()), back) << offset;
  }
}

TEST(Transforms, OfAGridOfAnotherSizeAreUsageErrors) {
  EXPECT_THROW(RealFourier2d(kGridRows, kGridColumns).forward(random_grid(7)), UsageError);
  Matrix x = random_grid(14).reshaped(7, 2);
  EXPECT_THROW(SineTransform(6).columns(x, x), UsageError);
}

// By long double, whose rounding is a thousandth of what is allowed.
Matrix sums_of_sines(const Matrix& x) {
  const Index rows = x.rows();
  Matrix out(rows, x.cols());
  for (Index j = 0; j < x.cols(); ++j)
    for (Index k = 0; k < rows; ++k) {
      long double sum = 0;
      for (Index i = 0; i < rows; ++i) {
        const Index turns = (i + 1) * (k + 1) % (2 * (rows + 1));  // of half a circle by rows + 1
        sum += x(i, j) * std::sin(std::numbers::pi_v<long double> * turns / (rows + 1));
      }
      out(k, j) = static_cast<Real>(2 * sum);
    }
  return out;
}

Matrix random_columns(Index rows, Index columns) {
  return random_grid(rows * columns).reshaped(rows, columns);
}

TEST(SineTransform, SpectrumIsTheDefiningSum) {
  for (const Index rows : {1, 2, 5, 6, 64, 100, 512}) {  // 101 is a prime
    const Matrix x = random_columns(rows, 3), exact = sums_of_sines(x);
    SineTransform sine(rows);
    Matrix spectrum(rows, 3);
    sine.columns(x, spectrum);
    EXPECT_LT((spectrum - exact).cwiseAbs().maxCoeff(), 1e-14 * exact.cwiseAbs().maxCoeff())
        << rows;
  }
}

TEST(SineTransform, InPlaceTwiceIsTheInputTimesAFactor) {
  const Matrix x = random_columns(6, 5);
  Matrix back = x;
  SineTransform first(6);
  SineTransform sine = std::move(first);
  sine.columns(back, back);
  sine.columns(back, back);
  EXPECT_LT((back / sine.round_trip() - x).norm(), kRounding);
}

// Gradients of convolution kernels against explicit sums, for plain and blocked inputs.

// Numbers at an address that oneDNN accepts.
using Aligned = std::unique_ptr<float[], decltype(&std::free)>;
Aligned aligned(Index count, RandomStream& stream) {
  const std::size_t bytes = (sizeof(float) * static_cast<std::size_t>(count) + 63) / 64 * 64;
  Aligned numbers(static_cast<float*>(std::aligned_alloc(64, bytes)), &std::free);
  const Vector drawn = stream.normal_vector(count);
  std::ranges::transform(drawn, numbers.get(), [](Real x) { return static_cast<float>(x); });
  return numbers;
}

struct Layout {
  ConvolutionShape s;

  Index halo() const { return s.N + 2; }
  Index width() const { return s.is_plain ? s.in : kChannels; }  // of a block that comes in
  Index in(Index image, Index channel, Index column, Index row) const {
    if (s.is_plain) return ((image * s.in + channel) * halo() + column) * halo() + row;
    const Index block = image * (s.in / kChannels) + channel / kChannels;
    return ((block * halo() + column) * halo() + row) * kChannels + channel % kChannels;
  }
  Index out(Index image, Index channel, Index column, Index row) const {
    const Index block = image * (s.out / kChannels) + channel / kChannels;
    return ((block * s.N + column) * s.N + row) * kChannels + channel % kChannels;
  }
  Index kernel(Index out, Index in, Index column, Index row) const {
    const Index block = out / kChannels * (s.in / width()) + in / width();
    return (((block * 3 + column) * 3 + row) * width() + in % width()) * kChannels +
           out % kChannels;
  }
};

class KernelGradients : public testing::TestWithParam<ConvolutionShape> {};

TEST_P(KernelGradients, AreTheSumsOverImagesAndPixels) {
  const ConvolutionShape s = GetParam();
  const Layout layout{s};
  RandomStream stream(0, "convolution", "test", 0);
  const Aligned in = aligned(s.images * s.in * layout.halo() * layout.halo(), stream);
  const Aligned cotangent = aligned(s.images * s.out * s.N * s.N, stream);
  const Aligned kernel = aligned(s.out * s.in * 9, stream);
  KernelGradient gradient(s);
  for (int call = 0; call < 2; ++call) gradient(in.get(), cotangent.get(), kernel.get());
  for (Index o = 0; o < s.out; ++o)
    for (Index i = 0; i < s.in; ++i)
      for (Index tap = 0; tap < 9; ++tap) {
        double sum = 0, size = 0;
        for (Index image = 0; image < s.images; ++image)
          for (Index pixel = 0; pixel < s.N * s.N; ++pixel) {
            const Index column = pixel / s.N, row = pixel % s.N;
            const double term = double{in[layout.in(image, i, column + tap / 3, row + tap % 3)]} *
                                double{cotangent[layout.out(image, o, column, row)]};
            sum += term;
            size += std::abs(term);
          }
        EXPECT_NEAR(kernel[layout.kernel(o, i, tap / 3, tap % 3)], sum, 1e-6 * size)
            << "out " << o << ", in " << i << ", tap " << tap;
      }
}

INSTANTIATE_TEST_SUITE_P(Shapes, KernelGradients,
                         testing::Values(ConvolutionShape{2, 1, 16, 8, true},
                                         ConvolutionShape{3, 2, 32, 4, true},
                                         ConvolutionShape{1, 3, 16, 8, true},
                                         ConvolutionShape{2, 16, 32, 8, false}));

// y(t) of a smooth model, as a simulator would hand it over.
Vector calls_of(Real t, const std::function<Real(Real)>& print) {
  Vector y(30);
  for (Index i = 0; i < y.size(); ++i)
    y[i] = print((1.5 + t) * std::sin(0.1 * static_cast<Real>(i + 1) * (2 - 0.7 * t)));
  return y;
}
Real noise_by(const std::function<Real(Real)>& print) {
  const auto y = [&](Real t) { return calls_of(t, print); };
  return noise_of_calls(y(0), y, Vector::Ones(y(0).size()));
}

TEST(NoiseOfCalls, IsRoundingForASmoothFunction) {
  EXPECT_EQ(noise_by([](Real y) { return y; }), std::numeric_limits<Real>::epsilon());
}

// A place of 10⁻⁵ of some 1.5, rounded: a fifth to a third of it in the root mean square.
TEST(NoiseOfCalls, IsTheLastPlaceOfPrintedOrSingleNumbers) {
  const auto printed = [](const char* form) {
    return noise_by([=](Real y) {
      std::array<char, 32> text;
      std::snprintf(text.data(), text.size(), form, y);
      return std::strtod(text.data(), nullptr);
    });
  };
  EXPECT_NEAR(std::log10(printed("%.6g")), -6, 0.7);
  EXPECT_NEAR(std::log10(printed("%.3f")), -3.5, 0.7);
  EXPECT_NEAR(std::log10(noise_by([](Real y) { return static_cast<Real>(static_cast<float>(y)); })),
              -7.5, 0.7);
}

// As of an adaptive solver, whose error jumps where the number of its steps changes.
TEST(NoiseOfCalls, SeesJumpsThatSmallStepsDoNot) {
  const auto y = [](Real t) -> Vector {
    return calls_of(t, [](Real value) { return value; }) *
           (1 + 1e-3 * std::sin(1e4 * std::floor(2e3 * t)));
  };
  EXPECT_GT(noise_of_calls(y(0), y, Vector::Ones(y(0).size())), 1e-5);
}

// Of a wave over many periods the unknown's size says too much, of a small term of y too little.
TEST(Differences, StepsFollowTheColumnOfTheJacobian) {
  EXPECT_EQ(size_for_steps(2, 3, 6), 2);
  EXPECT_NEAR(size_for_steps(2, 300, 6), 0.02, 1e-15);
  EXPECT_NEAR(size_for_steps(2, 0.03, 6), 20, 1e-13);
  EXPECT_EQ(size_for_steps(2, 0, 6), 2e3);
  EXPECT_EQ(sizes_of_unknowns(Vector{{2.5, 5e-9, 0}}), (Vector{{2.5, 5e-9, 1}}));
}

// As of a line at 6,400 eV of a width of 3: the first steps, of a share of 6,400, cross it.
TEST(NoiseOfCalls, TakesNoNarrowFeatureForNoise) {
  const auto y = [](Real t) -> Vector {
    Vector all(50);
    for (Index i = 0; i < 50; ++i) {
      const Real u = (6380 + static_cast<Real>(i) - 6399 * (1 + t)) / 3;
      all[i] = 1 / (1 + u * u);
    }
    return all;
  };
  EXPECT_EQ(noise_of_calls(y(0), y, Vector::Ones(y(0).size())),
            std::numeric_limits<Real>::epsilon());
}

TEST(NoiseOfCalls, SeesPrintedDigitsWhereACallFails) {
  for (const int failed : {1, 2}) {
    const auto y = [=](Real t) -> Vector {
      const Vector all = calls_of(t, [](Real value) {
        std::array<char, 32> text;
        std::snprintf(text.data(), text.size(), "%.6g", value);
        return std::strtod(text.data(), nullptr);
      });
      const bool fails = std::abs(t - failed * kNoiseStep) < 1e-9;
      return fails ? Vector::Constant(30, std::nan("")) : all;
    };
    EXPECT_GT(noise_of_calls(y(0), y, Vector::Ones(y(0).size())), 1e-7) << failed;
  }
}

// As of data with standard deviations, and a row that no program has printed.
TEST(NoiseOfCalls, SeesPrintedDigitsBehindFactors) {
  const Vector factors = Vector::LinSpaced(30, 0.37, 7.1);
  const auto y = [&](Real t) -> Vector {
    const Vector all = calls_of(t, [](Real value) {
      std::array<char, 32> text;
      std::snprintf(text.data(), text.size(), "%.6g", value);
      return std::strtod(text.data(), nullptr);
    });
    Vector rows(31);
    rows << all.cwiseProduct(factors), 1 + t / 3;
    return rows;
  };
  EXPECT_NEAR(std::log10(noise_of_calls(y(0), y, factors)), -6, 0.7);
}

// As of an amplitude that starts at 0: six digits show beside it.
TEST(NoiseOfCalls, IsMeasuredBesideAYOfZeros) {
  const auto y = [](Real t) -> Vector {
    return calls_of(0, [&](Real value) { return std::round(1e9 * t * value) / 1e9; });
  };
  ASSERT_TRUE(y(0).isZero(0));
  EXPECT_GT(noise_of_calls(y(0), y, Vector::Ones(30)), 1e-8);
}

// Of the calls at 1, 2 and 3, then at 0.75, 1.5 and 2.25 steps.
TEST(NoiseOfCalls, IsMeasuredBesideFailedCalls) {
  const auto y = [](Real t) -> Vector {
    const Vector all = calls_of(t, [](Real value) { return value; });
    for (const Real failed : {2.0, 2.25})
      if (std::abs(t / kNoiseStep - failed) < 1e-6) return std::nan("") * all;
    return all * (1 + 1e-3 * std::sin(1e4 * std::floor(2e3 * t)));
  };
  EXPECT_GT(noise_of_calls(y(0), y, Vector::Ones(30)), 1e-5);
}

// A call that prints a wrong number is no noise of the others.
TEST(NoiseOfCalls, LeavesAWildCallOut) {
  for (const Real wild : {1.0, 2.0, 1e-8 / kNoiseStep}) {
    const auto y = [&](Real t) -> Vector {
      const Vector all = calls_of(t, [](Real value) { return value; });
      return std::abs(t / kNoiseStep / wild - 1) < 1e-6 ? Vector(1e30 * all) : all;
    };
    EXPECT_LT(noise_of_calls(y(0), y, Vector::Ones(30)), 1e-8) << wild;
  }
}

// Where one of two calls fails, a call halfway keeps the order: e^t over steps of 0.01.
TEST(Differences, OfTwoCallsKeepTheirOrderWhereOneFails) {
  const auto y = [](Real t) { return Vector::Constant(1, t < 0 ? std::nan("") : std::exp(t)); };
  const Vector slope = quotient_of_calls<Vector>({0.01, -0.01}, {}, y(0), y);
  EXPECT_NEAR(slope[0], 1, 1e-4);
}

// Six digits: one-sided quotients over half the distance would have seven times the noise.
TEST(Differences, OfTwoCallsHaveLittleNoiseWhereOneFails) {
  const auto y = [](Real t) {
    const bool fails = t == -0.01;
    return Vector::Constant(1, fails ? std::nan("") : std::exp(t) + 1e-6 * std::cos(628.3 * t));
  };
  const Vector slope = quotient_of_calls<Vector>({0.01, -0.01}, {}, y(0), y);
  EXPECT_NEAR(slope[0], 1, 1.5e-4);
}

TEST(Differences, TakeTheStepsOfAUser) {
  EXPECT_EQ(given_steps("").of(0, 2, 5, 1e-3), 5e-3);
  EXPECT_EQ(given_steps("0.1").of(1, 2, 5, 1e-3), 0.5);
  EXPECT_EQ(given_steps("0.1:2").of(1, 2, 5, 1e-3), 10);
  EXPECT_EQ(given_steps("0.1:2 absolute").of(1, 2, 5, 1e-3), 2);
  EXPECT_THROW(given_steps("0.1:2").of(0, 3, 5, 1e-3), UsageError);
  for (const char* wrong : {"0", "-1", "1:", "x", "absolute", "1 2", "inf"})
    EXPECT_THROW(given_steps(wrong), UsageError) << wrong;
}

TEST(NoiseOfCalls, GivesTheSlopeOfASmoothFunctionAlone) {
  const auto smooth = [](Real t) -> Vector { return calls_of(t, [](Real y) { return y; }); };
  const auto printed = [&](Real t) -> Vector { return smooth(t).cast<float>().cast<Real>(); };
  Vector slope, none;
  noise_of_calls(smooth(0), smooth, Vector::Ones(30), &slope);
  const Real h = 1e-5;
  EXPECT_LT((slope - (smooth(h) - smooth(-h)) / (2 * h)).norm(), 1e-7 * slope.norm());
  noise_of_calls(printed(0), printed, Vector::Ones(30), &none);
  EXPECT_EQ(none.size(), 0);
}

TEST(Differences, StayInsideTheirRoomAndAreOfSecondOrderThere) {
  const auto y = [](Real t) { return Vector::Constant(1, std::exp(t)); };
  for (const auto& [up, down] : {std::pair<Real, Real>{1, 1}, {0, 1}, {1, 0}, {1e-5, 1e-4}}) {
    for (const bool is_central : {false, true}) {
      const Real h = is_central ? 1e-4 : 1e-8;
      const auto at = difference_offsets(h, is_central, up, down);
      for (const Real offset : at) EXPECT_TRUE(offset <= up && -offset <= down);
      const Vector slope =
          difference_quotient<Vector>(at, y(0), y(at[0]), at[1] == 0 ? y(at[0]) : y(at[1]));
      EXPECT_NEAR(slope[0], 1, 2e-8) << up << " " << down;  // h²/3, or rounding over h
    }
  }
  EXPECT_EQ(difference_offsets(1e-4, true, 0, 0)[0], 0);  // an unknown that is fixed
}

// A call without a value: the other side answers, unless there is no room or no value either.
TEST(Differences, UseTheOtherSideOfAFailedCall) {
  const Vector y0 = Vector::Ones(2);
  const auto slope = [&](Real least, Real most, const std::array<Real, 2>& offsets, Real down) {
    return quotient_of_calls(offsets, Room{.up = 1, .down = down}, y0, [&](Real t) -> Vector {
      return t < least || t > most ? Vector::Constant(2, std::nan("")) : Vector(y0.array() + 3 * t);
    });
  };
  constexpr Real h = 1e-3;
  for (const std::array<Real, 2>& offsets : {std::array<Real, 2>{h, 0}, {h, -h}}) {
    EXPECT_NEAR(slope(-1, 1, offsets, 1)[0], 3, 1e-9);  // rounding over h
    EXPECT_NEAR(slope(-1, 0, offsets, 1)[0], 3, 1e-9);
    EXPECT_EQ(slope(1, 1, offsets, 1), Vector::Zero(2));
  }
  EXPECT_EQ(slope(-1, 0, {h, 0}, 0), Vector::Zero(2));
  EXPECT_NEAR(slope(-1, 0, {h, 0}, h / 2)[0], 3, 1e-9);
  EXPECT_NEAR(slope(0, 1, {h, -h}, 1)[0], 3, 1e-9);
  for (const Real most : {0.6, 0.2})  // of the step: farther away, calls fail on both sides
    EXPECT_NEAR(slope(-most * h, most * h, {h, -h}, 1)[0], 3, 1e-8);
  EXPECT_EQ(slope(-1, 1, {0, 0}, 1), Vector::Zero(2));
}

}  // namespace
}  // namespace isoline
