// What a U-net consists of: its units in order, and where each finds its parameters in θ.
#pragma once

#include <string>
#include <vector>

#include "core/convolution.h"
#include "networks/network.h"

namespace isoline::networks {

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
  // Of a weight in the layout of core/convolution.h, by blocks of `width` channels in.
  static Index position(Index out, Index in, Index tap, Index all_in, Index width) {
    const Index block = out / kChannels * (all_in / width) + in / width;
    return ((block * 9 + tap) * width + in % width) * kChannels + out % kChannels;
  }
};

}  // namespace isoline::networks
