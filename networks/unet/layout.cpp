// The units of a U-net, their parameters, and the start that PyTorch would draw.
#include "networks/unet/layout.h"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.h"

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

void check(const UnetOptions& options, const NetworkShape& shape) {
  require(shape.grid > 0, [&] {
    return "unet: the samples must be grids, got columns of " + std::to_string(shape.inputs) +
           " numbers";
  });
  const Index step = Index{1} << (options.levels - 1);
  require(shape.grid % step == 0, [&] {
    return fmt::format("unet: with levels={} N must be a multiple of {}, got {}", options.levels,
                       step, shape.grid);
  });
}

}  // namespace

UnetPlan::UnetPlan(const UnetOptions& options, const NetworkShape& shape)
    : N(shape.grid),
      input_channels(shape.input_channels),
      output_channels(shape.output_channels),
      levels(options.levels),
      filters(options.filters),
      is_circular(options.padding == "circular") {
  check(options, shape);
  units = units_of(levels, filters, input_channels);
  Index offset = 0;
  for (Unit& unit : units) {
    unit.offset = offset;
    offset += filters * (9 * unit.in + 3);
  }
  parameters = offset + output_channels * (filters + 1);
}

Index UnetPlan::channels_in(const Unit& unit) const {
  switch (unit.source) {
    case Source::joined:
      return 2 * channels();
    case Source::input:
      return unit.in;
    default:
      return channels();
  }
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

}  // namespace isoline::networks
