// The lowest modes of real square grids, by products with dense matrices.
#include "networks/truncated_fourier.h"

#include <cmath>
#include <numbers>

namespace isoline::networks {
namespace {

using ComplexMap = Eigen::Map<Gemm<Complex>::Array>;

// The (M, P) complex numbers of one grid within `half`.
ComplexMap half_of(Gemm<float>::Array& half, Index grid, Index size) {
  float* begin = half.data() + grid * size * half.rows();
  return {reinterpret_cast<Complex*>(begin), half.rows() / 2,
          size};  // pairs, as the standard has it
}

}  // namespace

TruncatedFourier::TruncatedFourier(Index size, Index modes)
    : size_(size),
      modes_(modes),
      plain_(2 * modes, size),
      weighted_(2 * modes, size),
      along_columns_(size, 2 * modes) {
  const Real turn = 2 * std::numbers::pi / Real(size);
  const auto angle = [&](Index i, Index k) { return turn * Real(i * k % size); };
  for (Index i = 0; i < size; ++i) {
    for (Index k = 0; k < modes; ++k) {
      const Real weight = (k == 0 ? 1 : 2) / Real(size * size);
      const Real cosine = std::cos(angle(i, k)), sine = -std::sin(angle(i, k));
      plain_(2 * k, i) = float(cosine);
      plain_(2 * k + 1, i) = float(sine);
      weighted_(2 * k, i) = float(weight * cosine);
      weighted_(2 * k + 1, i) = float(weight * sine);
      const Index negative = modes - k;  // the frequency −M + k, of the second half
      along_columns_(i, k) = {float(cosine), float(sine)};
      along_columns_(i, modes + k) = {float(std::cos(angle(i, negative))),
                                      float(std::sin(angle(i, negative)))};
    }
  }
}

void TruncatedFourier::analyze(Weights weights, Gemm<float>::In grids, Spectra& S,
                               Room& room) const {
  const Index count = grids.cols() / size_;
  room.half.resize(2 * modes_, grids.cols());
  room.modes.resize(modes(), count);
  product(Form::A_B, weights == Weights::none ? plain_ : weighted_, grids, room.half);
  for (Index grid = 0; grid < count; ++grid) {
    ComplexMap out(room.modes.col(grid).data(), modes_, 2 * modes_);
    product(Form::A_B, half_of(room.half, grid, size_), along_columns_, out);
  }
  S = room.modes.transpose();
}

void TruncatedFourier::synthesize(Weights weights, const Spectra& S, Gemm<float>::Out grids,
                                  Room& room) const {
  const Index count = S.rows();
  room.half.resize(2 * modes_, grids.cols());
  room.modes = S.transpose();
  for (Index grid = 0; grid < count; ++grid) {
    const ComplexMap in(room.modes.col(grid).data(), modes_, 2 * modes_);
    product(Form::A_BH, in, along_columns_, half_of(room.half, grid, size_));
  }
  product(Form::AH_B, weights == Weights::none ? plain_ : weighted_, room.half, grids, 1);
}

}  // namespace isoline::networks
