// The passes of a U-net over a batch, and what they share: the input of a unit, made from the
// outputs z of earlier ones while these are in cache. Each task processes a few samples.
#pragma once

#include <functional>

#include "networks/unet/state.h"

namespace isoline::networks {

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
