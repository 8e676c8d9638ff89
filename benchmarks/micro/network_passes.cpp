// A perceptron's forward pass and pullback over the matrix products they consist of, and its batch
// Jacobian over those and writing the Jacobian once; 2-32-64-32-2, a batch of 100, as the sine
// problem learns. OpenBLAS is called past its door on purpose.
#include <cblas.h>
#include <lapacke.h>

#include <array>
#include <oneapi/dnnl/dnnl.hpp>

#include "benchmarks/micro/pairs.h"
#include "core/threads.h"
#include "networks/network.h"
#include "problems/dense_physics.h"
#include "problems/problem.h"

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

}  // namespace

void register_networks() {
  register_precision<float>("float");
  register_precision<double>("double");
}

// A training step of the U-net over the bare convolutions it contains, by oneDNN in the layouts
// that it likes best, on two threads; and a step with second derivatives over one without. oneDNN
// is called past its door on purpose: the door is part of what is measured. unet_pytorch.py beside
// this file times the same step in PyTorch.

using networks::make_network;
using networks::Network;
namespace {

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

// Raises the threads of the whole program, and is therefore called last.
void register_unet() {
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

// One step of the training methods on a mini-batch: over a step of Adam on the same problem, and of
// half-inverse gradients over the Gram product and eigendecomposition that it cannot do without.

using networks::make_network;
using problems::DensePhysics;
namespace {

// A few steps at a time, or the scheduler of a busy machine would interrupt each reading.
constexpr int kSteps = 4, kPairs = 601;

// A method that has taken its first steps, which size its state.
struct Underway {
  Underway(const Problem& problem, const std::string& spec)
      : trial(problem, spec, endless()), theta(problem.start()) {
    trial.meter.begin(theta);
    trial.method->start(trial.meter, theta);
    run();
  }
  Cost run() {
    return cost_of(kSteps, [this] { trial.method->step(trial.meter, theta); });
  }

  Trial trial;
  Vector theta;
};

void add_over_adam(const std::string& problem_spec, const std::string& spec, const Goal& goal) {
  register_pair("training/" + spec + "/" + problem_spec, kPairs, goal, [=] {
    const auto problem = std::make_shared<const Problem>(make_problem(problem_spec));
    const auto ours = std::make_shared<Underway>(*problem, spec);
    const auto adam = std::make_shared<Underway>(*problem, "adam");
    return Pair{[problem, ours] { return ours->run(); }, [=] { return adam->run(); }};
  });
}

class Unchanged final : public DensePhysics {  // y = x
 public:
  Unchanged() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y = x; }
  void derivative(VectorRef, BatchOut J) const override { J.setIdentity(); }
};

// ŷ(t) = (sin 6t, cos 9t) by 7 tanh neurons, 30 parameters, 256 samples.
Problem toy() {
  auto network = make_network("mlp[layers=7,activation=tanh]", {.inputs = 1, .outputs = 2});
  constexpr Index kTimes = 256;
  const Matrix t = Vector::LinSpaced(kTimes, -1, 1).transpose();
  Matrix target(2, kTimes);
  target << (6 * t.array()).sin().matrix(), (9 * t.array()).cos().matrix();
  RandomStream stream(0, "toy", "network");
  const Vector start = network->start(stream);
  return Problem({.physics = std::make_unique<Unchanged>(),
                  .start = start,
                  .target = target,
                  .network = std::move(network),
                  .input = t,
                  .minimum = 0});
}

// JᵀJ = V diag(λ) Vᵀ of the toy's J, (512, 30).
struct BareGram {
  explicit BareGram(const Problem& problem) {
    Point at;
    problem.forward(problem.start(), at);
    problem.jacobian(J, at);
    gram.resize(J.cols(), J.cols());
    lambda.resize(J.cols());
  }
  Cost run() {
    return cost_of(kSteps, [this] {
      const int m = static_cast<int>(J.rows()), n = static_cast<int>(J.cols());
      cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, n, m, 1, J.data(), m, 0, gram.data(), n);
      LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', n, gram.data(), n, lambda.data());
    });
  }

  Matrix J, gram;
  Vector lambda;
};

}  // namespace

void register_training() {
  const std::string sine = "sine[mode=learn,xi=32]";
  const std::string in_double = "sine[mode=learn,xi=32,network=mlp[precision=double]]";
  for (const std::string& problem : {sine, in_double}) {
    for (const char* spec : {"sip[inverse=newton,proxy=l1]", "sip[inverse=analytic]"})
      add_over_adam(problem, spec, {.ratio = 1.15});
    add_over_adam(problem, "adahessian", {.ratio = 4});
    for (const char* spec : {"supervised", "kfac"}) add_over_adam(problem, spec, {});
  }
  register_pair("training/hig/toy", kPairs, {.ratio = 2}, [] {
    const auto problem = std::make_shared<const Problem>(toy());
    const auto ours = std::make_shared<Underway>(*problem, "hig");
    const auto bare = std::make_shared<BareGram>(*problem);
    return Pair{[problem, ours] { return ours->run(); }, [=] { return bare->run(); }};
  });
}

}  // namespace isoline::benchmarks::micro
