// The Fourier neural operator: its published size, and its modes against the whole transform.
#include "networks/fno.h"

#include <gtest/gtest.h>

#include "core/fourier.h"
#include "networks/network.h"

namespace isoline::networks {

namespace {

std::unique_ptr<Network> make(const std::string& spec, Index N) {
  return make_network(spec, {.inputs = N * N, .outputs = N * N, .grid = N});
}

// 1,188,353 where a complex number counts once, Holl, Koltun, Thuerey (2022).
TEST(FourierOperator, HasThePublishedNumberOfParameters) {
  const auto network = make("fno", 64);
  EXPECT_EQ(network->parameters(), 2'368'001);
  Index complex = 0;
  for (const Block& block : network->layout())
    if (block.kind == Block::Kind::spectrum) complex += block.rows * block.columns / 2;
  EXPECT_EQ(network->parameters() - complex, 1'188'353);
}

// A row is the real or imaginary part of a pair of channels, a column a mode of one corner.
TEST(FourierOperator, SpectraAreLaidOutByPairsOfChannelsAndModes) {
  constexpr Index kWidth = 3, kModesKept = 2;
  const auto network = make("fno[modes=2,width=3]", 8);
  Index spectra = 0;
  for (const Block& block : network->layout()) {
    if (block.kind != Block::Kind::spectrum) continue;
    EXPECT_EQ(block.rows, 2 * kWidth * kWidth);
    EXPECT_EQ(block.columns, kModesKept * kModesKept);
    ++spectra;
  }
  EXPECT_EQ(spectra, 4 * 2);  // layers, corners of the half spectrum
}

TEST(FourierOperator, WantsAGridWithRoomForItsModes) {
  EXPECT_THROW(make_network("fno", {.inputs = 4, .outputs = 4}), UsageError);
  EXPECT_THROW(make("fno[modes=13]", 16), UsageError);  // 26 of 25 cells
  EXPECT_NO_THROW(make("fno[modes=12,width=2]", 16));
}

constexpr Index kSize = 11, kModes = 4;

// Column of mode (k, frequency f along columns).
Index column(Index k, Index f) { return k + kModes * (f < 0 ? f + 2 * kModes : f); }

TEST(TruncatedFourier, HasTheLowestModesOfTheWholeTransform) {
  RandomStream stream(1, "fno", "test");
  const Matrix grids = stream.normal_vector(2 * kSize * kSize).reshaped(kSize, 2 * kSize);
  const TruncatedFourier few(kSize, kModes);
  TruncatedFourier::Spectra S;
  TruncatedFourier::Room room;
  few.analyze(TruncatedFourier::Weights::none, grids.cast<float>(), S, room);
  RealFourier2d whole(kSize, kSize);
  for (Index grid = 0; grid < 2; ++grid) {
    whole.forward(grids.middleCols(grid * kSize, kSize).reshaped());
    for (Index k = 0; k < kModes; ++k) {
      for (Index f = -kModes; f < kModes; ++f) {
        const auto expected = whole.spectrum()(k, (f + kSize) % kSize);
        const auto found = std::complex<Real>(S(grid, column(k, f)));
        EXPECT_LE(std::abs(found - expected), 1e-5) << k << " " << f;  // 121 terms in float
      }
    }
  }
}

// All that is kept, transformed back, is what the whole transform gives with the rest at zero.
TEST(TruncatedFourier, SynthesisIsTheInverseOfTheHalfSpectrum) {
  RandomStream stream(2, "fno", "test");
  TruncatedFourier::Spectra S(1, 2 * kModes * kModes);
  RealFourier2d whole(kSize, kSize);
  whole.spectrum().setZero();
  for (Index k = 0; k < kModes; ++k) {
    for (Index f = -kModes; f < kModes; ++f) {
      const std::complex<Real> value(stream.normal(), stream.normal());
      whole.spectrum()(k, (f + kSize) % kSize) = value;
      S(0, column(k, f)) = Complex(value);
    }
  }
  Vector expected(kSize * kSize);
  whole.inverse(expected);
  expected /= whole.round_trip();
  Gemm<float>::Array grid = Gemm<float>::Array::Zero(kSize, kSize);
  TruncatedFourier::Room room;
  TruncatedFourier(kSize, kModes).synthesize(TruncatedFourier::Weights::inverse, S, grid, room);
  EXPECT_LE((grid.cast<Real>().reshaped() - expected).norm(), 1e-6 * expected.norm());  // float
}

}  // namespace
}  // namespace isoline::networks
