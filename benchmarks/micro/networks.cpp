// A perceptron's forward pass and pullback over the matrix products they consist of, and its batch
// Jacobian over those and writing the Jacobian once; 2-32-64-32-2, a batch of 100, as the sine
// problem learns. OpenBLAS is called without its adapter on purpose.
#include <cblas.h>

#include <array>
#include <oneapi/dnnl/dnnl.hpp>

#include "benchmarks/micro/pairs.h"
#include "core/threads.h"
#include "networks/network.h"

namespace isoline::benchmarks::micro {

using networks::make_network;
using networks::Network;
namespace {

constexpr Index kSamples = 100, kRows = 2;  // B, rows of the Jacobian a sample
constexpr std::array<int, 5> kWidths = {2, 32, 64, 32, 2};

void gemm(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, int m, int n, int k, const float* A, int lda,
          const float* B, int ldb, float* C) {
  cblas_sgemm(CblasColMajor, a, b, m, n, k, 1, A, lda, B, ldb, 0, C, m);
}

void gemm(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, int m, int n, int k, const double* A, int lda,
          const double* B, int ldb, double* C) {
  cblas_dgemm(CblasColMajor, a, b, m, n, k, 1, A, lda, B, ldb, 0, C, m);
}

// The products alone, without activations, biases and conversions.
template <class Scalar>
struct BareProducts {
  using Array = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  std::array<Array, 5> a, g;  // (w, B) and, for the Jacobian, (w, m·B)
  std::array<Array, 4> W, dW;
  Matrix J;  // (m·B, n)

  BareProducts() {
    Index parameters = 0;
    for (std::size_t l = 0; l < kWidths.size(); ++l) {
      a[l].setRandom(kWidths[l], kSamples);
      g[l].setRandom(kWidths[l], kRows * kSamples);
      if (l == 0) continue;
      W[l - 1].setRandom(kWidths[l], kWidths[l - 1]);
      dW[l - 1] = W[l - 1];
      parameters += W[l - 1].size() + kWidths[l];
    }
    J.setZero(kRows * kSamples, parameters);
  }

  void forward() {
    for (std::size_t l = 0; l < 4; ++l)
      gemm(CblasNoTrans, CblasNoTrans, kWidths[l + 1], kSamples, kWidths[l], W[l].data(),
           kWidths[l + 1], a[l].data(), kWidths[l], a[l + 1].data());
  }
  void propagate(Index columns) {
    for (std::size_t l = 3; l > 0; --l)
      gemm(CblasTrans, CblasNoTrans, kWidths[l], static_cast<int>(columns), kWidths[l + 1],
           W[l].data(), kWidths[l + 1], g[l + 1].data(), kWidths[l + 1], g[l].data());
  }
  void pullback() {
    propagate(kSamples);
    for (std::size_t l = 0; l < 4; ++l)
      gemm(CblasNoTrans, CblasTrans, kWidths[l + 1], kWidths[l], kSamples, g[l + 1].data(),
           kWidths[l + 1], a[l].data(), kWidths[l], dW[l].data());
  }
  void jacobian() {
    propagate(kRows * kSamples);
    J.setConstant(1);
  }
};

struct Passes {
  explicit Passes(const std::string& precision)
      : network(make_network("mlp[layers=32-64-32,precision=" + precision + "]",
                             {.inputs = 2, .outputs = 2})) {
    RandomStream stream(0, "mlp", "benchmark");
    theta = network->start(stream);
    in = stream.uniform_vector(2 * kSamples, -1, 1).reshaped(2, kSamples);
    dy_dx = stream.normal_vector(4 * kSamples).reshaped(kRows, 2 * kSamples);
    x = u = in;
    gradient.resizeLike(theta);
    J.resize(kRows * kSamples, theta.size());
    network->forward(theta, in, x, w);
  }
  void step() {
    network->forward(theta, in, x, w);
    network->pullback(u, gradient, w);
  }
  void jacobian() { network->jacobian(dy_dx, J, w); }

  std::unique_ptr<Network> network;
  Vector theta, gradient;
  Matrix in, dy_dx, x, u, J;
  Workspace w;
};

template <class Scalar>
void register_precision(const std::string& precision) {
  constexpr int kCalls = 20, kPairs = 301;
  const std::string name = "networks/mlp[precision=" + precision + "]";
  const auto pair = [=](auto ours, auto bare) {
    return [=] {
      const auto passes = std::make_shared<Passes>(precision);
      const auto products = std::make_shared<BareProducts<Scalar>>();
      return Pair{[=] { return cost_of(kCalls, [&] { ours(*passes); }); },
                  [=] { return cost_of(kCalls, [&] { bare(*products); }); }};
    };
  };
  register_pair(name + "/forward-and-pullback", kPairs, {.ratio = 1.5},
                pair([](Passes& p) { p.step(); },
                     [](BareProducts<Scalar>& b) {
                       b.forward();
                       b.pullback();
                     }));
  register_pair(
      name + "/jacobian", kPairs, {.ratio = 2},
      pair([](Passes& p) { p.jacobian(); }, [](BareProducts<Scalar>& b) { b.jacobian(); }));
}

// A training step of the U-net over the bare convolutions it contains, by oneDNN in the layouts
// that it likes best, on two threads; and a step with second derivatives over one without. oneDNN
// is called without its adapter on purpose: the measurement includes the adapter. unet_pytorch.py
// beside this file times the same step in PyTorch.

constexpr Index kN = 64, kBatch = 128, kThreads = 2;

// The training step of 41 GFLOP: levels=4, filters=16, padding=circular.
struct Steps {
  std::unique_ptr<Network> network =
      make_network("unet", {.inputs = kN * kN, .outputs = kN * kN, .grid = kN});
  Vector theta, v, gradient;
  Matrix in, u, x;
  Workspace w;

  Steps() {
    RandomStream stream(0, "unet", "micro");
    const Index n = network->parameters(), size = kN * kN * kBatch;
    theta = network->start(stream);
    v = gradient = stream.normal_vector(n);
    in = stream.normal_vector(size).reshaped(kN * kN, kBatch);
    u = stream.normal_vector(size).reshaped(kN * kN, kBatch);
    x = u;
  }
  Cost first_order() {
    return cost_of(1, [this] {
      network->forward(theta, in, x, w);
      network->pullback(u, gradient, w);
    });
  }
  Cost second_order() {
    return cost_of(1, [this] {
      network->pushforward(v, x, w);
      network->curvature(v, u, u, gradient, w);
    });
  }
};

// One convolution of the whole batch with its two pullbacks; the first needs none to its input.
class BareConvolution {
 public:
  using Dims = dnnl::memory::dims;

  BareConvolution(const dnnl::engine& engine, Index in, Index out, Index N, Index width)
      : has_input_gradient_(in > 1) {
    using namespace dnnl;
    const auto any = [](const Dims& sizes) {
      return memory::desc(sizes, memory::data_type::f32, memory::format_tag::any);
    };
    const memory::desc source = any({kBatch, in, N, N}), kernel = any({out, in, width, width});
    const memory::desc result = any({kBatch, out, N, N});
    const Dims strides{1, 1}, padding{width / 2, width / 2};
    constexpr auto kDirect = algorithm::convolution_direct;
    const convolution_forward::primitive_desc forward(
        {prop_kind::forward_training, kDirect, source, kernel, result, strides, padding, padding},
        engine);
    const convolution_backward_weights::primitive_desc to_kernel(
        {kDirect, source, kernel, result, strides, padding, padding}, engine, forward);
    const convolution_backward_data::primitive_desc to_input(
        {kDirect, source, kernel, result, strides, padding, padding}, engine, forward);
    const auto make = [&](const memory::desc& desc) { return filled(desc, engine); };
    calls_.push_back({convolution_forward(forward),
                      {{DNNL_ARG_SRC, make(forward.src_desc())},
                       {DNNL_ARG_WEIGHTS, make(forward.weights_desc())},
                       {DNNL_ARG_DST, make(forward.dst_desc())}}});
    calls_.push_back({convolution_backward_weights(to_kernel),
                      {{DNNL_ARG_SRC, make(to_kernel.src_desc())},
                       {DNNL_ARG_DIFF_DST, make(to_kernel.diff_dst_desc())},
                       {DNNL_ARG_DIFF_WEIGHTS, make(to_kernel.diff_weights_desc())}}});
    if (has_input_gradient_)
      calls_.push_back({convolution_backward_data(to_input),
                        {{DNNL_ARG_DIFF_DST, make(to_input.diff_dst_desc())},
                         {DNNL_ARG_WEIGHTS, make(to_input.weights_desc())},
                         {DNNL_ARG_DIFF_SRC, make(to_input.diff_src_desc())}}});
  }
  void run(dnnl::stream& stream) {
    for (auto& [primitive, arguments] : calls_) primitive.execute(stream, arguments);
  }

 private:
  static dnnl::memory filled(const dnnl::memory::desc& desc, const dnnl::engine& engine) {
    constexpr float kOrdinary = 0.01F;  // neither denormal nor growing
    dnnl::memory memory(desc, engine);
    std::fill_n(static_cast<float*>(memory.get_data_handle()), desc.get_size() / sizeof(float),
                kOrdinary);
    return memory;
  }

  bool has_input_gradient_;
  std::vector<std::pair<dnnl::primitive, std::unordered_map<int, dnnl::memory>>> calls_;
};

struct BareConvolutions {
  dnnl::engine engine{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream{engine};
  std::vector<std::pair<int, BareConvolution>> all;  // how many of a shape, and one of them

  BareConvolutions() {
    const auto add = [this](int count, Index in, Index out, Index N, Index width) {
      all.emplace_back(count, BareConvolution(engine, in, out, N, width));
    };
    add(1, 1, 16, kN, 3);
    add(2, 16, 16, kN, 3);
    for (const Index N : {kN / 2, kN / 4}) add(3, 16, 16, N, 3);
    add(2, 16, 16, kN / 8, 3);
    for (const Index N : {kN, kN / 2, kN / 4}) add(1, 32, 16, N, 3);
    add(1, 16, 1, kN, 1);
  }
  Cost run() {
    return cost_of(1, [this] {
      for (auto& [count, convolution] : all)
        for (int i = 0; i < count; ++i) convolution.run(stream);
    });
  }
};

}  // namespace

void register_networks() {
  register_precision<float>("float");
  register_precision<double>("double");
  register_pair("unet/step", 11, {.ratio = 2}, [] {
    set_library_threads(kThreads);
    const auto steps = std::make_shared<Steps>();
    const auto bare = std::make_shared<BareConvolutions>();
    return Pair{[=] { return steps->first_order(); }, [=] { return bare->run(); }};
  });
  register_pair("unet/curvature", 11, {.ratio = 3}, [] {
    set_library_threads(kThreads);
    const auto steps = std::make_shared<Steps>();
    steps->first_order();
    return Pair{[=] { return steps->second_order(); }, [=] { return steps->first_order(); }};
  });
}

}  // namespace isoline::benchmarks::micro
