// The multilayer perceptron by name, and the products that methods beyond the gradient ask of it:
// second derivatives, the batch Jacobian and the factors of each layer.
#include <fmt/format.h>

#include <charconv>
#include <string_view>

#include "networks/perceptron.h"

namespace isoline::networks {

// Forward over reverse (Pearlmutter, 1994): with h = W_lᵀ g_l,
//   ġ_{l−1} = s'(z) (Ẇ_lᵀ g_l + W_lᵀ ġ_l) + s''(z) ż h,  (∂W_l)˙ = Σ_b ġ_l aᵀ + g_l ȧᵀ
template <class Scalar>
void Perceptron<Scalar>::curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out,
                                   Workspace& w) const {
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

// ∂y/∂z_{l−1} = (∂y/∂z_l W_l) s'(z_{l−1}) for all rows at once; the columns of W_l are outer
// products with its inputs, and those of b_l are ∂y/∂z_l itself.
template <class Scalar>
void Perceptron<Scalar>::jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const {
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

template <class Scalar>
void Perceptron<Scalar>::layer_factors(BatchRef u, std::vector<LayerFactor>& out,
                                       Workspace& w) const {
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

namespace {

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
              "mlp: layers must be widths from 1 to {} joined by '-', as in 32-64-32, "
              "got '{}'",
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
