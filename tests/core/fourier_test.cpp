// Fourier and sine transforms against their definitions.
#include "core/fourier.h"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "core/errors.h"
#include "core/random.h"

namespace isoline {
namespace {

constexpr Index kRows = 6, kColumns = 5;  // not square, one even, one odd
constexpr Real kRounding = 1e-13;         // thirty terms of order one in double

Vector random_grid(Index size = kRows * kColumns) {
  RandomStream stream(1, "fourier", "test");
  return stream.normal_vector(size);
}

TEST(RealFourier, SpectrumIsTheDefiningSum) {
  using namespace std::complex_literals;
  const Vector x = random_grid();
  RealFourier2d fourier(kRows, kColumns);
  fourier.forward(x);
  ASSERT_EQ(fourier.spectrum().rows(), kRows / 2 + 1);
  for (Index k = 0; k <= kRows / 2; ++k) {
    for (Index l = 0; l < kColumns; ++l) {
      std::complex<Real> sum = 0;
      for (Index i = 0; i < kRows; ++i)
        for (Index j = 0; j < kColumns; ++j)
          sum += x[i + j * kRows] *
                 std::exp(-2i * std::numbers::pi *
                          (Real(i * k) / Real(kRows) + Real(j * l) / Real(kColumns)));
      EXPECT_LT(std::abs(fourier.spectrum()(k, l) - sum), kRounding);
    }
  }
}

TEST(RealFourier, InverseUndoesForwardButForItsFactorAndLeavesTheInputAlone) {
  const Vector x = random_grid(), given = x;
  RealFourier2d first(kRows, kColumns);
  RealFourier2d transform = std::move(first);
  Vector back(x.size());
  transform.forward(given);
  EXPECT_EQ(given, x);
  transform.inverse(back);
  EXPECT_LT((back / transform.round_trip() - x).norm(), kRounding);
}

TEST(RealFourier, EqualInputGivesEqualBitsWhereverItLies) {
  const Vector x = random_grid();
  RealFourier2d transform(kRows, kColumns);
  transform.forward(x);
  const auto spectrum = transform.spectrum();
  Vector back(x.size());
  transform.inverse(back);
  for (Index offset = 1; offset < 8; ++offset) {
    Vector in(x.size() + 8), out(x.size() + 8);
    in.segment(offset, x.size()) = x;
    RealFourier2d another(kRows, kColumns);
    another.forward(in.segment(offset, x.size()));
    EXPECT_EQ(another.spectrum(), spectrum) << offset;
    another.inverse(out.segment(offset, x.size()));
    EXPECT_EQ(out.segment(offset, x.size()), back) << offset;
  }
}

TEST(Transforms, OfAGridOfAnotherSizeAreUsageErrors) {
  EXPECT_THROW(RealFourier2d(kRows, kColumns).forward(random_grid(7)), UsageError);
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

}  // namespace
}  // namespace isoline
