// The pullback of a U-net to its parameters, and with dual numbers its derivative: the curvature.
// Unit by unit from the last, `cotangents` holds g, that of the unit's y before the rectifier.
#include "core/threads.h"
#include "networks/unet/passes.h"

namespace isoline::networks {
namespace {

// Sums over one task of g and g x̂, and of their tangents.
template <class T>
struct NormSums {
  T row{}, row_x{};

  void add(const T& g, const T& x) {
    row = row + g;
    row_x = row_x + g * x;
  }
  void flush(const UnitPass& pass, Index task, Index block) {
    accumulate(value_of(row), pass.sum(task, block, 0));
    accumulate(value_of(row_x), pass.sum(task, block, 1));
    if constexpr (kIsDual<T>) {
      accumulate(row.tangent, pass.sum(task, block, 2));
      accumulate(row_x.tangent, pass.sum(task, block, 3));
    }
    row = row_x = T{};
  }
};

enum class Part { only, first, last };  // of the cotangents of an activation that is used twice

// Takes the cotangent of one block of an activation through the rectifier.
template <class T>
void absorb(const UnitPass& pass, Index task, Index unit, Index sample, Index block,
            const Place& cotangent, Part part) {
  const auto a = activated<T>(pass.plan, pass.state, unit, sample, block);
  Norm& norm = pass.state.units[unit].norm;
  const T inverse = norm.at<T>(Norm::inverse, block), centre = norm.at<T>(Norm::centre, block);
  const Index level = pass.plan.units[unit].level, N = pass.plan.size(level);
  const Place g = pass.state.cotangents[level].place() + (sample * pass.blocks + block) * N * N;
  NormSums<T> sums;
  for (Index row = 0; row < N; ++row) {
    for (Index pixel = row * N; pixel < (row + 1) * N; ++pixel) {
      T x = load<T>(cotangent, pixel);
      if (part == Part::last) x = x + load<T>(g, pixel);
      const T z = load<T>(a.z, pixel);
      const T kept = keep(is_positive(a.scale * z + a.shift), x);
      store(g, pixel, kept);
      sums.add(kept, inverse * z + centre);
    }
    if (part != Part::first) sums.flush(pass, task, block);
  }
}

// The cotangent of z, through the batch norm.
template <class T>
Place norm_cotangent(const UnitPass& pass, Index task, Index halo, ThreadState& thread) {
  const Index N = pass.N;
  const Grid grid{N, halo};
  for (Index i = 0; i < pass.images * pass.blocks; ++i) {
    const Index block = i % pass.blocks;
    const Index before = task * pass.images * pass.blocks + i;
    const Place g = pass.state.cotangents[pass.unit.level].place() + before * N * N;
    const Place z = pass.own.z.place() + before * N * N;
    const Place out = thread.cotangent_z.place() + i * grid.pixels();
    Norm& norm = pass.own.norm;
    const T scale = norm.at<T>(Norm::scale, block), slope = norm.at<T>(Norm::slope, block);
    const T offset = norm.at<T>(Norm::offset, block);
    for (Index column = 0; column < N; ++column)
      for (Index row = 0; row < N; ++row) {
        const Index pixel = column * N + row;
        store(out, grid.at(column, row),
              scale * load<T>(g, pixel) + slope * load<T>(z, pixel) + offset);
      }
    fill_halos(out, grid, pass.plan.is_circular, kIsDual<T>);
  }
  return thread.cotangent_z.place();
}

// From the cotangent of a unit's input to those of the activations it was assembled from.
template <class T>
void scatter(const UnitPass& pass, Index task, ThreadState& thread) {
  const Unit& unit = pass.unit;
  const Index N = pass.N, count = pass.blocks_in();
  const Place spare = thread.spare.place();
  for (Index i = 0; i < pass.images * count; ++i) {
    const Index sample = task * pass.images + i / count, block = i % count;
    const Place in = thread.cotangent_in.place() + i * N * N;
    if (unit.source == Unit::Source::activation) {
      absorb<T>(pass, task, unit.from, sample, block, in, Part::only);
    } else if (unit.source == Unit::Source::pooled) {
      unpool(activated<T>(pass.plan, pass.state, unit.from, sample, block), in, spare, N);
      absorb<T>(pass, task, unit.from, sample, block, spare, Part::last);
    } else if (block < pass.blocks) {
      absorb<T>(pass, task, unit.skip, sample, block, in, Part::first);
    } else {
      downsample<T>(in, spare, N / 2);
      absorb<T>(pass, task, unit.from, sample, block - pass.blocks, spare, Part::only);
    }
  }
}

// The moments of each convolution of a U-net along one pullback, summed while its numbers are in
// cache:
//   Ω = ⟨Σ_t ā āᵀ⟩ over samples,  Γ = ⟨g gᵀ⟩ over samples and places t,
// ā = (a, 1) the patch around t, halo included, and g the cotangent of the convolution's output.
// Sums over a task are in single precision, those over tasks in double, in order.

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

// ā of every place, one per column: taps, then channels, then 1.
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

// For the 1×1 convolution that gives the network's output.
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

namespace {

void clear_sums(const UnitPass& pass, Index task) {
  std::fill_n(&pass.sum(task, 0, 0), 4 * pass.blocks, Wide{});
}

// How many partial gradients of a kernel a task gives: one, but by the product rule two of the
// derivative, unless the input of the convolution is the network's and has no tangent.
template <class T>
Index parts_a_task(const UnitPass& pass) {
  return kIsDual<T> && pass.unit.source != Unit::Source::input ? 2 : 1;
}

template <class T>
void pull_back_task(const UnitPass& pass, Index task, ThreadState& thread) {
  UnitCalls& calls = thread.calls[pass.index];
  const Index size = pass.plan.kernel_size(pass.unit);
  float* const part = pass.state.kernel_parts.data()->channel + task * parts_a_task<T>(pass) * size;
  clear_sums(pass, task);
  const bool is_first = pass.unit.source == Unit::Source::input;
  const Place z = norm_cotangent<T>(pass, task, is_first ? 0 : 1, thread);
  if (is_first)
    return calls.gradient(pass.plain_input(task), kIsDual<T> ? z.tangent : z.value, part);
  const Place a = assemble<T>(pass, task, 0, thread), kernel = pass.own.transposed.place();
  const Place in = thread.cotangent_in.place();
  (*calls.backward)(z.value, kernel.value, in.value);
  if constexpr (kIsDual<T>) {
    calls.gradient(z.tangent, a.value, part);
    calls.gradient(z.value, a.tangent, part + size);
    (*calls.backward)(z.tangent, kernel.value, in.tangent);
    (*calls.backward_adds)(z.value, kernel.tangent, in.tangent);
  } else {
    calls.gradient(z.value, a.value, part);
  }
  scatter<T>(pass, task, thread);
}

// The sum of all parts, in the order of tasks, independent of the threads that computed them.
void add_kernel_parts(const UnitPass& pass, Index parts, VectorOut out) {
  UnetState& state = pass.state;
  const Index pixels = pass.plan.kernel_size(pass.unit) / kChannels;
  float* const first = state.kernel_parts.data()->channel;
  for_each_task(pixels, [&](Index pixel, int) {
    Wide sum = {};
    for (Index i = 0; i < parts; ++i) accumulate(lane(first, i * pixels + pixel), sum);
    state.kernel_sum[pixel] = sum;
  });
  const bool is_first = pass.unit.source == Unit::Source::input;
  pass.plan.for_each_weight(pass.unit, [&](Index weight, Index at, Index at_transposed) {
    const Index position = is_first ? at : at_transposed;  // see UnitCalls::gradient
    out[weight] = state.kernel_sum[position / kChannels][position % kChannels];
  });
  // The batch norm removes the effect of a bias.
  out.segment(pass.plan.biases(pass.unit), pass.plan.filters).setZero();
}

// The gradients of γ and β of a unit whose g is complete, and what its batch norm pulls back by.
template <class T>
void finish_norm(const UnitPass& pass, Index unit, VectorOut out) {
  const UnetPlan& plan = pass.plan;
  const Index N = plan.size(plan.units[unit].level), at = plan.norm(plan.units[unit]);
  const Real pixels = static_cast<Real>(pass.state.samples * N * N);
  for (Index c = 0; c < plan.channels(); ++c) {
    const auto total = [&](Index which) {
      return Norm::Number{pass.total(c, which), kIsDual<T> ? pass.total(c, which + 2) : 0};
    };
    const Norm::Number g = total(0), g_x = total(1), share{1 / pixels, 0};
    pass.state.units[unit].norm.set_pullback(c, share * g, share * g_x);
    if (c >= plan.filters) continue;
    out[at + c] = kIsDual<T> ? g_x.tangent : g_x.value;
    out[at + plan.filters + c] = kIsDual<T> ? g.tangent : g.value;
  }
}

// One number for all channels.
template <class T>
T broadcast(Real value, Real tangent) {
  const Lane all = Lane{} + static_cast<float>(value);
  if constexpr (kIsDual<T>)
    return {all, Lane{} + static_cast<float>(tangent)};
  else
    return all;
}

// The 1×1 convolution x = Σ_c w_c a_c + bias, for one sample.
template <class T>
void pull_back_output(const UnitPass& last, Index task, Index sample, BatchRef u, BatchRef du,
                      ThreadState& thread) {
  const Index pixels = last.N * last.N, channels = last.plan.output_channels;
  const Place spare = thread.spare.place();
  for (Index block = 0; block < last.blocks; ++block) {
    const auto a = activated<T>(last.plan, last.state, last.index, sample, block);
    for (Index o = 0; o < channels; ++o) {
      const Real* const value = u.col(sample).data() + o * pixels;
      const Real* const tangent = du.col(sample).data() + o * pixels;
      const T weights = load<T>(last.state.output.place(), o * last.blocks + block);
      Wide sum = {};
      for (Index row = 0; row < last.N; ++row) {
        Lane of_row = {};
        for (Index pixel = row * last.N; pixel < (row + 1) * last.N; ++pixel) {
          const T g = broadcast<T>(value[pixel], tangent[pixel]);
          store(spare, pixel, o == 0 ? weights * g : load<T>(spare, pixel) + weights * g);
          of_row += asked_of(g * a(pixel));
        }
        accumulate(of_row, sum);
      }
      last.state.output_parts[(sample * channels + o) * last.blocks + block] = sum;
    }
    absorb<T>(last, task, last.index, sample, block, spare, Part::only);
  }
}

void add_output_parts(const UnetPlan& plan, const UnetState& state, BatchRef asked, VectorOut out) {
  const Index pixels = plan.N * plan.N;
  out.tail(plan.output_channels * (plan.filters + 1)).setZero();
  for (Index sample = 0; sample < state.samples; ++sample)
    for (Index o = 0; o < plan.output_channels; ++o) {
      const Index part = (sample * plan.output_channels + o) * plan.blocks();
      for (Index c = 0; c < plan.filters; ++c)
        out[plan.output() + o * plan.filters + c] +=
            state.output_parts[part + c / kChannels][c % kChannels];
      const Real* const g = asked.col(sample).data() + o * pixels;
      for (Index pixel = 0; pixel < pixels; ++pixel) out[plan.output_biases() + o] += g[pixel];
    }
}

template <class T>
void pull_back(const UnetPlan& plan, UnetState& state, BatchRef u, BatchRef du, VectorOut out,
               const WatchUnit& watch) {
  const Index count = static_cast<Index>(plan.units.size());
  const UnitPass last{plan, state, count - 1};
  for_each_task(last.tasks, [&](Index task, int thread) {
    clear_sums(last, task);
    for (Index sample = task * last.images; sample < (task + 1) * last.images; ++sample)
      pull_back_output<T>(last, task, sample, u, du, state.threads[thread]);
  });
  add_output_parts(plan, state, kIsDual<T> ? du : u, out);
  finish_norm<T>(last, last.index, out);
  for (Index i = count - 1; i >= 0; --i) {
    const UnitPass pass{plan, state, i};
    if (watch) watch(pass);
    for_each_task(pass.tasks, [&](Index task, int thread) {
      pull_back_task<T>(pass, task, state.threads[thread]);
    });
    add_kernel_parts(pass, pass.tasks * parts_a_task<T>(pass), out);
    if (i > 0) finish_norm<T>(pass, pass.unit.from, out);
  }
}

}  // namespace

void unet_pullback(const UnetPlan& plan, UnetState& state, BatchRef u, VectorOut out,
                   const WatchUnit& watch) {
  pull_back<Lane>(plan, state, u, u, out, watch);
}

void unet_curvature(const UnetPlan& plan, UnetState& state, BatchRef u, BatchRef du,
                    VectorOut out) {
  pull_back<DualLane>(plan, state, u, du, out, {});
}

}  // namespace isoline::networks
