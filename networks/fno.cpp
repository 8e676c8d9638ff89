// The Fourier neural operator by name, and its passes over the layers.
#include <fmt/format.h>

#include "networks/fourier_operator.h"

namespace isoline::networks {
namespace {

constexpr auto kGelu = Activation::gelu;
constexpr auto kNone = TruncatedFourier::Weights::none;
constexpr auto kInverse = TruncatedFourier::Weights::inverse;

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

}  // namespace

void FourierOperator::forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const {
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
void FourierOperator::pushforward(VectorRef v, BatchOut Jv, Workspace& w) const {
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

void FourierOperator::seed(BatchRef u, Field& g, const Own& own) const {
  fit(g, last(), own);
  for (Index b = 0; b < own.samples; ++b) g.sample(0, b, grid_).reshaped() = u.col(b).cast<float>();
}

void FourierOperator::pullback(BatchRef u, VectorOut JTu, Workspace& w) const {
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
void FourierOperator::curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out,
                                Workspace& w) const {
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

namespace {

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
          "fno: it maps one field to another, both on a grid of at least 2×2 cells");
  require(2 * o.modes <= padded, [&] {
    return fmt::format(
        "fno: 2 modes must be at most {}, the cells along an edge with padding, "
        "got modes={}",
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
