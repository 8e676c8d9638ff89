// 3×3 convolutions of small stacks of N×N grids in single precision: the only adapter to oneDNN.
// Each runs on the calling thread, for callers that keep a stack in cache and distribute stacks
// over threads, and gives the same bits on any thread.
//
// Channels come in blocks of kChannels, [image][block][column][row][channel]. Inputs carry a halo
// of one, (N+2)×(N+2), that their writer fills, so that the caller decides the padding. A kernel is
// [block out][block in][3][3][channel in][channel out]. If there are fewer input channels than a
// block, they are not blocked: [image][channel][column][row], with kernels [block
// out][3][3][in][out]. Every array must be aligned to 64 bytes.
#pragma once

#include <memory>

#include "core/array.h"

namespace isoline {

#ifdef __AVX512F__  // what one vector holds, and hence the layout of oneDNN's fast kernels
inline constexpr Index kChannels = 16;
#else
inline constexpr Index kChannels = 8;
#endif

struct ConvolutionShape {
  Index images, in, out, N;  // channels in and out: whole blocks, but for a plain input
  bool is_plain = false;
};

class ConvolutionCall;  // oneDNN's objects; their header stays inside convolution.cpp
class ThreeChannels;

// out = kernel * in, or out += kernel * in.
class Convolution {
 public:
  Convolution(const ConvolutionShape& shape, bool adds);
  Convolution(Convolution&&) noexcept;
  ~Convolution();

  void operator()(const float* in, const float* kernel, float* out);

 private:
  std::unique_ptr<ConvolutionCall> call_;
};

// kernel = Σ over images and pixels of cotangent ⊗ in: the pullback of a Convolution to its kernel.
class KernelGradient {
 public:
  explicit KernelGradient(const ConvolutionShape& shape);
  KernelGradient(KernelGradient&&) noexcept;
  ~KernelGradient();

  void operator()(const float* in, const float* cotangent, float* kernel);

 private:
  std::unique_ptr<ThreeChannels> widened_;  // where `in` is handed over with channels of zeros
  std::unique_ptr<ConvolutionCall> call_;
};

}  // namespace isoline
