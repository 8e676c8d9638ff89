// What each convolution of a U-net sees along one pullback, summed where its numbers are in cache:
//   Ω = ⟨Σ_t ā āᵀ⟩ over samples,  Γ = ⟨g gᵀ⟩ over samples and places t,
// ā = (a, 1) the patch around t, halo included, and g the cotangent of the convolution's output.
// Sums over a task are in single precision, those over tasks in double, in order.
#include "core/threads.h"
#include "networks/unet/cotangents.h"
#include "networks/unet/passes.h"

namespace isoline::networks {
namespace {

using Floats = Eigen::Map<Eigen::MatrixXf>;

Floats matrix(std::vector<Pixel>& room, Index first, Index rows, Index columns) {
  return {room.data()->channel + first, rows, columns};
}

void fit(std::vector<Pixel>& room, Index floats) {
  const auto pixels = static_cast<std::size_t>((floats + kChannels - 1) / kChannels);
  if (room.size() < pixels) room.resize(pixels);
}

// One task's images as they lie in memory: blocks of `width` channels, on grids with or without a
// halo, which decides whether a patch has nine taps or one.
struct Images {
  const float* pixels;
  Index count, blocks, width;
  Grid grid;

  Index side() const { return 2 * grid.halo + 1; }
  Index rows() const { return side() * side() * blocks * width + 1; }  // of ā
  Index places() const { return count * grid.N * grid.N; }
};

// ā of every place, one a column: taps, then channels, then 1.
void read_patches(const Images& images, float* to) {
  const Grid& grid = images.grid;
  for (Index image = 0; image < images.count; ++image)
    for (Index column = 0; column < grid.N; ++column)
      for (Index row = 0; row < grid.N; ++row) {
        for (Index i = 0; i < images.side(); ++i)
          for (Index j = 0; j < images.side(); ++j)
            for (Index block = 0; block < images.blocks; ++block) {
              const Index pixel = (image * images.blocks + block) * grid.pixels() +
                                  (column + i) * grid.width() + row + j;
              to = std::copy_n(images.pixels + pixel * images.width, images.width, to);
            }
        *to++ = 1;
      }
}

// Σ ā āᵀ over one task, its lower half. By Eigen, which stays on the calling thread.
void add_up(const Images& images, std::vector<Pixel>& patches, std::vector<Pixel>& sums,
            Index task) {
  const Index rows = images.rows();
  fit(patches, rows * images.places());
  read_patches(images, patches.data()->channel);
  Floats sum = matrix(sums, task * rows * rows, rows, rows);
  sum.setZero();
  sum.selfadjointView<Eigen::Lower>().rankUpdate(matrix(patches, 0, rows, images.places()));
}

// Σ over tasks, over `count`, of the rows `place(i)`, both halves.
template <class PlaceOf>
void gather(std::vector<Pixel>& sums, Index tasks, Index rows, Index wanted, Real count,
            const PlaceOf& place, Matrix& out) {
  out.resize(wanted, wanted);
  for (Index j = 0; j < wanted; ++j)
    for (Index i = j; i < wanted; ++i) {
      const Index row = std::max(place(i), place(j)), column = std::min(place(i), place(j));
      Real sum = 0;
      for (Index task = 0; task < tasks; ++task)
        sum += matrix(sums, task * rows * rows, rows, rows)(row, column);
      out(i, j) = out(j, i) = sum / count;
    }
}

void watch_unit(const UnitPass& pass, LayerMoments& out) {
  const UnetPlan& plan = pass.plan;
  MomentRoom& room = pass.state.moments;
  const bool is_first = pass.unit.source == Unit::Source::input;
  const Index channels = plan.channels_in(pass.unit);
  const Images in{nullptr, pass.images, is_first ? channels : pass.blocks_in(),
                  is_first ? 1 : kChannels, Grid{pass.N, 1}};
  const Images z{nullptr, pass.images, pass.blocks, kChannels, Grid{pass.N}};
  fit(room.inputs, pass.tasks * in.rows() * in.rows());
  fit(room.cotangents, pass.tasks * z.rows() * z.rows());
  for_each_task(pass.tasks, [&](Index task, int which) {
    ThreadState& thread = pass.state.threads[which];
    Images a = in, g = z;
    a.pixels = is_first ? pass.plain_input(task) : assemble<Lane>(pass, task, 1, thread).value;
    add_up(a, room.patches[which], room.inputs, task);
    g.pixels = norm_cotangent<Lane>(pass, task, 0, thread).value;
    add_up(g, room.patches[which], room.cotangents, task);
  });
  const Index taps = in.side() * in.side(), wanted = taps * pass.unit.in + 1;
  const auto place = [&](Index i) {
    return i + 1 == wanted ? in.rows() - 1
                           : i % taps * channels + plan.in_memory(pass.unit, i / taps);
  };
  gather(room.inputs, pass.tasks, in.rows(), wanted, Real(pass.state.samples), place, out.inputs);
  gather(
      room.cotangents, pass.tasks, z.rows(), plan.filters, pass.pixels(), [](Index i) { return i; },
      out.cotangents);
}

// Of the 1×1 convolution, whose output is the network's.
void watch_output(const UnitPass& last, BatchRef u, LayerMoments& out) {
  const UnetPlan& plan = last.plan;
  MomentRoom& room = last.state.moments;
  const Grid grid{last.N};
  const Images in{nullptr, last.images, last.blocks, kChannels, grid};
  fit(room.inputs, last.tasks * in.rows() * in.rows());
  for_each_task(last.tasks, [&](Index task, int which) {
    const Place a = last.state.threads[which].in.place();
    for (Index i = 0; i < last.images * last.blocks; ++i)
      activate(activated<Lane>(plan, last.state, last.index, task * last.images + i / last.blocks,
                               i % last.blocks),
               a + i * grid.pixels(), grid);
    Images images = in;
    images.pixels = a.value;
    add_up(images, room.patches[which], room.inputs, task);
  });
  const auto place = [&](Index i) { return i == plan.filters ? in.rows() - 1 : i; };
  gather(room.inputs, last.tasks, in.rows(), plan.filters + 1, Real(last.state.samples), place,
         out.inputs);
  out.cotangents.setZero(plan.output_channels, plan.output_channels);
  for (Index b = 0; b < u.cols(); ++b) {
    const Eigen::Map<const Matrix> g(u.col(b).data(), grid.pixels(), plan.output_channels);
    out.cotangents += g.transpose().lazyProduct(g) / last.pixels();
  }
}

}  // namespace

void unet_layer_moments(const UnetPlan& plan, UnetState& state, BatchRef u,
                        std::vector<LayerMoments>& moments, VectorOut out) {
  constexpr Index kBlocks = 4;  // of a unit in layout(): kernel, biases, γ, β
  const Index count = static_cast<Index>(plan.units.size());
  moments.resize(count + 1);
  for (Index i = 0; i <= count; ++i) {
    moments[i].weight = kBlocks * i;
    moments[i].bias = kBlocks * i + 1;
  }
  state.moments.patches.resize(state.threads.size());
  watch_output({plan, state, count - 1}, u, moments.back());
  unet_pullback(plan, state, u, out,
                [&](const UnitPass& pass) { watch_unit(pass, moments[pass.index]); });
}

}  // namespace isoline::networks
