// A U-net forward, and the pushforward of its parameters.
#include <cmath>

#include "core/threads.h"
#include "networks/unet/passes.h"

namespace isoline::networks {
namespace {

constexpr Real kEpsilon = 1e-5;  // PyTorch's, added to the variance

// The batch in single precision, within its halo.
void read_input(const UnetPlan& plan, UnetState& state, BatchRef in) {
  const Index N = plan.N, channels = plan.input_channels, image = (N + 2) * (N + 2);
  for_each_task(state.samples, [&](Index sample, int) {
    for (Index c = 0; c < channels; ++c) {
      float* const out = state.input.data() + (sample * channels + c) * image;
      const Real* const from = in.col(sample).data() + c * N * N;
      for (Index column = 0; column < N; ++column)
        for (Index row = 0; row < N; ++row)
          out[(column + 1) * (N + 2) + row + 1] = static_cast<float>(from[column * N + row]);
      fill_halo(out, N, plan.is_circular);
    }
  });
}

// Calls visit(pixel) for each pixel of a block of a task, and done() after each row: sums of a row
// are taken in single precision, longer ones in double.
template <class Visit, class Done>
void for_each_row(const UnitPass& pass, Index block, Visit visit, Done done) {
  for (Index image = 0; image < pass.images; ++image)
    for (Index row = 0; row < pass.N; ++row) {
      const Index begin = ((image * pass.blocks + block) * pass.N + row) * pass.N;
      for (Index pixel = begin; pixel < begin + pass.N; ++pixel) visit(pixel);
      done();
    }
}

// Mean and sum of squares about it, over a task.
void add_moments(const UnitPass& pass, Index task) {
  const Place z = pass.z(task);
  const double count = static_cast<double>(pass.images * pass.N * pass.N);
  for (Index block = 0; block < pass.blocks; ++block) {
    Lane row = {};
    Wide sum = {}, squares = {};
    const auto add_to = [&row](Wide& total) {
      accumulate(row, total);
      row = Lane{};
    };
    for_each_row(
        pass, block, [&](Index pixel) { row += load<Lane>(z, pixel); }, [&] { add_to(sum); });
    const Wide mean = sum / count;
    const Lane middle = __builtin_convertvector(mean, Lane);
    for_each_row(
        pass, block,
        [&](Index pixel) {
          const Lane d = load<Lane>(z, pixel) - middle;
          row += d * d;
        },
        [&] { add_to(squares); });
    pass.sum(task, block, 0) = mean;
    pass.sum(task, block, 1) = squares;
  }
}

// Tasks are of equal size: their means' mean is that of all, and squares about it follow.
void set_norm(const UnitPass& pass) {
  for (Index c = 0; c < pass.plan.channels(); ++c) {
    const Real mean = pass.total(c, 0) / static_cast<Real>(pass.tasks);
    Real between = 0;
    for (Index task = 0; task < pass.tasks; ++task) {
      const Real d = pass.sum(task, c / kChannels, 0)[c % kChannels] - mean;
      between += d * d;
    }
    const Real variance =
        pass.total(c, 1) / pass.pixels() + between / static_cast<Real>(pass.tasks);
    pass.own.norm.mean[c].value = mean;
    pass.own.norm.deviation[c].value = 1 / std::sqrt(variance + kEpsilon);
    pass.own.norm.set_forward(c);
  }
}

void convolve(const UnitPass& pass, bool has_moments) {
  const float* const kernel = pass.own.kernel.place().value;
  for_each_task(pass.tasks, [&](Index task, int which) {
    ThreadState& thread = pass.state.threads[which];
    const float* const in = pass.unit.source == Unit::Source::input
                                ? pass.plain_input(task)
                                : assemble<Lane>(pass, task, 1, thread).value;
    thread.calls[pass.index].forward(in, kernel, pass.z(task).value);
    if (has_moments) add_moments(pass, task);
  });
}

// z' = W * a' + W' * a, and the sums over z' and x̂ z'.
void convolve_tangents(const UnitPass& pass) {
  const Place kernel = pass.own.kernel.place();
  for_each_task(pass.tasks, [&](Index task, int which) {
    ThreadState& thread = pass.state.threads[which];
    UnitCalls& calls = thread.calls[pass.index];
    const Place z = pass.z(task);
    if (pass.unit.source == Unit::Source::input) {
      calls.forward(pass.plain_input(task), kernel.tangent, z.tangent);
    } else {
      const Place in = assemble<DualLane>(pass, task, 1, thread);
      calls.forward(in.tangent, kernel.value, z.tangent);
      calls.forward_adds(in.value, kernel.tangent, z.tangent);
    }
    for (Index block = 0; block < pass.blocks; ++block) {
      const Lane inverse = pass.own.norm.at<Lane>(Norm::inverse, block);
      const Lane centre = pass.own.norm.at<Lane>(Norm::centre, block);
      Lane row = {}, row_x = {};
      Wide sum = {}, sum_x = {};
      for_each_row(
          pass, block,
          [&](Index pixel) {
            const auto x = load<DualLane>(z, pixel);
            row += x.tangent;
            row_x += x.tangent * (inverse * x.value + centre);
          },
          [&] {
            accumulate(row, sum);
            accumulate(row_x, sum_x);
            row = row_x = Lane{};
          });
      pass.sum(task, block, 0) = sum;
      pass.sum(task, block, 1) = sum_x;
    }
  });
}

// μ' = mean z', (1/σ)' = −(1/σ)² mean(x̂ z').
void set_norm_tangents(const UnitPass& pass) {
  Norm& norm = pass.own.norm;
  for (Index c = 0; c < pass.plan.channels(); ++c) {
    const Real inverse = norm.deviation[c].value;
    norm.mean[c].tangent = pass.total(c, 0) / pass.pixels();
    norm.deviation[c].tangent = -inverse * inverse * pass.total(c, 1) / pass.pixels();
    norm.set_forward(c);
  }
}

// x = Σ_c w_c a_c + bias at every pixel, by a network's last activation a; or the tangent of that.
template <class T>
void write_output(const UnetPlan& plan, UnetState& state, BatchOut x) {
  const Index last = static_cast<Index>(plan.units.size()) - 1, pixels = plan.N * plan.N;
  for_each_task(state.samples, [&](Index sample, int) {
    for (Index o = 0; o < plan.output_channels; ++o) {
      const Dual<Real> bias = state.output_biases[o];
      Real* const out = x.col(sample).data() + o * pixels;
      std::fill_n(out, pixels, kIsDual<T> ? bias.tangent : bias.value);
      for (Index block = 0; block < plan.blocks(); ++block) {
        const auto a = activated<T>(plan, state, last, sample, block);
        const T weights = load<T>(state.output.place(), o * plan.blocks() + block);
        for (Index pixel = 0; pixel < pixels; ++pixel) {
          const Lane product = asked_of(weights * a(pixel));
          out[pixel] += Eigen::Map<const Eigen::Array<float, kChannels, 1>>(
                            reinterpret_cast<const float*>(&product))
                            .sum();
        }
      }
    }
  });
}

}  // namespace

void unet_forward(const UnetPlan& plan, UnetState& state, BatchRef in) {
  read_input(plan, state, in);
  for (Index i = 0; i < static_cast<Index>(plan.units.size()); ++i) {
    const UnitPass pass{plan, state, i};
    convolve(pass, true);
    set_norm(pass);
  }
}

void unet_output(const UnetPlan& plan, UnetState& state, BatchOut x) {
  write_output<Lane>(plan, state, x);
}

void unet_pushforward(const UnetPlan& plan, UnetState& state, BatchOut Jv) {
  for (Index i = 0; i < static_cast<Index>(plan.units.size()); ++i) {
    const UnitPass pass{plan, state, i};
    convolve_tangents(pass);
    set_norm_tangents(pass);
  }
  write_output<DualLane>(plan, state, Jv);
}

// A convolution's bias, which batch statistics take away again, counts against given ones.
Vector unet_statistics(const UnetPlan& plan, UnetState& state, VectorRef theta) {
  Vector all(2 * plan.filters * static_cast<Index>(plan.units.size()));
  Index at = 0;
  for (std::size_t i = 0; i < plan.units.size(); ++i) {
    const Norm& norm = state.units[i].norm;
    for (Index c = 0; c < plan.filters; ++c, ++at) {
      all[at] = norm.mean[c].value + theta[plan.biases(plan.units[i]) + c];
      all[at + plan.filters] = std::pow(norm.deviation[c].value, -2) - kEpsilon;
    }
    at += plan.filters;
  }
  return all;
}

void unet_infer(const UnetPlan& plan, UnetState& state, VectorRef theta, VectorRef statistics,
                BatchRef in) {
  read_input(plan, state, in);
  Index at = 0;
  for (std::size_t i = 0; i < plan.units.size(); ++i) {
    Norm& norm = state.units[i].norm;
    for (Index c = 0; c < plan.filters; ++c, ++at) {
      norm.mean[c].value = statistics[at] - theta[plan.biases(plan.units[i]) + c];
      norm.deviation[c].value = 1 / std::sqrt(statistics[at + plan.filters] + kEpsilon);
      norm.set_forward(c);
    }
    at += plan.filters;
    convolve({plan, state, static_cast<Index>(i)}, false);
  }
}

}  // namespace isoline::networks
