// The multilayer perceptron by name, with the products that methods beyond the gradient need:
// second derivatives, the batch Jacobian and the factors of each layer.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/product.h"
#include "core/workspace.h"
#include "networks/activation.h"
#include "networks/network.h"

namespace isoline::networks {
namespace {

// Each sample's row m times, one for each row of the Jacobian that is the sample's.
template <class Array>
void repeat_rows(const Array& from, Index samples, Index m, Array& to) {
  to.resize(whole_registers<typename Array::Scalar>(m * samples), from.cols());
  for (Index c = 0; c < from.cols(); ++c) {
    auto* out = &to(0, c);
    for (Index b = 0; b < samples; ++b)
      for (Index i = 0; i < m; ++i) *out++ = from(b, c);
  }
}

template <class Scalar>
class Perceptron final : public Network {
 public:
  enum class Init { torch, glorot };

  // widths: i, the hidden layers', k
  Perceptron(std::vector<Index> widths, Activation activation, Init init)
      : widths_(std::move(widths)), activation_(activation), init_(init) {}

  Index parameters() const override { return offset(layers()); }
  Index inputs() const override { return widths_.front(); }
  Index outputs() const override { return widths_.back(); }
  bool is_single_precision() const override { return std::is_same_v<Scalar, float>; }
  bool has_kinks() const override { return activation_ == Activation::relu; }
  bool has_curvature() const override { return true; }
  bool has_layer_factors() const override { return true; }

  std::vector<Block> layout() const override {
    std::vector<Block> blocks;
    for (Index l = 0; l < layers(); ++l) {
      const Index weights = width(l + 1) * width(l);
      blocks.push_back({offset(l), width(l + 1), width(l), Block::Kind::weight});
      blocks.push_back({offset(l) + weights, width(l + 1), 1, Block::Kind::bias});
    }
    return blocks;
  }
  // PyTorch's: W and b ~ U(±1/√w_{l−1}). Glorot, Bengio (2010), as Keras has it:
  // W ~ U(±√(6/(w_{l−1} + w_l))), b = 0.
  Vector start(RandomStream& stream) const override {
    Vector theta = Vector::Zero(parameters());
    for (Index l = 0; l < layers(); ++l) {
      const Index in = width(l), out = width(l + 1);
      const bool is_torch = init_ == Init::torch;
      const Real bound = std::sqrt(is_torch ? 1 / Real(in) : 6 / Real(in + out));
      const Index drawn = is_torch ? out * (in + 1) : out * in;
      theta.segment(offset(l), drawn) = stream.uniform_vector(drawn, -bound, bound);
    }
    return theta;
  }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    Passes& own = sized(w, in.cols());
    const Index B = own.samples;
    own.theta = theta.cast<Scalar>();
    own.layers[0].a.topLeftCorner(B, inputs()) = in.transpose().template cast<Scalar>();
    for (Index l = 0; l < layers(); ++l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product_by_rows(Form::A_BH, at->a, with_bias(own.theta, l), at->z);
      const Index k = width(l + 1);
      if (l + 1 < layers()) activate<Scalar>(activation_, flat(at->z, k), flat(at[1].a, k));
    }
    x = own.layers.back().z.topRows(B).transpose().template cast<Real>();
  }
  // ż_l = Ẇ_l a_{l−1} + ḃ_l + W_l ȧ_{l−1},  ȧ_l = s'(z_l) ż_l
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index B = own.samples;
    own.v = v.cast<Scalar>();
    for (Index l = 0; l < layers(); ++l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product_by_rows(Form::A_BH, at->a, with_bias(own.v, l), at->dz);
      if (l > 0) product_by_rows(Form::A_BH, at->da, weights(own.theta, l), at->dz, 1);
      if (l + 1 == layers()) break;
      at[1].da = at->dz;
      slope(*at, at[1].a, at[1].da, at->room);
    }
    Jv = own.layers.back().dz.topRows(B).transpose().template cast<Real>();
  }
  // [∂W_l ∂b_l] = Σ_b g_l [a_{l−1} 1]ᵀ
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index B = own.samples;
    backward(u, own);
    for (Index l = 0; l < layers(); ++l) {
      Layer& at = own.layers[static_cast<std::size_t>(l)];
      product(Form::AH_B, at.g.topRows(B), at.a.topRows(B), with_bias(own.gradient, l));
    }
    JTu = own.gradient.template cast<Real>();
  }
  // Forward over reverse (Pearlmutter, 1994): with h = W_lᵀ g_l,
  //   ġ_{l−1} = s'(z) (Ẇ_lᵀ g_l + W_lᵀ ġ_l) + s''(z) ż h,  (∂W_l)˙ = Σ_b ġ_l aᵀ + g_l ȧᵀ
  void curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index B = own.samples;
    own.layers.back().g.topRows(B) = u.transpose().template cast<Scalar>();
    own.layers.back().dg.topRows(B) = du.transpose().template cast<Scalar>();
    for (Index l = layers() - 1; l >= 0; --l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product(Form::AH_B, at->dg.topRows(B), at->a.topRows(B), with_bias(own.gradient, l));
      if (l == 0) break;
      product(Form::AH_B, at->g.topRows(B), at->da.topRows(B), weights(own.gradient, l), 1);
      Layer& below = at[-1];
      product_by_rows(Form::A_B, at->g, weights(own.theta, l), below.g);
      product_by_rows(Form::A_B, at->g, weights(own.v, l), below.dg);
      product_by_rows(Form::A_B, at->dg, weights(own.theta, l), below.dg, 1);
      slope(below, at->a, below.dg, below.room);
      below.room = below.g.cwiseProduct(below.dz);
      const Index k = width(l);
      multiply_by_bend<Scalar>(activation_, flat(below.z, k), flat(at->a, k), flat(below.room, k));
      below.dg += below.room;
      slope(below, at->a, below.g, below.room);
    }
    out = own.gradient.template cast<Real>();
  }
  // ∂y/∂z_{l−1} = (∂y/∂z_l W_l) s'(z_{l−1}) for all rows at once; the columns of W_l are outer
  // products with its inputs, and those of b_l are ∂y/∂z_l itself.
  void jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index B = own.samples, m = dy_dx.rows(), rows = m * B;
    for (Index l = layers() - 1; l >= 0; --l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      const Index k = width(l + 1);
      at->row_g.resize(whole_registers<Scalar>(rows), k);
      at->row_g.bottomRows(at->row_g.rows() - rows).setZero();
      if (l + 1 == layers()) {
        for (Index b = 0; b < B; ++b)
          at->row_g.middleRows(b * m, m) = dy_dx.middleCols(b * k, k).template cast<Scalar>();
      } else {
        product_by_rows(Form::A_B, at[1].row_g, weights(own.theta, l + 1), at->row_g);
        at->dg.setOnes();
        slope(*at, at[1].a, at->dg, at->room);
        repeat_rows(at->dg, B, m, at->row_slope);
        at->row_g.topRows(rows).array() *= at->row_slope.topRows(rows).array();
      }
      repeat_rows(at->a, B, m, at->row_a);
      for (Index c = 0; c <= width(l); ++c)
        for (Index r = 0; r < k; ++r)
          J.col(offset(l) + c * k + r) =
              at->row_g.col(r).cwiseProduct(at->row_a.col(c)).head(rows).template cast<Real>();
    }
  }
  void layer_factors(BatchRef u, std::vector<LayerFactor>& out, Workspace& w) const override {
    auto& own = w.as<Passes>();
    backward(u, own);
    out.resize(own.layers.size());
    for (Index l = 0; l < layers(); ++l) {
      const Layer& at = own.layers[static_cast<std::size_t>(l)];
      LayerFactor& factor = out[static_cast<std::size_t>(l)];
      factor.weight = 2 * l;
      factor.bias = 2 * l + 1;
      factor.inputs = at.a.topLeftCorner(own.samples, width(l)).transpose().template cast<Real>();
      factor.cotangents = at.g.topRows(own.samples).transpose().template cast<Real>();
    }
  }

 private:
  using Array = typename Gemm<Scalar>::Array;
  using Parameters = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  // The input and output of layer l, (B, ·), its rows padded to whole registers as if by samples of
  // zeros, which no sum over samples reads.
  struct Layer {
    Array a, z;                     // (B, w_{l−1} + 1) inputs and ones, (B, w_l)
    Array da, dz;                   // their change along the last v
    Array g, dg;                    // cotangent of z and its change
    Array room;                     // as z
    Array row_a, row_g, row_slope;  // (m·B, ·) what belongs to each row of the Jacobian
  };
  struct Passes final : Scratch, Pieces {
    void add_choices(PieceDigest& digest) override;

    Activation activation;
    Index samples = -1;  // B that the arrays are allocated for
    std::vector<Layer> layers;
    Parameters theta, v, gradient;
  };

  Index layers() const { return static_cast<Index>(widths_.size()) - 1; }
  Index width(Index l) const { return widths_[static_cast<std::size_t>(l)]; }
  Index offset(Index layer) const {  // of W in θ
    Index sum = 0;
    for (Index l = 0; l < layer; ++l) sum += width(l + 1) * (width(l) + 1);
    return sum;
  }
  // [W b] of layer l, (w_{l+1}, w_l + 1), in θ or in what is shaped like it; W alone.
  auto with_bias(Parameters& theta, Index l) const {
    return Eigen::Map<Array>(theta.data() + offset(l), width(l + 1), width(l) + 1);
  }
  auto weights(Parameters& theta, Index l) const {
    return Eigen::Map<Array>(theta.data() + offset(l), width(l + 1), width(l));
  }
  // The first columns of an array, padding included, as one run of numbers.
  static auto flat(Array& array, Index columns) {
    return Eigen::Map<Flat<Scalar>, Eigen::AlignedMax>(array.data(), array.rows() * columns);
  }
  void slope(Layer& at, Array& next_a, Array& g, Array& room) const {
    const Index k = g.cols();
    multiply_by_slope<Scalar>(activation_, flat(at.z, k), flat(next_a, k), flat(g, k),
                              flat(room, k));
  }

  Passes& sized(Workspace& w, Index samples) const {
    auto& own = w.as<Passes>();
    if (own.samples == samples) return own;
    own.activation = activation_;
    own.samples = samples;
    own.layers.resize(widths_.size() - 1);
    own.gradient.resize(parameters());
    const Index rows = whole_registers<Scalar>(samples);
    for (Index l = 0; l < layers(); ++l) {
      Layer& at = own.layers[static_cast<std::size_t>(l)];
      at.a.setZero(rows, width(l) + 1);
      at.a.rightCols(1).setOnes();
      at.da.setZero(rows, width(l));
      for (Array* array : {&at.z, &at.dz, &at.g, &at.dg, &at.room})
        array->setZero(rows, width(l + 1));
    }
    return own;
  }
  // g_L = u,  g_{l−1} = s'(z_{l−1}) W_lᵀ g_l
  void backward(BatchRef u, Passes& own) const {
    const Index B = own.samples;
    own.layers.back().g.topRows(B) = u.transpose().template cast<Scalar>();
    for (Index l = layers() - 1; l > 0; --l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product_by_rows(Form::A_B, at->g, weights(own.theta, l), at[-1].g);
      slope(at[-1], at->a, at[-1].g, at[-1].room);
    }
  }

  std::vector<Index> widths_;
  Activation activation_;
  Init init_;
};

// For each hidden neuron, the side of its nondifferentiable point.
template <class Scalar>
void Perceptron<Scalar>::Passes::add_choices(PieceDigest& digest) {
  if (activation != Activation::relu) return;
  for (std::size_t l = 0; l + 1 < layers.size(); ++l)
    for (Index j = 0; j < layers[l].z.cols(); ++j)
      for (Index b = 0; b < samples; ++b) digest.add(layers[l].z(b, j) > 0);
}

struct Options {
  std::string layers = "32-64-32", activation = "relu", init = "torch", precision = "float";
};
void fields(Options& o, auto& field) {
  field("layers", o.layers, Choices{}, "widths of the hidden layers, joined by '-'");
  field("activation", o.activation, Choices{"relu", "tanh", "sigmoid", "gelu"},
        "of the hidden layers");
  field("init", o.init, Choices{"torch", "glorot"},
        "weights and biases U(±1/√inputs), or weights U(±√(6/(inputs + outputs))) and biases 0");
  field("precision", o.precision, Choices{"float", "double"}, "of the network's arithmetic");
}

std::vector<Index> widths_of(const Options& o, const NetworkShape& shape) {
  constexpr Index kWidest = 100'000;  // a layer of twice that would have 4e10 weights
  std::vector<Index> widths{shape.inputs};
  for (std::size_t begin = 0; begin <= o.layers.size();) {
    const std::string_view rest = std::string_view(o.layers).substr(begin);
    const std::string_view text = rest.substr(0, rest.find('-'));
    Index width = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
    require(
        error == std::errc{} && end == text.data() + text.size() && 1 <= width && width <= kWidest,
        [&] {
          return fmt::format(
              "mlp: layers must be widths from 1 to {} joined by '-', as in 32-64-32, got '{}'",
              kWidest, o.layers);
        });
    widths.push_back(width);
    begin += text.size() + 1;
  }
  widths.push_back(shape.outputs);
  return widths;
}

template <class Scalar>
std::unique_ptr<Network> make_as(const Options& o, const NetworkShape& shape) {
  using Init = typename Perceptron<Scalar>::Init;
  const Activation activation = o.activation == "relu"      ? Activation::relu
                                : o.activation == "tanh"    ? Activation::tanh
                                : o.activation == "sigmoid" ? Activation::sigmoid
                                                            : Activation::gelu;
  return std::make_unique<Perceptron<Scalar>>(widths_of(o, shape), activation,
                                              o.init == "torch" ? Init::torch : Init::glorot);
}

std::unique_ptr<Network> make_mlp(const OptionValues& options, const NetworkShape& shape) {
  const auto o = read_options<Options>(options);
  return o.precision == "float" ? make_as<float>(o, shape) : make_as<double>(o, shape);
}

}  // namespace

void register_mlp(NetworkRegistry& registry) {
  registry.add({.name = "mlp",
                .title = "Multilayer perceptron",
                .source = "Rumelhart, Hinton, Williams (1986)",
                .note = "Linear output; initial distributions of PyTorch and Keras.",
                .options = option_table<Options>(),
                .make = make_mlp});
}

}  // namespace isoline::networks
