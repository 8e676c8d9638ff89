// The arrays of a U-net: vectors of samples, grids with margins, where each parameter stands, and
// all that one pass keeps for the next; then its passes over a batch, and what they share: the
// input of a unit, made from the outputs z of earlier ones while these are in cache. Each task
// processes a few samples.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/convolution.h"
#include "networks/network.h"

namespace isoline::networks {

using Lane = float __attribute__((vector_size(4 * kChannels)));
using Wide = double __attribute__((vector_size(8 * kChannels)));  // long sums of lanes
using Mask = int __attribute__((vector_size(4 * kChannels)));

// The element type of arrays of pixels, for its alignment.
struct alignas(4 * kChannels) Pixel {
  float channel[kChannels];
};

template <class T>
struct Dual {
  T value{}, tangent{};

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.tangent + b.tangent};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.tangent - b.tangent};
  }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.tangent}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.tangent + a.tangent * b.value};
  }
  friend Dual operator*(float c, const Dual& a) { return {c * a.value, c * a.tangent}; }
};
using DualLane = Dual<Lane>;

template <class T>
inline constexpr bool kIsDual = false;
template <class T>
inline constexpr bool kIsDual<Dual<T>> = true;

inline const Lane& value_of(const Lane& x) { return x; }
inline const Lane& value_of(const DualLane& x) { return x.value; }

// A pullback computes the value, or with duals its derivative.
inline const Lane& asked_of(const Lane& x) { return x; }
inline const Lane& asked_of(const DualLane& x) { return x.tangent; }

inline Lane choose(const Mask& mask, const Lane& a, const Lane& b) { return mask ? a : b; }
inline DualLane choose(const Mask& mask, const DualLane& a, const DualLane& b) {
  return {mask ? a.value : b.value, mask ? a.tangent : b.tangent};
}
template <class T>
T keep(const Mask& mask,
       const T& x) {  // 0 elsewhere; at a nondifferentiable point the derivative is 0
  return choose(mask, x, T{});
}
template <class T>
Mask is_positive(const T& x) {
  return value_of(x) > 0;
}

inline void accumulate(const Lane& x, Wide& sum) { sum += __builtin_convertvector(x, Wide); }

// An array of pixels and, where there are any, their tangents.
struct Place {
  float* value = nullptr;
  float* tangent = nullptr;

  Place operator+(Index pixels) const {
    const Index offset = pixels * kChannels;
    return {value + offset, tangent ? tangent + offset : nullptr};
  }
};

inline auto& lane(float* array, Index pixel) {
  using LaneOfFloats = float __attribute__((vector_size(4 * kChannels), may_alias));
  return *reinterpret_cast<LaneOfFloats*>(array + pixel * kChannels);
}

template <class T>
T load(const Place& place, Index pixel) {
  if constexpr (kIsDual<T>)
    return T{lane(place.value, pixel), lane(place.tangent, pixel)};
  else
    return T(lane(place.value, pixel));
}

template <class T>
void store(const Place& place, Index pixel, const T& x) {
  lane(place.value, pixel) = value_of(x);
  if constexpr (kIsDual<T>) lane(place.tangent, pixel) = x.tangent;
}

// The operations of a U-net on one N×N grid of pixels besides convolution: halos, pooling,
// upsampling, and their transposes. A grid is [column][row], and lies within a halo of one where
// `halo` says so.

struct Grid {
  Index N, halo = 0;

  Index width() const { return N + 2 * halo; }
  Index pixels() const { return width() * width(); }
  Index at(Index column, Index row) const { return (column + halo) * width() + row + halo; }
};

// Rows first, then whole columns: the corners come along.
template <class Element>
void fill_halo(Element* image, Index N, bool is_circular) {
  const Index width = N + 2;
  const auto copy = [&](Index to, Index from, Index count) {
    if (is_circular)
      std::copy_n(image + from, count, image + to);
    else
      std::fill_n(image + to, count, Element{});
  };
  for (Index column = 1; column <= N; ++column) {
    copy(column * width, column * width + N, 1);
    copy(column * width + N + 1, column * width + 1, 1);
  }
  copy(0, N * width, width);
  copy((N + 1) * width, width, width);
}

// relu(scale z + shift): the pixels of z after batch norm and rectifier.
template <class T>
struct Activated {
  Place z;
  T scale, shift;

  T normalized(Index pixel) const { return scale * load<T>(z, pixel) + shift; }
  T operator()(Index pixel) const {
    const T y = normalized(pixel);
    return keep(is_positive(y), y);
  }
};

template <class T>
void activate(const Activated<T>& a, const Place& out, const Grid& grid) {
  for (Index column = 0; column < grid.N; ++column)
    for (Index row = 0; row < grid.N; ++row)
      store(out, grid.at(column, row), a(column * grid.N + row));
}

// The four pixels of a grid twice as fine.
inline std::array<Index, 4> finer(Index N, Index column, Index row) {
  const Index first = 2 * column * 2 * N + 2 * row, next = first + 2 * N;
  return {first, first + 1, next, next + 1};
}

// The largest of each four; of equals the first.
template <class T>
void pool(const Activated<T>& a, const Place& out, const Grid& grid) {
  for (Index column = 0; column < grid.N; ++column)
    for (Index row = 0; row < grid.N; ++row) {
      const auto four = finer(grid.N, column, row);
      T best = a(four[0]);
      for (int k = 1; k < 4; ++k) {
        const T x = a(four[k]);
        best = choose(value_of(x) > value_of(best), x, best);
      }
      store(out, grid.at(column, row), best);
    }
}

// The transpose of pool: fine pixel ← coarse cotangent where it was the largest, else 0.
template <class T>
void unpool(const Activated<T>& a, const Place& coarse, const Place& fine, Index N) {
  for (Index column = 0; column < N; ++column)
    for (Index row = 0; row < N; ++row) {
      const auto four = finer(N, column, row);
      Lane y[4], best = {};
      for (int k = 0; k < 4; ++k) {
        y[k] = value_of(a(four[k]));
        best = choose(y[k] > best, y[k], best);
      }
      const T cotangent = load<T>(coarse, column * N + row);
      Mask is_free = best == best;
      for (int k = 0; k < 4; ++k) {
        const Mask is_largest = is_free & (y[k] == best);
        store(fine, four[k], keep(is_largest, cotangent));
        is_free &= ~is_largest;
      }
    }
}

// Twice as fine, bilinear between pixel centres (align_corners = false), clamped at the border:
// ¾ of the nearest and ¼ of the next. `grid` is the fine one.
template <class T>
void upsample(const Place& coarse, const Place& out, const Grid& grid) {
  const Index N = grid.N / 2;
  const auto next = [N](Index i) {
    return std::clamp(i % 2 ? i / 2 + 1 : i / 2 - 1, Index{0}, N - 1);
  };
  for (Index column = 0; column < grid.N; ++column) {
    const Place near = coarse + column / 2 * N, far = coarse + next(column) * N;
    for (Index row = 0; row < grid.N; ++row) {
      const T close = 0.75F * load<T>(near, row / 2) + 0.25F * load<T>(near, next(row));
      const T distant = 0.75F * load<T>(far, row / 2) + 0.25F * load<T>(far, next(row));
      store(out, grid.at(column, row), 0.75F * close + 0.25F * distant);
    }
  }
}

// The transpose of upsample, from 2N×2N to N×N: each coarse pixel gathers from four fine columns
// and rows; beyond the border stands the border itself.
template <class T>
void downsample(const Place& fine, const Place& coarse, Index N) {
  constexpr float kWeights[4] = {0.25F, 0.75F, 0.75F, 0.25F};
  const auto clamped = [N](Index i) { return std::clamp(i, Index{0}, 2 * N - 1); };
  for (Index column = 0; column < N; ++column)
    for (Index row = 0; row < N; ++row) {
      T sum{};
      for (Index i = 0; i < 4; ++i) {
        const Place from = fine + clamped(2 * column - 1 + i) * 2 * N;
        T along{};
        for (Index j = 0; j < 4; ++j)
          along = along + kWeights[j] * load<T>(from, clamped(2 * row - 1 + j));
        sum = sum + kWeights[i] * along;
      }
      store(coarse, column * N + row, sum);
    }
}

// The structure of a U-net: its units in order, and the places of their parameters in θ.

struct UnetOptions {
  Index levels = 4, filters = 16;
  std::string padding = "circular";
};

void fields(UnetOptions& o, auto& field) {
  field("levels", o.levels, between(1, 10), "resolutions, each half as fine as the one before");
  field("filters", o.filters, between(1, 1024), "channels of every level");
  field("padding", o.padding, {"circular", "zero"}, "what lies beyond the border of a grid");
}

// One 3×3 convolution, batch norm and rectifier. Its input is the network's; or the activation of
// unit `from`; or that, pooled; or that of unit `skip` beside that of `from`, upsampled.
struct Unit {
  enum class Source { input, activation, pooled, joined };
  Source source;
  Index from, skip, level;
  Index in;      // channels
  Index offset;  // in θ, as PyTorch lists it: kernel (out, in, 3, 3), biases, γ, β
};

// Channels in memory come in whole blocks; those beyond the network's own are zero throughout.
struct UnetPlan {
  Index N, input_channels, output_channels, levels, filters;
  bool is_circular;
  std::vector<Unit> units;
  Index parameters;

  UnetPlan(const UnetOptions& options, const NetworkShape& shape);

  Index blocks() const { return (filters + kChannels - 1) / kChannels; }  // a unit's output
  Index channels() const { return blocks() * kChannels; }
  Index channels_in(const Unit& unit) const;  // in memory
  Index kernel_size(const Unit& unit) const { return channels() * channels_in(unit) * 9; }
  Index size(Index level) const { return N >> level; }

  Index biases(const Unit& unit) const { return unit.offset + filters * unit.in * 9; }
  Index norm(const Unit& unit) const { return biases(unit) + filters; }  // γ, then β
  Index output_biases() const { return parameters - output_channels; }
  Index output() const { return parameters - output_channels * (filters + 1); }

  std::vector<Block> layout() const;
  Vector start(RandomStream& stream) const;

  // Where channel i of a unit's input lies: each half of two that are joined has its own blocks.
  Index in_memory(const Unit& unit, Index i) const {
    const bool is_second = unit.source == Unit::Source::joined && i >= filters;
    return is_second ? channels() + i - filters : i;
  }

  // Calls visit(in θ, in the kernel, in the kernel of the transpose) for every weight of a unit.
  template <class Visit>
  void for_each_weight(const Unit& unit, Visit visit) const {
    const bool is_plain = unit.source == Unit::Source::input;
    const Index in = channels_in(unit), width = is_plain ? in : kChannels;
    for (Index o = 0; o < filters; ++o)
      for (Index i = 0; i < unit.in; ++i) {
        const Index c = in_memory(unit, i);
        for (Index tap = 0; tap < 9; ++tap)
          visit(unit.offset + (o * unit.in + i) * 9 + tap, position(o, c, tap, in, width),
                position(c, o, 8 - tap, channels(), kChannels));
      }
  }

 private:
  // The place of a weight in the layout of core/convolution.h, by blocks of `width` channels in.
  static Index position(Index out, Index in, Index tap, Index all_in, Index width) {
    const Index block = out / kChannels * (all_in / width) + in / width;
    return ((block * 9 + tap) * width + in % width) * kChannels + out % kChannels;
  }
};

// A U-net's workspace: the convolutions' outputs z, from which everything else is recomputed while
// z is in cache; kernels in their layout; the batch norms; and for each thread its arrays and
// convolutions. Tangents are kept after their first use.

// Pixels, and their tangents once there are any.
struct Pixels {
  std::vector<Pixel> value, tangent;

  void resize(Index pixels, bool has_tangent) {
    value.resize(pixels);
    if (has_tangent) tangent.resize(pixels);
  }
  Place place() { return {array(value), array(tangent)}; }

 private:
  static float* array(std::vector<Pixel>& pixels) {
    return pixels.empty() ? nullptr : pixels.front().channel;
  }
};

// Batch norm y = γ x̂ + β, x̂ = (z − μ)/σ (Ioffe and Szegedy 2015), its pullback to z and the
// derivatives of both, as coefficients of z and of the cotangent g of y, channel by channel:
// y = scale z + shift; x̂ = inverse z + centre; cotangent of z = scale g + slope z + offset.
struct Norm {
  enum Coefficient { scale, shift, inverse, centre, slope, offset, count };
  struct alignas(4 * kChannels) Coefficients {
    float value[count][kChannels], tangent[count][kChannels];
  };
  using Number = Dual<Real>;

  std::vector<Number> gamma, beta, mean, deviation;  // (channels); deviation: 1/σ
  std::vector<Coefficients> blocks;

  void resize(Index channels);
  void set(Coefficient which, Index channel, const Number& x) {
    Coefficients& block = blocks[channel / kChannels];
    block.value[which][channel % kChannels] = static_cast<float>(x.value);
    block.tangent[which][channel % kChannels] = static_cast<float>(x.tangent);
  }
  // From γ, β, μ, 1/σ.
  void set_forward(Index channel);
  // From the means of g and g x̂ too.
  void set_pullback(Index channel, const Number& mean_g, const Number& mean_g_x);

  template <class T>
  T at(Coefficient which, Index block) {
    return load<T>({blocks[block].value[which], blocks[block].tangent[which]}, 0);
  }
};

struct UnitState {
  Pixels z;                   // (samples · blocks · N²)
  Pixels kernel, transposed;  // the transpose is what cotangents are convolved with
  Norm norm;
};

// The convolutions of a unit for one thread.
struct UnitCalls {
  Convolution forward, forward_adds;
  std::optional<Convolution> backward, backward_adds;  // none to the network's input
  // With z within its halo as input: that of the transpose. For the first unit: of the kernel.
  KernelGradient gradient;
};

struct ThreadState {
  std::vector<UnitCalls> calls;  // one per unit
  Pixels in, cotangent_in, cotangent_z, spare;
};

// Scratch arrays for the second moments of one unit.
struct MomentRoom {
  std::vector<std::vector<Pixel>> patches;  // patches of a task, one array per thread
  std::vector<Pixel> inputs, cotangents;    // sums of each task's outer products
};

struct UnetState : Scratch {
  Index samples = 0;
  bool has_tangents = false;
  std::vector<UnitState> units;
  std::vector<Pixels> cotangents;  // one a level: of the activation that is due
  std::vector<float> input;        // (samples · channels · (N+2)²), the only one that is plain
  Pixels output;                   // the last kernel, 1×1: (output channels · blocks)
  std::vector<Dual<Real>> output_biases;
  std::vector<ThreadState> threads;
  std::vector<Pixel> kernel_parts;  // gradients of one kernel, task by task
  std::vector<Wide> kernel_sum;     // of them all
  std::vector<Wide> sums;           // what a batch norm adds up, task by task
  std::vector<Wide> output_parts;   // gradients of the last kernel, sample by sample
  MomentRoom moments;

  // Makes everything ready for so many samples; does nothing where it is.
  void fit(const UnetPlan& plan, Index batch, bool with_tangents);
  // The values or the tangents of all parameters.
  void set(const UnetPlan& plan, VectorRef theta, float* Place::*array, Real Dual<Real>::*number);

  // Samples are taken so many at a time, a divisor of all of them.
  Index samples_a_task(const UnetPlan& plan, Index level) const;

 private:
  ThreadState make_thread(const UnetPlan& plan) const;
};

// All z of the batch, and the norms by its statistics, or by given ones (2 · filters · units).
void unet_forward(const UnetPlan& plan, UnetState& state, BatchRef in);
void unet_infer(const UnetPlan& plan, UnetState& state, VectorRef theta, VectorRef statistics,
                BatchRef in);
void unet_output(const UnetPlan& plan, UnetState& state, BatchOut x);

// Tangents of all z and norms, from those of the kernels.
void unet_pushforward(const UnetPlan& plan, UnetState& state, BatchOut Jv);

// The gradient under u; with du also, its derivative along the tangents of the last pushforward.
// `watch` sees each unit from the last when its g is complete.
struct UnitPass;
using WatchUnit = std::function<void(const UnitPass&)>;
void unet_pullback(const UnetPlan& plan, UnetState& state, BatchRef u, VectorOut out,
                   const WatchUnit& watch = {});
void unet_curvature(const UnetPlan& plan, UnetState& state, BatchRef u, BatchRef du, VectorOut out);

// The moments of every convolution under u, the 1×1 at the end too, and the gradient.
void unet_layer_moments(const UnetPlan& plan, UnetState& state, BatchRef u,
                        std::vector<LayerMoments>& moments, VectorOut out);

// Mean and variance of each unit's channels; the mean is that of z with its bias.
Vector unet_statistics(const UnetPlan& plan, UnetState& state, VectorRef theta);

// The data of a pass over one unit.
struct UnitPass {
  const UnetPlan& plan;
  UnetState& state;
  Index index;
  const Unit& unit = plan.units[index];
  UnitState& own = state.units[index];
  Index N = plan.size(unit.level), blocks = plan.blocks();
  Index images = state.samples_a_task(plan, unit.level);  // a task
  Index tasks = state.samples / images;

  Index blocks_in() const { return plan.channels_in(unit) / kChannels; }
  Place z(Index task) const { return own.z.place() + task * images * blocks * N * N; }
  const float* plain_input(Index task) const {
    return state.input.data() + task * images * plan.input_channels * (N + 2) * (N + 2);
  }
  // A number of the whole batch, of which each task gives its part.
  Wide& sum(Index task, Index block, Index which) const {
    return state.sums[(task * blocks + block) * 4 + which];
  }
  Real total(Index channel, Index which) const {
    Real sum_of_tasks = 0;
    for (Index task = 0; task < tasks; ++task)
      sum_of_tasks += sum(task, channel / kChannels, which)[channel % kChannels];
    return sum_of_tasks;
  }
  Real pixels() const { return static_cast<Real>(state.samples * N * N); }
};

template <class T>
Activated<T> activated(const UnetPlan& plan, UnetState& state, Index unit, Index sample,
                       Index block) {
  UnitState& from = state.units[unit];
  const Index N = plan.size(plan.units[unit].level);
  return {from.z.place() + (sample * plan.blocks() + block) * N * N,
          from.norm.at<T>(Norm::scale, block), from.norm.at<T>(Norm::shift, block)};
}

// One block of the input of a unit that is not the first.
template <class T>
void assemble_block(const UnitPass& pass, Index sample, Index block, const Place& out,
                    const Grid& grid, ThreadState& thread) {
  const Unit& unit = pass.unit;
  if (block < pass.blocks && unit.source == Unit::Source::joined)
    return activate(activated<T>(pass.plan, pass.state, unit.skip, sample, block), out, grid);
  const auto a = activated<T>(pass.plan, pass.state, unit.from, sample, block % pass.blocks);
  if (unit.source == Unit::Source::activation) return activate(a, out, grid);
  if (unit.source == Unit::Source::pooled) return pool(a, out, grid);
  activate(a, thread.spare.place(), Grid{grid.N / 2});
  upsample<T>(thread.spare.place(), out, grid);
}

inline void fill_halos(const Place& image, const Grid& grid, bool is_circular, bool has_tangent) {
  if (grid.halo == 0) return;
  const auto fill = [&](float* array) {
    fill_halo(reinterpret_cast<Pixel*>(array), grid.N, is_circular);
  };
  fill(image.value);
  if (has_tangent) fill(image.tangent);
}

// The whole input of a task, into thread.in.
template <class T>
Place assemble(const UnitPass& pass, Index task, Index halo, ThreadState& thread) {
  const Grid grid{pass.N, halo};
  const Index count = pass.blocks_in();
  for (Index image = 0; image < pass.images; ++image)
    for (Index block = 0; block < count; ++block) {
      const Place out = thread.in.place() + (image * count + block) * grid.pixels();
      assemble_block<T>(pass, task * pass.images + image, block, out, grid, thread);
      fill_halos(out, grid, pass.plan.is_circular, kIsDual<T>);
    }
  return thread.in.place();
}

}  // namespace isoline::networks
