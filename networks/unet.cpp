// U-net (Ronneberger, Fischer, Brox 2015, fig. 1), as in PhiFlow 2.2: `levels` resolutions of
// `filters` channels each. A double convolution is twice 3×3 convolution, batch norm, rectifier;
// down by maximum pooling, up by bilinear interpolation beside the skipped level, out by a 1×1
// convolution. Batch norm always uses the statistics of the batch it is given. Deviations: none in
// exact arithmetic; a convolution's bias, which batch norm removes, has the gradient 0, not noise.
#include <fmt/format.h>

#include <cmath>

#include "core/errors.h"
#include "core/threads.h"
#include "networks/unet/passes.h"

namespace isoline::networks {
namespace {

using Source = Unit::Source;

std::vector<Unit> units_of(Index levels, Index filters, Index input_channels) {
  std::vector<Unit> units;
  const auto add = [&](Source source, Index level, Index in, Index skip = 0) {
    const Index from = static_cast<Index>(units.size()) - 1;
    units.push_back({source, from, skip, level, in, 0});
  };
  add(Source::input, 0, input_channels);
  add(Source::activation, 0, filters);
  for (Index level = 1; level < levels; ++level) {
    add(Source::pooled, level, filters);
    add(Source::activation, level, filters);
  }
  for (Index level = levels - 2; level >= 0; --level) {
    add(Source::joined, level, 2 * filters, 2 * level + 1);
    add(Source::activation, level, filters);
  }
  return units;
}

}  // namespace

UnetPlan::UnetPlan(const UnetOptions& options, const NetworkShape& shape)
    : N(shape.grid),
      input_channels(shape.input_channels),
      output_channels(shape.output_channels),
      levels(options.levels),
      filters(options.filters),
      is_circular(options.padding == "circular") {
  require(shape.grid > 0, [&] {
    return "unet: the samples must be grids, got columns of " + std::to_string(shape.inputs) +
           " numbers";
  });
  const Index step = Index{1} << (options.levels - 1);
  require(shape.grid % step == 0, [&] {
    return fmt::format("unet: with levels={}, N must be a multiple of {}, got {}", options.levels,
                       step, shape.grid);
  });
  units = units_of(levels, filters, input_channels);
  Index offset = 0;
  for (Unit& unit : units) {
    unit.offset = offset;
    offset += filters * (9 * unit.in + 3);
  }
  parameters = offset + output_channels * (filters + 1);
}

Index UnetPlan::channels_in(const Unit& unit) const {
  if (unit.source == Source::input) return unit.in;
  return unit.source == Source::joined ? 2 * channels() : channels();
}

std::vector<Block> UnetPlan::layout() const {
  std::vector<Block> blocks;
  for (const Unit& unit : units) {
    blocks.push_back({unit.offset, 9, unit.in * filters, Block::Kind::convolution});
    blocks.push_back({biases(unit), filters, 1, Block::Kind::bias});
    blocks.push_back({norm(unit), filters, 1, Block::Kind::norm});
    blocks.push_back({norm(unit) + filters, filters, 1, Block::Kind::norm});
  }
  blocks.push_back({output(), 1, filters * output_channels, Block::Kind::convolution});
  blocks.push_back({output_biases(), output_channels, 1, Block::Kind::bias});
  return blocks;
}

// U(±1/√fan_in) for kernels and biases (PyTorch's default), γ = 1, β = 0.
Vector UnetPlan::start(RandomStream& stream) const {
  Vector theta(parameters);
  const auto draw = [&](Index offset, Index count, Index fan_in) {
    const Real bound = 1 / std::sqrt(static_cast<Real>(fan_in));
    theta.segment(offset, count) = stream.uniform_vector(count, -bound, bound);
  };
  for (const Unit& unit : units) {
    draw(unit.offset, filters * (9 * unit.in + 1), 9 * unit.in);
    theta.segment(norm(unit), filters).setOnes();
    theta.segment(norm(unit) + filters, filters).setZero();
  }
  draw(output(), output_channels * (filters + 1), filters);
  return theta;
}

// A U-net's workspace: sizes, kernels and batch norms.

// A task of about this many pixels stays in a core's cache and outweighs the call of oneDNN.
constexpr Index kPixelsATask = 1024;

void Norm::resize(Index channels) {
  for (auto* numbers : {&gamma, &beta, &mean, &deviation}) numbers->resize(channels);
  blocks.resize(channels / kChannels);
}

void Norm::set_forward(Index c) {
  const Number factor = gamma[c] * deviation[c];
  set(scale, c, factor);
  set(shift, c, beta[c] - factor * mean[c]);
  set(inverse, c, deviation[c]);
  set(centre, c, -(deviation[c] * mean[c]));
}

void Norm::set_pullback(Index c, const Number& mean_g, const Number& mean_g_x) {
  const Number factor = gamma[c] * deviation[c];
  const Number along = -(factor * deviation[c] * mean_g_x);
  set(slope, c, along);
  set(offset, c, -(factor * mean_g + along * mean[c]));
}

Index UnetState::samples_a_task(const UnetPlan& plan, Index level) const {
  const Index N = plan.size(level);
  Index count = std::clamp(kPixelsATask / (N * N), Index{1}, samples);
  while (samples % count != 0) --count;
  return count;
}

ThreadState UnetState::make_thread(const UnetPlan& plan) const {
  ThreadState thread;
  Index in = 0, z = 0;
  const Index channels = plan.channels();
  for (const Unit& unit : plan.units) {
    const Index images = samples_a_task(plan, unit.level), N = plan.size(unit.level);
    const bool is_first = unit.source == Unit::Source::input;
    const ConvolutionShape there{images, plan.channels_in(unit), channels, N, is_first};
    const ConvolutionShape back{images, channels, plan.channels_in(unit), N};
    thread.calls.push_back({.forward = Convolution(there, false),
                            .forward_adds = Convolution(there, true),
                            .gradient = KernelGradient(is_first ? there : back)});
    if (!is_first) {
      thread.calls.back().backward.emplace(back, false);
      thread.calls.back().backward_adds.emplace(back, true);
      in = std::max(in, images * plan.channels_in(unit) / kChannels * Grid{N, 1}.pixels());
    }
    z = std::max(z, images * plan.blocks() * Grid{N, 1}.pixels());
  }
  thread.in.resize(in, has_tangents);
  thread.cotangent_in.resize(in, has_tangents);
  thread.cotangent_z.resize(z, has_tangents);
  thread.spare.resize(Grid{plan.N}.pixels(), has_tangents);
  return thread;
}

void UnetState::fit(const UnetPlan& plan, Index batch, bool with_tangents) {
  const Index wanted = library_threads();
  const bool is_grown = batch != samples || (with_tangents && !has_tangents);
  if (!is_grown && wanted <= static_cast<Index>(threads.size())) return;
  samples = batch;
  has_tangents = has_tangents || with_tangents;
  const Index blocks = plan.blocks();
  units.resize(plan.units.size());
  cotangents.resize(plan.levels);
  Index largest = 0, parts = 0, most = 0;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const Unit& unit = plan.units[i];
    const Index N = plan.size(unit.level), tasks = samples / samples_a_task(plan, unit.level);
    const Index kernel = plan.kernel_size(unit) / kChannels;
    units[i].z.resize(samples * blocks * N * N, has_tangents);
    units[i].kernel.resize(kernel, has_tangents);
    units[i].transposed.resize(kernel, has_tangents);
    units[i].norm.resize(plan.channels());
    cotangents[unit.level].resize(samples * blocks * N * N, has_tangents);
    largest = std::max(largest, kernel);
    parts = std::max(parts, tasks * kernel * (has_tangents ? 2 : 1));
    most = std::max(most, tasks);
  }
  input.resize(samples * plan.input_channels * Grid{plan.N, 1}.pixels());
  output.resize(plan.output_channels * blocks, has_tangents);
  output_biases.resize(plan.output_channels);
  kernel_parts.resize(parts);
  kernel_sum.resize(largest);
  sums.resize(most * blocks * 4);
  output_parts.resize(samples * plan.output_channels * blocks);
  threads.clear();
  for (Index i = 0; i < wanted; ++i) threads.push_back(make_thread(plan));
}

void UnetState::set(const UnetPlan& plan, VectorRef theta, float* Place::*array,
                    Real Dual<Real>::*number) {
  for (std::size_t i = 0; i < units.size(); ++i) {
    const Unit& unit = plan.units[i];
    float* const kernel = units[i].kernel.place().*array;
    float* const transposed = units[i].transposed.place().*array;
    plan.for_each_weight(unit, [&](Index weight, Index at, Index at_transposed) {
      kernel[at] = static_cast<float>(theta[weight]);
      if (unit.source != Unit::Source::input) transposed[at_transposed] = kernel[at];
    });
    for (Index c = 0; c < plan.filters; ++c) {
      units[i].norm.gamma[c].*number = theta[plan.norm(unit) + c];
      units[i].norm.beta[c].*number = theta[plan.norm(unit) + plan.filters + c];
    }
  }
  for (Index o = 0; o < plan.output_channels; ++o) {
    output_biases[o].*number = theta[plan.output_biases() + o];
    for (Index c = 0; c < plan.filters; ++c)
      (output.place().*array)[o * plan.channels() + c] =
          static_cast<float>(theta[plan.output() + o * plan.filters + c]);
  }
}

namespace {

class Unet final : public Network {
 public:
  Unet(const UnetOptions& options, const NetworkShape& shape) : plan_(options, shape) {}

  Index parameters() const override { return plan_.parameters; }
  Index inputs() const override { return plan_.input_channels * plan_.N * plan_.N; }
  Index outputs() const override { return plan_.output_channels * plan_.N * plan_.N; }
  Vector start(RandomStream& stream) const override { return plan_.start(stream); }
  std::vector<Block> layout() const override { return plan_.layout(); }
  bool has_independent_samples() const override { return false; }
  bool is_single_precision() const override { return true; }
  bool has_kinks() const override { return true; }
  bool has_curvature() const override { return true; }
  bool has_layer_moments() const override { return true; }

  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_forward(plan_, state, in);
    unet_output(plan_, state, x);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    UnetState& state = w.as<UnetState>();
    state.fit(plan_, state.samples, true);
    state.set(plan_, v, &Place::tangent, &Dual<Real>::tangent);
    unet_pushforward(plan_, state, Jv);
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    unet_pullback(plan_, w.as<UnetState>(), u, JTu);
  }
  void curvature(VectorRef, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override {
    unet_curvature(plan_, w.as<UnetState>(), u, du, out);
  }
  void layer_moments(BatchRef u, std::vector<LayerMoments>& out, VectorOut JTu,
                     Workspace& w) const override {
    unet_layer_moments(plan_, w.as<UnetState>(), u, out, JTu);
  }
  Vector statistics(VectorRef theta, BatchRef in, Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_forward(plan_, state, in);
    return unet_statistics(plan_, state, theta);
  }
  void infer(VectorRef theta, VectorRef statistics, BatchRef in, BatchOut x,
             Workspace& w) const override {
    UnetState& state = ready(theta, in, w);
    unet_infer(plan_, state, theta, statistics, in);
    unet_output(plan_, state, x);
  }

 private:
  UnetState& ready(VectorRef theta, BatchRef in, Workspace& w) const {
    UnetState& state = w.as<UnetState>();
    state.fit(plan_, in.cols(), false);
    state.set(plan_, theta, &Place::value, &Dual<Real>::value);
    return state;
  }

  UnetPlan plan_;
};

}  // namespace

void register_unet(NetworkRegistry& registry) {
  registry.add({.name = "unet",
                .title = "U-net",
                .source = "Ronneberger, Fischer, Brox 2015, fig. 1; as in PhiFlow 2.2 u_net",
                .note = "Uses single precision for parameters and grids.",
                .options = option_table<UnetOptions>(),
                .make = [](const OptionValues& options, const NetworkShape& shape) {
                  return std::make_unique<Unet>(read_options<UnetOptions>(options), shape);
                }});
}

}  // namespace isoline::networks
