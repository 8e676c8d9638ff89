// Convolutions' gradients by kernels against sums written out, for plain and for blocked inputs.
#include "core/convolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "core/random.h"

namespace isoline {
namespace {

// Numbers at an address that oneDNN accepts.
using Aligned = std::unique_ptr<float[], decltype(&std::free)>;
Aligned aligned(Index count, RandomStream& stream) {
  const std::size_t bytes = (sizeof(float) * static_cast<std::size_t>(count) + 63) / 64 * 64;
  Aligned numbers(static_cast<float*>(std::aligned_alloc(64, bytes)), &std::free);
  const Vector drawn = stream.normal_vector(count);
  std::ranges::transform(drawn, numbers.get(), [](Real x) { return static_cast<float>(x); });
  return numbers;
}

struct Layout {
  ConvolutionShape s;

  Index halo() const { return s.N + 2; }
  Index width() const { return s.is_plain ? s.in : kChannels; }  // of a block that comes in
  Index in(Index image, Index channel, Index column, Index row) const {
    if (s.is_plain) return ((image * s.in + channel) * halo() + column) * halo() + row;
    const Index block = image * (s.in / kChannels) + channel / kChannels;
    return ((block * halo() + column) * halo() + row) * kChannels + channel % kChannels;
  }
  Index out(Index image, Index channel, Index column, Index row) const {
    const Index block = image * (s.out / kChannels) + channel / kChannels;
    return ((block * s.N + column) * s.N + row) * kChannels + channel % kChannels;
  }
  Index kernel(Index out, Index in, Index column, Index row) const {
    const Index block = out / kChannels * (s.in / width()) + in / width();
    return (((block * 3 + column) * 3 + row) * width() + in % width()) * kChannels +
           out % kChannels;
  }
};

class KernelGradients : public testing::TestWithParam<ConvolutionShape> {};

TEST_P(KernelGradients, AreTheSumsOverImagesAndPixels) {
  const ConvolutionShape s = GetParam();
  const Layout layout{s};
  RandomStream stream(0, "convolution", "test", 0);
  const Aligned in = aligned(s.images * s.in * layout.halo() * layout.halo(), stream);
  const Aligned cotangent = aligned(s.images * s.out * s.N * s.N, stream);
  const Aligned kernel = aligned(s.out * s.in * 9, stream);
  KernelGradient gradient(s);
  for (int call = 0; call < 2; ++call) gradient(in.get(), cotangent.get(), kernel.get());
  for (Index o = 0; o < s.out; ++o)
    for (Index i = 0; i < s.in; ++i)
      for (Index tap = 0; tap < 9; ++tap) {
        double sum = 0, size = 0;
        for (Index image = 0; image < s.images; ++image)
          for (Index pixel = 0; pixel < s.N * s.N; ++pixel) {
            const Index column = pixel / s.N, row = pixel % s.N;
            const double term = double{in[layout.in(image, i, column + tap / 3, row + tap % 3)]} *
                                double{cotangent[layout.out(image, o, column, row)]};
            sum += term;
            size += std::abs(term);
          }
        EXPECT_NEAR(kernel[layout.kernel(o, i, tap / 3, tap % 3)], sum, 1e-6 * size)
            << "out " << o << ", in " << i << ", tap " << tap;
      }
}

INSTANTIATE_TEST_SUITE_P(Shapes, KernelGradients,
                         testing::Values(ConvolutionShape{2, 1, 16, 8, true},
                                         ConvolutionShape{3, 2, 32, 4, true},
                                         ConvolutionShape{1, 3, 16, 8, true},
                                         ConvolutionShape{2, 16, 32, 8, false}));

}  // namespace
}  // namespace isoline
