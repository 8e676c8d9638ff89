// The pullback of a U-net to its parameters, and with dual numbers its derivative: the curvature.
// Unit by unit from the last, `cotangents` holds g, that of the unit's y before the rectifier.
#include "core/threads.h"
#include "networks/unet/cotangents.h"
#include "networks/unet/passes.h"

namespace isoline::networks {
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

// The sum of all parts, in the order of tasks, whoever computed them.
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
  // What a bias adds, the batch norm takes away.
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
