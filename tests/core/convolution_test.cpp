// Convolutions' gradients by kernels against sums written out, for plain and for blocked inputs.
#include "core/convolution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <new>

#include "core/random.h"

namespace isoline {
namespace {

// Numbers at an address that oneDNN accepts.
class Aligned {
 public:
  explicit Aligned(Index count, RandomStream& stream)
      : data_(static_cast<float*>(::operator new(sizeof(float) * count, kAlignment))) {
    const Vector drawn = stream.normal_vector(count);
    for (Index i = 0; i < count; ++i) data_[i] = static_cast<float>(drawn[i]);
  }
  Aligned(const Aligned&) = delete;
  Aligned& operator=(const Aligned&) = delete;
  ~Aligned() { ::operator delete(data_, kAlignment); }

  float* data() const { return data_; }
  float operator[](Index i) const { return data_[i]; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  float* data_;
};

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
  const Aligned in(s.images * s.in * layout.halo() * layout.halo(), stream);
  const Aligned cotangent(s.images * s.out * s.N * s.N, stream);
  const Aligned kernel(s.out * s.in * 9, stream);
  KernelGradient gradient(s);
  for (int call = 0; call < 2; ++call) gradient(in.data(), cotangent.data(), kernel.data());
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
