// The lowest modes of real square grids, many at once, by products with dense matrices:
//   S_kq = w_k Σ x_ij e^(−2πi (ik + j f_q)/P),  k = 0 … M−1,  f_q = 0 … M−1, −M … −1
// A 64-cell grid is padded to P = 73. FFTW needs all modes and, since 73 is prime, many times the
// work: twelve modes by products cost less than its half spectrum alone.
#pragma once

#include <vector>

#include "core/product.h"
#include "networks/activation.h"
#include "networks/network.h"

namespace isoline::networks {

class TruncatedFourier {
 public:
  using Spectra = Gemm<Complex>::Array;  // (grids, 2M²): one grid per row, mode k + M q per column

  // Transforms share scratch arrays, which the caller owns.
  struct Room {
    Gemm<float>::Array half;  // (2M, P·grids), transformed along rows; complex numbers by pairs
    Spectra modes;            // (2M², grids)
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
  Gemm<float>::Array plain_, weighted_;  // (2M, P), rows w cos and −w sin by turns
  Gemm<Complex>::Array along_columns_;   // (P, 2M)
};

// A Fourier neural operator on square grids, Li, Kovachki, Azizzadenesheli et al. (2021):
//   lift 3 -> C | pad | four layers z = K a + W a + b, a' = gelu(z) but for the last | crop |
//   C -> 128, gelu | 128 -> 1;   K a = F⁻¹ R F a on the lowest modes, R (C, C) for each
// A batch is a matrix (cells·B, C), one channel per column. Pointwise layers are products with [W
// b]ᵀ and a column of ones, as in the perceptron, and all grids stand side by side for the
// transform.

// Columns with one of ones behind them, in whole vector registers.
class Field {
 public:
  using Array = Gemm<float>::Array;
  using View = Eigen::Map<Array>;

  void resize(Index rows, Index columns) {
    if (rows == rows_ && columns == columns_) return;
    rows_ = rows;
    columns_ = columns;
    numbers_.setZero(whole_registers<float>(rows * (columns + 1)));
    set_ones();
  }
  void set_ones() { numbers_.segment(size(), rows_).setOnes(); }
  Index size() const { return rows_ * columns_; }
  Index rows() const { return rows_; }
  Index columns() const { return columns_; }
  View all() { return {numbers_.data(), rows_, columns_}; }
  View with_ones() { return {numbers_.data(), rows_, columns_ + 1}; }
  View grids(Index size) { return {numbers_.data(), size, rows_ * columns_ / size}; }
  View sample(Index column, Index b, Index edge) {
    return {numbers_.data() + column * rows_ + b * edge * edge, edge, edge};
  }
  Flat<float>& numbers() { return numbers_; }

 private:
  Index rows_ = 0, columns_ = 0;
  Flat<float> numbers_;
};

class FourierOperator final : public Network {
 public:
  static constexpr Index kPadding = 9;  // cells of zeros at the far ends, as published

  FourierOperator(Index grid, Index modes, Index width);

  Index parameters() const override { return parameters_; }
  Index inputs() const override { return grid_ * grid_; }
  Index outputs() const override { return grid_ * grid_; }
  bool is_single_precision() const override { return true; }
  bool has_curvature() const override { return true; }

  std::vector<Block> layout() const override;
  Vector start(RandomStream& stream) const override;
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override;
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override;
  void curvature(VectorRef v, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override;

 private:
  using Array = Gemm<float>::Array;
  using Spectra = TruncatedFourier::Spectra;
  using Parameters = Eigen::VectorXf;

  struct Layer {
    Index in, out, edge;  // channels, and cells along an edge
    bool has_modes, is_active;
    Index modes, weights;  // where R and [W b] begin in θ
  };
  struct Pass {
    Field a, z;          // input and sum of a layer
    Field da, dz;        // their change along the last v
    Field g, dg;         // cotangent of z and its change
    Field of_a, d_of_a;  // of a, where a has other edges than the z it came from
    Field bent;          // as z
    Spectra S, dS;       // modes of a and da
    Spectra gS, dgS;     // of g and dg, weighted
  };
  struct Own final : Scratch {
    Index samples = 0;
    std::vector<Pass> passes;
    Spectra made;
    TruncatedFourier::Room room;
    Flat<float> chunk;
    Parameters theta, v, gradient;
  };
  using ComplexMap = Eigen::Map<Gemm<Complex>::Array>;

  Eigen::Map<Array> with_bias(Parameters& theta, const Layer& layer) const;
  Eigen::Map<Array> weights(Parameters& theta, const Layer& layer) const;
  ComplexMap mode(Parameters& theta, const Layer& layer, Index m) const;

  Own& sized(Workspace& w, Index samples) const;
  void fit(Field& field, Index l, const Own& own) const;  // to the sum of a layer
  // z = W a + b + K a with `ones`, W a + K a without; keep z is added.
  void apply(Parameters& theta, const Layer& layer, Field& a, Spectra& S, bool ones, float keep,
             Field& z, Own& own) const;
  // a = Wᵀ g + Kᵀ g + keep a
  void apply_adjoint(Parameters& theta, const Layer& layer, Field& g, Spectra& gS, float keep,
                     Field& a, Own& own) const;
  // [∂W ∂b] = Σ g [a 1]ᵀ, and R alike, added to `keep` times the previous values
  void gather(const Layer& layer, Field& g, Spectra& gS, Field& a, Spectra& S, bool ones,
              float keep, Own& own) const;
  // Grids of one layer's edge in those of another's: the near corner, and zeros around it.
  void copy_corners(Field& from, Index from_edge, Field& to, Index to_edge, const Own& own) const;
  // The `from` of layer l back through it, to `to` of the layer below, before the slope.
  struct Descent {
    Field Pass::*from;
    Spectra Pass::*modes;
    Field Pass::*of_a;
    Field Pass::*to;
  };
  void descend(Parameters& theta, Index l, const Descent& path, float keep, Own& own) const;
  void seed(BatchRef u, Field& g, const Own& own) const;  // the cotangent of the last sum
  Pass& pass(Own& own, Index l) const { return own.passes[static_cast<std::size_t>(l)]; }
  const Layer& layer(Index l) const { return layers_[static_cast<std::size_t>(l)]; }
  Index last() const { return static_cast<Index>(layers_.size()) - 1; }

  Index grid_, padded_, width_, parameters_ = 0;
  TruncatedFourier fourier_;
  std::vector<Layer> layers_;
};

}  // namespace isoline::networks
