// The Fourier neural operator by name, its layers, and the lowest modes of grids by products.
#include "networks/fno.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "networks/activation.h"
#include "networks/network.h"

namespace isoline::networks {
namespace {

using ComplexMap = Eigen::Map<Gemm<Complex>::Array>;

// The (M, P) complex numbers of one grid within `half`.
ComplexMap half_of(Gemm<float>::Array& half, Index grid, Index size) {
  float* begin = half.data() + grid * size * half.rows();
  return {reinterpret_cast<Complex*>(begin), half.rows() / 2,
          size};  // pairs, as the standard has it
}

// Complex numbers as the rows of pairs that they are.
Eigen::Map<Gemm<float>::Array> pairs(Gemm<Complex>::Array& numbers) {
  return {reinterpret_cast<float*>(numbers.data()), 2 * numbers.rows(), numbers.cols()};
}

}  // namespace

TruncatedFourier::TruncatedFourier(Index size, Index modes)
    : size_(size), modes_(modes), along_columns_(size, 2 * modes) {
  auto& [plain, weighted] = along_rows_;
  for (auto& each : along_rows_) each.resize(2 * modes, size);
  const Real turn = 2 * std::numbers::pi / Real(size);
  const auto angle = [&](Index i, Index k) { return turn * Real(i * k % size); };
  for (Index i = 0; i < size; ++i) {
    for (Index k = 0; k < modes; ++k) {
      const Real weight = (k == 0 ? 1 : 2) / Real(size * size);
      const Real cosine = std::cos(angle(i, k)), sine = -std::sin(angle(i, k));
      plain(2 * k, i) = float(cosine);
      plain(2 * k + 1, i) = float(sine);
      weighted(2 * k, i) = float(weight * cosine);
      weighted(2 * k + 1, i) = float(weight * sine);
      const Index negative = modes - k;  // the frequency −M + k, of the second half
      along_columns_(i, k) = {float(cosine), float(sine)};
      along_columns_(i, modes + k) = {float(std::cos(angle(i, negative))),
                                      float(std::sin(angle(i, negative)))};
    }
  }
  for (std::size_t i = 0; i < 2; ++i) back_[i] = along_rows_[i].transpose();
}

void TruncatedFourier::analyze(Weights weights, Gemm<float>::In grids, Spectra& S,
                               Room& room) const {
  const Index count = grids.cols() / size_;
  room.half.resize(2 * modes_, grids.cols());
  room.modes.resize(modes(), count);
  product_by_rows(Form::A_B, along_rows_[weights == Weights::inverse], grids, room.half);
  for (Index grid = 0; grid < count; ++grid) {
    ComplexMap out(room.modes.col(grid).data(), modes_, 2 * modes_);
    product(Form::A_B, half_of(room.half, grid, size_), along_columns_, out);
  }
  S = pairs(room.modes).transpose();
}

void TruncatedFourier::synthesize(Weights weights, const Spectra& S, Gemm<float>::Out grids,
                                  Room& room) const {
  const Index count = S.rows();
  room.half.resize(2 * modes_, grids.cols());
  room.modes.resize(modes(), count);
  pairs(room.modes) = S.transpose();
  for (Index grid = 0; grid < count; ++grid) {
    const ComplexMap in(room.modes.col(grid).data(), modes_, 2 * modes_);
    product(Form::A_BH, in, along_columns_, half_of(room.half, grid, size_));
  }
  product_by_rows(Form::A_B, back_[weights == Weights::inverse], room.half, grids, 1);
}

namespace {

// A Fourier neural operator on square grids, Li, Kovachki, Azizzadenesheli et al. (2021):
//   lift 3 -> C | pad | four layers z = K a + W a + b, a' = gelu(z) but for the last | crop |
//   C -> 128, gelu | 128 -> 1;   K a = F⁻¹ R F a on the lowest modes, R (C, C) for each
// A batch is a matrix (cells·B, C), one channel per column. Pointwise layers are products with [W
// b]ᵀ and a column of ones, as in the perceptron, and all grids stand side by side for the
// transform. Forward, each number is summed in one order, so the bits of a sample do not depend on
// its place in the batch.

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

constexpr Index kChannels = 3;  // the field and both coordinates
constexpr Index kHead = 128;    // width of the hidden layer of the head
constexpr Index kFourierLayers = 4;
constexpr auto kGelu = Activation::gelu;
constexpr auto kNone = TruncatedFourier::Weights::none;
constexpr auto kInverse = TruncatedFourier::Weights::inverse;

auto mode_of(Gemm<float>::Array& S, Index m, Index samples) {  // (B, 2C): real, imaginary parts
  return Eigen::Map<Gemm<float>::Array>(S.col(2 * m).data(), samples, 2 * S.rows() / samples);
}

// Calls treat(begin, count) for one chunk after another, well within a cache. The last may end in
// the column of ones.
void in_chunks(Index size, auto treat) {
  constexpr Index kChunk = 4096;
  for (Index begin = 0; begin < size; begin += kChunk)
    treat(begin, std::min(kChunk, whole_registers<float>(size - begin)));
}

void gelu(Field& z, Field& a) {
  in_chunks(z.size(), [&](Index begin, Index count) {
    activate<float>(kGelu, z.numbers().segment(begin, count), a.numbers().segment(begin, count));
  });
  a.set_ones();
}

void multiply_by_gelu_slope(Field& z, Field& g, Flat<float>& room) {
  room.resize(std::max<Index>(room.size(), 4096));
  in_chunks(z.size(), [&](Index begin, Index count) {
    const Eigen::Ref<const Flat<float>> at = z.numbers().segment(begin, count);
    multiply_by_slope<float>(kGelu, at, at, g.numbers().segment(begin, count), room.head(count));
  });
}

// out = gelu''(z) dz h
void bend(Field& z, Field& dz, Field& h, Field& out) {
  in_chunks(z.size(), [&](Index begin, Index count) {
    const Eigen::Ref<const Flat<float>> at = z.numbers().segment(begin, count);
    FlatOut<float> made = out.numbers().segment(begin, count);
    made = dz.numbers().segment(begin, count) * h.numbers().segment(begin, count);
    multiply_by_bend<float>(kGelu, at, at, made);
  });
}

class FourierOperator final : public Network {
 public:
  static constexpr Index kPadding = 9;  // cells of zeros at the far ends, as published

  FourierOperator(Index grid, Index modes, Index width);

  Index parameters() const override { return parameters_; }
  Index inputs() const override { return grid_ * grid_; }
  Index outputs() const override { return grid_ * grid_; }
  bool is_single_precision() const override { return true; }
  bool has_curvature() const override { return true; }

  // R of the two corners of the half spectrum, each (in, out) a mode; then W and b.
  std::vector<Block> layout() const override {
    std::vector<Block> blocks;
    for (const Layer& layer : layers_) {
      const Index pairs = layer.in * layer.out, modes = fourier_.modes() / 2;
      for (Index corner = 0; layer.has_modes && corner < 2; ++corner)
        blocks.push_back(
            {layer.modes + corner * 2 * pairs * modes, 2 * pairs, modes, Block::Kind::spectrum});
      blocks.push_back({layer.weights, layer.out, layer.in, Block::Kind::weight});
      blocks.push_back({layer.weights + layer.out * layer.in, layer.out, 1, Block::Kind::bias});
    }
    return blocks;
  }
  // W and b ~ U(±1/√in) as PyTorch's; R ~ U[0, 1)/(in·out), real and imaginary part, as published.
  Vector start(RandomStream& stream) const override {
    Vector theta(parameters_);
    for (const Layer& layer : layers_) {
      const Index modes = layer.weights - layer.modes, dense = layer.out * (layer.in + 1);
      const Real bound = 1 / std::sqrt(Real(layer.in));
      theta.segment(layer.modes, modes) =
          stream.uniform_vector(modes, 0, 1 / Real(layer.in * layer.out));
      theta.segment(layer.weights, dense) = stream.uniform_vector(dense, -bound, bound);
    }
    return theta;
  }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    Own& own = sized(w, in.cols());
    own.theta = theta.cast<float>();
    for (Index b = 0; b < in.cols(); ++b)
      pass(own, 0).a.sample(0, b, grid_).reshaped() = in.col(b).cast<float>();
    for (Index l = 0; l <= last(); ++l) {
      Pass& at = pass(own, l);
      if (layer(l).has_modes) fourier_.analyze(kNone, at.a.grids(padded_), at.S, own.room);
      apply(own.theta, layer(l), at.a, at.S, true, 0, at.z, own);
      if (layer(l).is_active)
        gelu(at.z, pass(own, l + 1).a);
      else if (l < last())
        copy_corners(at.z, layer(l).edge, pass(own, l + 1).a, layer(l + 1).edge, own);
    }
    for (Index b = 0; b < in.cols(); ++b)
      x.col(b) = pass(own, last()).z.sample(0, b, grid_).reshaped().cast<Real>();
  }
  // As for the perceptron: ż = Ẇ a + ḃ + K̇ a + W ȧ + K ȧ
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    auto& own = w.as<Own>();
    own.v = v.cast<float>();
    for (Index l = 0; l <= last(); ++l) {
      Pass& at = pass(own, l);
      fit(at.dz, l, own);
      apply(own.v, layer(l), at.a, at.S, true, 0, at.dz, own);
      if (l > 0) {
        if (layer(l).has_modes) fourier_.analyze(kNone, at.da.grids(padded_), at.dS, own.room);
        apply(own.theta, layer(l), at.da, at.dS, false, 1, at.dz, own);
      }
      if (l == last()) break;
      Field& next = pass(own, l + 1).da;
      next.resize(pass(own, l + 1).a.rows(), layer(l + 1).in);
      if (layer(l).is_active) {
        next.all() = at.dz.all();
        multiply_by_gelu_slope(at.z, next, own.chunk);
      } else {
        copy_corners(at.dz, layer(l).edge, next, layer(l + 1).edge, own);
      }
    }
    for (Index b = 0; b < own.samples; ++b)
      Jv.col(b) = pass(own, last()).dz.sample(0, b, grid_).reshaped().cast<Real>();
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    auto& own = w.as<Own>();
    seed(u, pass(own, last()).g, own);
    for (Index l = last(); l >= 0; --l) {
      Pass& at = pass(own, l);
      if (layer(l).has_modes) fourier_.analyze(kInverse, at.g.grids(padded_), at.gS, own.room);
      gather(layer(l), at.g, at.gS, at.a, at.S, true, 0, own);
      if (l == 0) break;
      descend(own.theta, l, {&Pass::g, &Pass::gS, &Pass::of_a, &Pass::g}, 0, own);
      Pass& below = pass(own, l - 1);
      if (layer(l - 1).is_active) multiply_by_gelu_slope(below.z, below.g, own.chunk);
    }
    JTu = own.gradient.cast<Real>();
  }
  // Forward over reverse, as for the perceptron.
  void curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override {
    auto& own = w.as<Own>();
    seed(u, pass(own, last()).g, own);
    seed(du, pass(own, last()).dg, own);
    for (Index l = last(); l >= 0; --l) {
      Pass& at = pass(own, l);
      if (layer(l).has_modes) {
        fourier_.analyze(kInverse, at.g.grids(padded_), at.gS, own.room);
        fourier_.analyze(kInverse, at.dg.grids(padded_), at.dgS, own.room);
      }
      gather(layer(l), at.dg, at.dgS, at.a, at.S, true, 0, own);
      if (l == 0) break;
      gather(layer(l), at.g, at.gS, at.da, at.dS, false, 1, own);
      descend(own.theta, l, {&Pass::g, &Pass::gS, &Pass::of_a, &Pass::g}, 0, own);
      descend(own.v, l, {&Pass::g, &Pass::gS, &Pass::d_of_a, &Pass::dg}, 0, own);
      descend(own.theta, l, {&Pass::dg, &Pass::dgS, &Pass::d_of_a, &Pass::dg}, 1, own);
      if (!layer(l - 1).is_active) continue;
      Pass& below = pass(own, l - 1);
      fit(below.bent, l - 1, own);
      bend(below.z, below.dz, below.g, below.bent);
      multiply_by_gelu_slope(below.z, below.dg, own.chunk);
      below.dg.all() += below.bent.all();
      multiply_by_gelu_slope(below.z, below.g, own.chunk);
    }
    out = own.gradient.cast<Real>();
  }

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
    Array R;  // of one mode, by real numbers
    TruncatedFourier::Room room;
    Flat<float> chunk;
    Parameters theta, v, gradient;
  };
  Eigen::Map<Array> with_bias(Parameters& theta, const Layer& layer) const {
    return {theta.data() + layer.weights, layer.out, layer.in + 1};
  }
  Eigen::Map<Array> weights(Parameters& theta, const Layer& layer) const {
    return {theta.data() + layer.weights, layer.out, layer.in};
  }
  ComplexMap mode(Parameters& theta, const Layer& layer, Index m) const {
    float* begin = theta.data() + layer.modes + 2 * m * layer.in * layer.out;
    return {reinterpret_cast<Complex*>(begin), layer.in, layer.out};
  }
  // The same for real rows: [zᵣ zᵢ] = [aᵣ aᵢ] [Rᵣ Rᵢ; −Rᵢ Rᵣ].
  const Array& real_mode(Parameters& theta, const Layer& layer, Index m, Own& own) const {
    const ComplexMap R = mode(theta, layer, m);
    own.R.resize(2 * layer.in, 2 * layer.out);
    own.R << R.real(), R.imag(), -R.imag(), R.real();
    return own.R;
  }

  Own& sized(Workspace& w, Index samples) const {
    auto& own = w.as<Own>();
    if (own.samples == samples) return own;
    own.samples = samples;
    own.passes.resize(layers_.size());
    own.made.resize(samples * width_, 2 * fourier_.modes());
    own.gradient.resize(parameters_);
    for (Index l = 0; l <= last(); ++l) {
      const Index edge = layer(l).edge;
      pass(own, l).a.resize(edge * edge * samples, layer(l).in);
      fit(pass(own, l).z, l, own);
    }
    // Both coordinates from 0 to 1.
    const Eigen::VectorXf line = Eigen::VectorXf::LinSpaced(grid_, 0, 1);
    for (Index b = 0; b < samples; ++b) {
      own.passes[0].a.sample(1, b, grid_).colwise() = line;
      own.passes[0].a.sample(2, b, grid_).rowwise() = line.transpose();
    }
    return own;
  }
  // to the sum of a layer
  void fit(Field& field, Index l, const Own& own) const {
    field.resize(layer(l).edge * layer(l).edge * own.samples, layer(l).out);
  }
  // z = W a + b + K a with `ones`, W a + K a without; keep z is added.
  void apply(Parameters& theta, const Layer& layer, Field& a, Spectra& S, bool ones, float keep,
             Field& z, Own& own) const {
    if (ones)
      product_by_rows(Form::A_BH, a.with_ones(), with_bias(theta, layer), z.all(), keep);
    else
      product_by_rows(Form::A_BH, a.all(), weights(theta, layer), z.all(), keep);
    if (!layer.has_modes) return;
    for (Index m = 0; m < fourier_.modes(); ++m)
      product_by_rows(Form::A_B, mode_of(S, m, own.samples), real_mode(theta, layer, m, own),
                      mode_of(own.made, m, own.samples));
    fourier_.synthesize(kInverse, own.made, z.grids(layer.edge), own.room);
  }
  // a = Wᵀ g + Kᵀ g + keep a
  void apply_adjoint(Parameters& theta, const Layer& layer, Field& g, Spectra& gS, float keep,
                     Field& a, Own& own) const {
    product(Form::A_B, g.all(), weights(theta, layer), a.all(), keep);
    if (!layer.has_modes) return;
    for (Index m = 0; m < fourier_.modes(); ++m)
      product(Form::A_BH, mode_of(gS, m, own.samples), real_mode(theta, layer, m, own),
              mode_of(own.made, m, own.samples));
    fourier_.synthesize(kNone, own.made, a.grids(layer.edge), own.room);
  }
  // [∂W ∂b] = Σ g [a 1]ᵀ, and R alike, added to `keep` times the previous values
  void gather(const Layer& layer, Field& g, Spectra& gS, Field& a, Spectra& S, bool ones,
              float keep, Own& own) const {
    if (ones)
      product(Form::AH_B, g.all(), a.with_ones(), with_bias(own.gradient, layer), keep);
    else
      product(Form::AH_B, g.all(), a.all(), weights(own.gradient, layer), keep);
    const Index in = layer.in, out = layer.out;
    for (Index m = 0; layer.has_modes && m < fourier_.modes(); ++m) {
      ComplexMap R = mode(own.gradient, layer, m);
      own.R.resize(2 * in, 2 * out);
      product(Form::AH_B, mode_of(S, m, own.samples), mode_of(gS, m, own.samples), own.R);
      if (keep == 0) R.setZero();
      R.real() += own.R.topLeftCorner(in, out) + own.R.bottomRightCorner(in, out);
      R.imag() += own.R.topRightCorner(in, out) - own.R.bottomLeftCorner(in, out);
    }
  }
  // Grids of one layer's edge in those of another's: the near corner, and zeros around it.
  void copy_corners(Field& from, Index from_edge, Field& to, Index to_edge, const Own& own) const {
    const Index edge = std::min(from_edge, to_edge);
    if (to_edge > from_edge) to.all().setZero();
    for (Index c = 0; c < to.columns(); ++c)
      for (Index b = 0; b < own.samples; ++b)
        to.sample(c, b, to_edge).topLeftCorner(edge, edge) =
            from.sample(c, b, from_edge).topLeftCorner(edge, edge);
  }
  // The `from` of layer l back through it, to `to` of the layer below, before the slope.
  struct Descent {
    Field Pass::*from;
    Spectra Pass::*modes;
    Field Pass::*of_a;
    Field Pass::*to;
  };
  void descend(Parameters& theta, Index l, const Descent& path, float keep, Own& own) const {
    Pass &at = pass(own, l), &below = pass(own, l - 1);
    const bool is_level = layer(l).edge == layer(l - 1).edge;
    Field &to = below.*path.to, &a = is_level ? to : at.*path.of_a;
    fit(to, l - 1, own);
    a.resize(at.a.rows(), at.a.columns());
    apply_adjoint(theta, layer(l), at.*path.from, at.*path.modes, keep, a, own);
    if (!is_level) copy_corners(a, layer(l).edge, to, layer(l - 1).edge, own);
  }
  // the cotangent of the last sum
  void seed(BatchRef u, Field& g, const Own& own) const {
    fit(g, last(), own);
    for (Index b = 0; b < own.samples; ++b)
      g.sample(0, b, grid_).reshaped() = u.col(b).cast<float>();
  }
  Pass& pass(Own& own, Index l) const { return own.passes[static_cast<std::size_t>(l)]; }
  const Layer& layer(Index l) const { return layers_[static_cast<std::size_t>(l)]; }
  Index last() const { return static_cast<Index>(layers_.size()) - 1; }

  Index grid_, padded_, width_, parameters_ = 0;
  TruncatedFourier fourier_;
  std::vector<Layer> layers_;
};

FourierOperator::FourierOperator(Index grid, Index modes, Index width)
    : grid_(grid), padded_(grid + kPadding), width_(width), fourier_(padded_, modes) {
  const auto add = [&](Index in, Index out, Index edge, bool has_modes, bool is_active) {
    const Index begin = parameters_;
    if (has_modes) parameters_ += 2 * fourier_.modes() * in * out;  // complex numbers by pairs
    layers_.push_back({in, out, edge, has_modes, is_active, begin, parameters_});
    parameters_ += out * (in + 1);
  };
  add(kChannels, width, grid_, false, false);
  for (Index l = 1; l <= kFourierLayers; ++l) add(width, width, padded_, true, l < kFourierLayers);
  add(width, kHead, grid_, false, true);
  add(kHead, 1, grid_, false, false);
}

struct Options {
  Index modes = 12, width = 32;
};
void fields(Options& o, auto& field) {
  field("modes", o.modes, between(1, 1024), "M, lowest modes kept, of either sign along one axis");
  field("width", o.width, between(1, 1024), "C, channels of the Fourier layers");
}

std::unique_ptr<Network> make_fno(const OptionValues& options, const NetworkShape& shape) {
  const auto o = read_options<Options>(options);
  const Index N = shape.grid, padded = N + FourierOperator::kPadding;
  require(N >= 2 && shape.input_channels == 1 && shape.output_channels == 1,
          "fno requires that both x and y are fields on a grid of at least 2×2 cells");
  require(2 * o.modes <= padded, [&] {
    return fmt::format(
        "fno: twice modes must be at most {}, the number of cells along an edge with padding, got "
        "modes={}",
        padded, o.modes);
  });
  return std::make_unique<FourierOperator>(N, o.modes, o.width);
}

}  // namespace

void register_fno(NetworkRegistry& registry) {
  registry.add({.name = "fno",
                .title = "Fourier neural operator",
                .source = "Li, Kovachki, Azizzadenesheli, Liu, Bhattacharya, Stuart, Anandkumar "
                          "(2021)",
                .note =
                    "The two-dimensional operator of the authors' code with one field as input; "
                    "single precision; dense products compute the modes.",
                .options = option_table<Options>(),
                .make = make_fno});
}

}  // namespace isoline::networks
