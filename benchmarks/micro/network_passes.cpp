// A perceptron's forward pass and pullback over the matrix products they consist of, and its batch
// Jacobian over those and writing the Jacobian once; 2-32-64-32-2, a batch of 100, as the sine
// problem learns. OpenBLAS is called past its door on purpose.
#include <cblas.h>

#include <array>

#include "benchmarks/micro/pairs.h"
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

}  // namespace isoline::benchmarks::micro
