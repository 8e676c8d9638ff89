// The lowest modes of real square grids, by products with dense matrices.
#include "networks/fourier_operator.h"

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

// The layers of a Fourier neural operator: K and its adjoint, mode by mode.

namespace {

constexpr Index kChannels = 3;  // the field and both coordinates
constexpr Index kHead = 128;    // width of the hidden layer of the head
constexpr Index kFourierLayers = 4;
constexpr auto kNone = TruncatedFourier::Weights::none;
constexpr auto kInverse = TruncatedFourier::Weights::inverse;

auto mode_of(Gemm<Complex>::Array& S, Index m, Index samples) {  // (B, C)
  return Eigen::Map<Gemm<Complex>::Array>(S.col(m).data(), samples, S.rows() / samples);
}

}  // namespace

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

// R of the two corners of the half spectrum, each (in, out) a mode; then W and b.
std::vector<Block> FourierOperator::layout() const {
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
Vector FourierOperator::start(RandomStream& stream) const {
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

Eigen::Map<FourierOperator::Array> FourierOperator::with_bias(Parameters& theta,
                                                              const Layer& layer) const {
  return {theta.data() + layer.weights, layer.out, layer.in + 1};
}

Eigen::Map<FourierOperator::Array> FourierOperator::weights(Parameters& theta,
                                                            const Layer& layer) const {
  return {theta.data() + layer.weights, layer.out, layer.in};
}

FourierOperator::ComplexMap FourierOperator::mode(Parameters& theta, const Layer& layer,
                                                  Index m) const {
  float* begin = theta.data() + layer.modes + 2 * m * layer.in * layer.out;
  return {reinterpret_cast<Complex*>(begin), layer.in, layer.out};
}

void FourierOperator::apply(Parameters& theta, const Layer& layer, Field& a, Spectra& S, bool ones,
                            float keep, Field& z, Own& own) const {
  if (ones)
    product(Form::A_BH, a.with_ones(), with_bias(theta, layer), z.all(), keep);
  else
    product(Form::A_BH, a.all(), weights(theta, layer), z.all(), keep);
  if (!layer.has_modes) return;
  for (Index m = 0; m < fourier_.modes(); ++m)
    product(Form::A_B, mode_of(S, m, own.samples), mode(theta, layer, m),
            mode_of(own.made, m, own.samples));
  fourier_.synthesize(kInverse, own.made, z.grids(layer.edge), own.room);
}

void FourierOperator::apply_adjoint(Parameters& theta, const Layer& layer, Field& g, Spectra& gS,
                                    float keep, Field& a, Own& own) const {
  product(Form::A_B, g.all(), weights(theta, layer), a.all(), keep);
  if (!layer.has_modes) return;
  for (Index m = 0; m < fourier_.modes(); ++m)
    product(Form::A_BH, mode_of(gS, m, own.samples), mode(theta, layer, m),
            mode_of(own.made, m, own.samples));
  fourier_.synthesize(kNone, own.made, a.grids(layer.edge), own.room);
}

void FourierOperator::gather(const Layer& layer, Field& g, Spectra& gS, Field& a, Spectra& S,
                             bool ones, float keep, Own& own) const {
  if (ones)
    product(Form::AH_B, g.all(), a.with_ones(), with_bias(own.gradient, layer), keep);
  else
    product(Form::AH_B, g.all(), a.all(), weights(own.gradient, layer), keep);
  for (Index m = 0; layer.has_modes && m < fourier_.modes(); ++m)
    product(Form::AH_B, mode_of(S, m, own.samples), mode_of(gS, m, own.samples),
            mode(own.gradient, layer, m), keep);
}

FourierOperator::Own& FourierOperator::sized(Workspace& w, Index samples) const {
  auto& own = w.as<Own>();
  if (own.samples == samples) return own;
  own.samples = samples;
  own.passes.resize(layers_.size());
  own.made.resize(samples * width_, fourier_.modes());
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

void FourierOperator::fit(Field& field, Index l, const Own& own) const {
  field.resize(layer(l).edge * layer(l).edge * own.samples, layer(l).out);
}

void FourierOperator::copy_corners(Field& from, Index from_edge, Field& to, Index to_edge,
                                   const Own& own) const {
  const Index edge = std::min(from_edge, to_edge);
  if (to_edge > from_edge) to.all().setZero();
  for (Index c = 0; c < to.columns(); ++c)
    for (Index b = 0; b < own.samples; ++b)
      to.sample(c, b, to_edge).topLeftCorner(edge, edge) =
          from.sample(c, b, from_edge).topLeftCorner(edge, edge);
}

void FourierOperator::descend(Parameters& theta, Index l, const Descent& path, float keep,
                              Own& own) const {
  Pass &at = pass(own, l), &below = pass(own, l - 1);
  const bool is_level = layer(l).edge == layer(l - 1).edge;
  Field &to = below.*path.to, &a = is_level ? to : at.*path.of_a;
  fit(to, l - 1, own);
  a.resize(at.a.rows(), at.a.columns());
  apply_adjoint(theta, layer(l), at.*path.from, at.*path.modes, keep, a, own);
  if (!is_level) copy_corners(a, layer(l).edge, to, layer(l - 1).edge, own);
}

}  // namespace isoline::networks
