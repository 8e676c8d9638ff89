// What a U-net keeps in its workspace: the convolutions' outputs z, everything else being computed
// anew from them while it is in cache; kernels in their layout; the batch norms; and for each
// thread the arrays and convolutions it works with. Tangents are kept once asked for.
#pragma once

#include <optional>

#include "networks/unet/grids.h"
#include "networks/unet/layout.h"

namespace isoline::networks {

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
  std::vector<UnitCalls> calls;  // one a unit
  Pixels in, cotangent_in, cotangent_z, spare;
};

// Room for the second moments of one unit.
struct MomentRoom {
  std::vector<std::vector<Pixel>> patches;  // of a task, one a thread
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
  void set_value(const UnetPlan& plan, VectorRef theta);
  void set_tangent(const UnetPlan& plan, VectorRef v);

  // Samples are taken so many at a time, a divisor of all of them.
  Index samples_a_task(const UnetPlan& plan, Index level) const;

 private:
  void set_kernels(const UnetPlan& plan, VectorRef theta, float* Place::*array,
                   Real Dual<Real>::*number);
  ThreadState make_thread(const UnetPlan& plan) const;
};

}  // namespace isoline::networks
