// 3×3 convolutions, by oneDNN.
#include "core/convolution.h"

#include <algorithm>
#include <oneapi/dnnl/dnnl.hpp>
#include <unordered_map>
#include <utility>

#include "core/convolution_kernels.h"
#include "core/errors.h"
#include "core/threads.h"

namespace isoline {
namespace {

using Tag = dnnl::memory::format_tag;
using Descriptor = dnnl::memory::desc;

// Made at first use, so that nothing of oneDNN exists before a worker is forked.
const dnnl::engine& engine() {
  static const dnnl::engine processor(dnnl::engine::kind::cpu, 0);
  return processor;
}

Descriptor descriptor(const dnnl::memory::dims& sizes, Tag tag) {
  return {sizes, dnnl::memory::data_type::f32, tag};
}

struct Arrays {
  Descriptor in, kernel, out;

  explicit Arrays(const ConvolutionShape& s) {
    require(s.out % kChannels == 0 && (s.is_plain || s.in % kChannels == 0),
            "convolution: the channels must fill whole blocks");
    constexpr bool kIsWide = kChannels == 16;
    const Tag blocked = kIsWide ? Tag::nChw16c : Tag::nChw8c;
    const Tag kernels = kIsWide ? Tag::OIhw16i16o : Tag::OIhw8i8o;
    const Tag plain_kernels = kIsWide ? Tag::Ohwi16o : Tag::Ohwi8o;
    in = descriptor({s.images, s.in, s.N + 2, s.N + 2}, s.is_plain ? Tag::nchw : blocked);
    kernel = descriptor({s.out, s.in, 3, 3}, s.is_plain ? plain_kernels : kernels);
    out = descriptor({s.images, s.out, s.N, s.N}, blocked);
  }
};

constexpr std::pair<dnnl::cpu_isa, const char*> kInstructions[] = {
    {dnnl::cpu_isa::sse41, "SSE41"},
    {dnnl::cpu_isa::avx, "AVX"},
    {dnnl::cpu_isa::avx2, "AVX2"},
    {dnnl::cpu_isa::avx2_vnni, "AVX2_VNNI"},
    {dnnl::cpu_isa::avx512_core, "AVX512_CORE"},
    {dnnl::cpu_isa::avx512_core_vnni, "AVX512_CORE_VNNI"},
    {dnnl::cpu_isa::avx512_core_bf16, "AVX512_CORE_BF16"},
    {dnnl::cpu_isa::avx512_core_amx, "AVX512_CORE_AMX"}};

// A memory of the library's own must not be shared by threads: it is one of the arguments.
dnnl::primitive_attr attributes(bool adds) {
  dnnl::primitive_attr attr;
  attr.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  if (!adds) return attr;
  dnnl::post_ops sum;
  sum.append_sum();
  attr.set_post_ops(sum);
  return attr;
}

dnnl::convolution_forward::primitive_desc forward_of(const Arrays& arrays, bool adds) {
  const dnnl::convolution_forward::desc operation(
      dnnl::prop_kind::forward_training, dnnl::algorithm::convolution_direct, arrays.in,
      arrays.kernel, arrays.out, {1, 1}, {0, 0}, {0, 0});
  return {operation, attributes(adds), engine()};
}

dnnl::convolution_backward_weights::primitive_desc gradient_of(const Arrays& arrays) {
  const dnnl::convolution_backward_weights::desc operation(dnnl::algorithm::convolution_direct,
                                                           arrays.in, arrays.kernel, arrays.out,
                                                           {1, 1}, {0, 0}, {0, 0});
  return {operation, attributes(false), engine(), forward_of(arrays, false)};
}

}  // namespace

std::string convolution_instructions() {
  for (const auto& [code, name] : kInstructions)
    if (code == dnnl::get_effective_cpu_isa()) return name;
  return "others";
}

bool has_fast_convolutions(const std::string& limit) {
  const bool is_none = limit.empty() || limit == "ALL" || limit == "DEFAULT";
  return is_none || kChannels == 8 || limit.starts_with("AVX512_CORE");
}

// One primitive and its arguments; each call sets their addresses.
class ConvolutionCall {
 public:
  struct Argument {
    int name;
    Descriptor shape;
  };

  ConvolutionCall(const dnnl::primitive& primitive, const Descriptor& scratch,
                  const Argument& first, const Argument& second, const Argument& result)
      : primitive_(primitive), stream_(engine()), names_{first.name, second.name, result.name} {
    for (const Argument& each : {first, second, result})
      arguments_.emplace(each.name, dnnl::memory(each.shape, engine(), nullptr));
    arguments_.emplace(DNNL_ARG_SCRATCHPAD, dnnl::memory(scratch, engine()));
  }

  void operator()(const float* first, const float* second, float* result) {
    // oneDNN takes no pointers to const; the first two arrays are only read.
    arguments_.at(names_[0]).set_data_handle(const_cast<float*>(first));
    arguments_.at(names_[1]).set_data_handle(const_cast<float*>(second));
    arguments_.at(names_[2]).set_data_handle(result);
    primitive_.execute(stream_, arguments_);
  }

 private:
  dnnl::primitive primitive_;
  dnnl::stream stream_;
  int names_[3];
  std::unordered_map<int, dnnl::memory> arguments_;
};

Convolution::Convolution(const ConvolutionShape& shape, bool adds) {
  const OneThread alone;  // a primitive is made for the number of threads of its maker
  const Arrays arrays(shape);
  const auto forward = forward_of(arrays, adds);
  call_ = std::make_unique<ConvolutionCall>(
      dnnl::convolution_forward(forward), forward.scratchpad_desc(),
      ConvolutionCall::Argument{DNNL_ARG_SRC, arrays.in},
      ConvolutionCall::Argument{DNNL_ARG_WEIGHTS, arrays.kernel},
      ConvolutionCall::Argument{DNNL_ARG_DST, arrays.out});
}

void Convolution::operator()(const float* in, const float* kernel, float* out) {
  (*call_)(in, kernel, out);
}

// oneDNN's AVX2 kernels for gradients take whole blocks or three plain channels. One or two it
// leaves to its reference, a hundred times as slow: they are handed over among zeros.
class ThreeChannels {
 public:
  static constexpr Index kCount = 3;

  static bool are_wanted(const ConvolutionShape& s) {
    return s.is_plain && kChannels == 8 && s.in < kCount;
  }
  explicit ThreeChannels(const ConvolutionShape& shape) : narrow_(shape), wide_(shape) {
    wide_.in = kCount;
    const Arrays arrays(wide_);
    in_ = dnnl::memory(arrays.in, engine());
    kernel_ = dnnl::memory(arrays.kernel, engine());
    std::fill_n(in(), wide_.images * kCount * pixels(), 0.0F);
  }
  const ConvolutionShape& shape() const { return wide_; }
  float* in() const { return static_cast<float*>(in_.get_data_handle()); }
  float* kernel() const { return static_cast<float*>(kernel_.get_data_handle()); }

  void read_in(const float* from) {
    const Index count = narrow_.in * pixels();
    for (Index image = 0; image < narrow_.images; ++image)
      std::copy_n(from + image * count, count, in() + image * kCount * pixels());
  }
  void write_kernel(float* to) const {  // [block out][3][3][in][out]
    const Index count = narrow_.in * kChannels, taps = narrow_.out / kChannels * 9;
    for (Index tap = 0; tap < taps; ++tap)
      std::copy_n(kernel() + tap * kCount * kChannels, count, to + tap * count);
  }

 private:
  Index pixels() const { return (narrow_.N + 2) * (narrow_.N + 2); }

  ConvolutionShape narrow_, wide_;
  dnnl::memory in_, kernel_;
};

KernelGradient::KernelGradient(const ConvolutionShape& shape) {
  const OneThread alone;
  if (ThreeChannels::are_wanted(shape)) widened_ = std::make_unique<ThreeChannels>(shape);
  const Arrays arrays(widened_ ? widened_->shape() : shape);
  const auto gradient = gradient_of(arrays);
  call_ = std::make_unique<ConvolutionCall>(
      dnnl::convolution_backward_weights(gradient), gradient.scratchpad_desc(),
      ConvolutionCall::Argument{DNNL_ARG_SRC, arrays.in},
      ConvolutionCall::Argument{DNNL_ARG_DIFF_DST, arrays.out},
      ConvolutionCall::Argument{DNNL_ARG_DIFF_WEIGHTS, arrays.kernel});
}

void KernelGradient::operator()(const float* in, const float* cotangent, float* kernel) {
  if (!widened_) return (*call_)(in, cotangent, kernel);
  widened_->read_in(in);
  (*call_)(widened_->in(), cotangent, widened_->kernel());
  widened_->write_kernel(kernel);
}

Convolution::Convolution(Convolution&&) noexcept = default;
Convolution::~Convolution() = default;
KernelGradient::KernelGradient(KernelGradient&&) noexcept = default;
KernelGradient::~KernelGradient() = default;

}  // namespace isoline
