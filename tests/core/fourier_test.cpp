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

TEST(SineTransform, SpectrumIsTheDefiningSum) {
  const Vector x = random_grid();
  SineTransform2d sine(kRows, kColumns);
  sine.forward(x);
  const auto s = [](Index i, Index k, Index n) {
    return 2 * std::sin(std::numbers::pi * Real((i + 1) * (k + 1)) / Real(n + 1));
  };
  for (Index k = 0; k < kRows; ++k) {
    for (Index l = 0; l < kColumns; ++l) {
      Real sum = 0;
      for (Index i = 0; i < kRows; ++i)
        for (Index j = 0; j < kColumns; ++j)
          sum += x[i + j * kRows] * s(i, k, kRows) * s(j, l, kColumns);
      EXPECT_NEAR(sine.spectrum()(k, l), sum, 4 * kRounding);  // the terms are up to four
    }
  }
}

template <class Transform>
class EveryTransform : public ::testing::Test {};
using Transforms = ::testing::Types<RealFourier2d, SineTransform2d>;
TYPED_TEST_SUITE(EveryTransform, Transforms);

TYPED_TEST(EveryTransform, InverseUndoesForwardButForItsFactor) {
  const Vector x = random_grid();
  TypeParam transform(kRows, kColumns);
  Vector back(x.size());
  transform.forward(x);
  transform.inverse(back);
  EXPECT_LT((back / transform.round_trip() - x).norm(), kRounding);
}

TYPED_TEST(EveryTransform, EqualInputGivesEqualBitsWhereverItLies) {
  const Vector x = random_grid();
  TypeParam transform(kRows, kColumns);
  transform.forward(x);
  const auto spectrum = transform.spectrum();
  Vector back(x.size());
  transform.inverse(back);
  for (Index offset = 1; offset < 8; ++offset) {
    Vector in(x.size() + 8), out(x.size() + 8);
    in.segment(offset, x.size()) = x;
    TypeParam another(kRows, kColumns);
    another.forward(in.segment(offset, x.size()));
    EXPECT_EQ(another.spectrum(), spectrum) << offset;
    another.inverse(out.segment(offset, x.size()));
    EXPECT_EQ(out.segment(offset, x.size()), back) << offset;
  }
}

TYPED_TEST(EveryTransform, LeavesItsInputAlone) {
  const Vector x = random_grid();
  const Vector given = x;
  TypeParam transform(kRows, kColumns);
  transform.forward(given);
  EXPECT_EQ(given, x);
}

TYPED_TEST(EveryTransform, SurvivesBeingMoved) {
  const Vector x = random_grid();
  TypeParam first(kRows, kColumns);
  TypeParam second = std::move(first);
  Vector back(x.size());
  second.forward(x);
  second.inverse(back);
  EXPECT_LT((back / second.round_trip() - x).norm(), kRounding);
}

TYPED_TEST(EveryTransform, AGridOfAnotherSizeIsAUsageError) {
  TypeParam transform(kRows, kColumns);
  EXPECT_THROW(transform.forward(random_grid(7)), UsageError);
}

}  // namespace
}  // namespace isoline
