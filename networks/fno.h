// The lowest modes of real square grids, many at once, by products with dense matrices:
//   S_kq = w_k Σ x_ij e^(−2πi (ik + j f_q)/P),  k = 0 … M−1,  f_q = 0 … M−1, −M … −1
// A 64-cell grid is padded to P = 73. FFTW needs all modes and, since 73 is prime, many times the
// work: twelve modes by products cost less than its half spectrum alone.
#pragma once

#include <array>

#include "core/product.h"

namespace isoline::networks {

class TruncatedFourier {
 public:
  // (grids, 4M²): a grid per row; of mode m = k + M q, real parts in column 2m, imaginary in 2m + 1
  using Spectra = Gemm<float>::Array;

  // Transforms share scratch arrays, which the caller owns.
  struct Room {
    Gemm<float>::Array half;     // (2M, P·grids), transformed along rows; complex numbers by pairs
    Gemm<Complex>::Array modes;  // (2M², grids)
  };

  TruncatedFourier(Index size, Index modes);
  Index size() const { return size_; }
  Index modes() const { return 2 * modes_ * modes_; }

  // `none`: w = 1. `inverse`: synthesis is the inverse real transform of a half spectrum whose
  // other modes are 0; w_k = c_k/P², c₀ = 1, otherwise c_k = 2.
  enum class Weights { none, inverse };

  void analyze(Weights weights, Gemm<float>::In grids, Spectra& S, Room& room) const;
  // x += Aᵀ S, the adjoint of analysis with equal weights. Grids are (P, P·grids).
  void synthesize(Weights weights, const Spectra& S, Gemm<float>::Out grids, Room& room) const;

 private:
  Index size_, modes_;
  // By Weights: (2M, P), rows w cos and −w sin by turns; and the transposes.
  std::array<Gemm<float>::Array, 2> along_rows_, back_;
  Gemm<Complex>::Array along_columns_;  // (P, 2M)
};

}  // namespace isoline::networks
