// What every registered network must satisfy, at its default options and some others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/spec.h"
#include "networks/mean_matched.h"
#include "networks/network.h"

namespace isoline::networks {

namespace {

// A network measured at a random input and cotangent around its start.
class NetworkExamination {
 public:
  NetworkExamination(const Network& network, Index samples, RandomStream& stream)
      : network_(network), stream_(stream), samples_(samples), theta_(network.start(stream)) {
    // Nothing stays at its start: a bias of zero would hide a missing term.
    theta_ += 0.1 * direction();
    in_ = normal(network.inputs());
    x_.resize(network.outputs(), samples);
    network.forward(theta_, in_, x_, w_);
  }

  const Vector& theta() const { return theta_; }
  const Matrix& in() const { return in_; }
  const Matrix& x() const { return x_; }

  // Each number as large as its parameter, or a tenth of the root mean square where that is zero:
  // a step of h changes small and large blocks alike by about the fraction h.
  Vector direction() {
    const Vector v = stream_.normal_vector(network_.parameters());
    const Real floor = 0.1 * theta_.norm() / std::sqrt(Real(v.size()));
    return v.array() * theta_.array().abs().max(floor);
  }
  Matrix normal(Index rows) {
    return stream_.normal_vector(rows * samples_).reshaped(rows, samples_);
  }
  Matrix cotangent() { return normal(network_.outputs()); }

  Matrix push(VectorRef v) {
    Matrix Jv(x_.rows(), samples_);
    network_.pushforward(v, Jv, w_);
    return Jv;
  }
  Vector pull(BatchRef u) { return pull(u, w_); }
  Vector curvature(VectorRef v, BatchRef u, BatchRef du) {
    Vector out(network_.parameters());
    push(v);
    network_.curvature(v, u, du, out, w_);
    return out;
  }
  Matrix jacobian(BatchRef dy_dx) {
    Matrix J(dy_dx.rows() * samples_, network_.parameters());
    network_.jacobian(dy_dx, J, w_);
    return J;
  }
  std::vector<LayerFactor> factors(BatchRef u) {
    std::vector<LayerFactor> all;
    network_.layer_factors(u, all, w_);
    return all;
  }

  Matrix forward_at(VectorRef theta, BatchRef in) const {
    Workspace w;
    return forward_at(theta, in, w);
  }
  Vector pull_at(VectorRef theta, BatchRef u) const {
    Workspace w;
    forward_at(theta, in_, w);
    return pull(u, w);
  }

  // The gap between `derivative(v)` and central differences of `value(h, v)`, relative to the
  // larger. Where steps may cross a kink, the direction of many along which differences over h and
  // h/2 agree best: they do not where one was crossed.
  template <class Value, class Derivative>
  Real gap(Value value, Derivative derivative) {
    constexpr int kDirections = 30;
    Real best = std::numeric_limits<Real>::infinity(), result = 1;
    for (int i = 0; i < (network_.has_kinks() ? kDirections : 1); ++i) {
      const Vector v = direction();
      const auto difference = [&](Real h) -> Matrix {
        return (value(h, v) - value(-h, v)) / (2 * h);
      };
      const Matrix wide = difference(step()), narrow = difference(step() / 2);
      const Real disagreement = (wide - narrow).norm() / narrow.norm();
      if (disagreement >= best) continue;
      best = disagreement;
      const Matrix exact = derivative(v);
      result = (narrow - exact).norm() / std::max(narrow.norm(), exact.norm());
    }
    return result;
  }

  // ε^⅓ leaves truncation of h² and rounding of ε/h, amplified by the depth. In a large network
  // some of its kinks, a part of the order of h, are crossed by every step.
  Real step() const { return network_.is_single_precision() ? 4e-3 : 6e-6; }
  Real difference_limit() const {
    if (!network_.is_single_precision()) return 1e-7;
    return network_.has_kinks() ? 1e-2 : 1e-3;
  }
  // A few roundings of the type, with room for cancellation.
  Real rounding() const { return network_.is_single_precision() ? 1e-5 : 1e-12; }

 private:
  Matrix forward_at(VectorRef theta, BatchRef in, Workspace& w) const {
    Matrix x(network_.outputs(), in.cols());
    network_.forward(theta, in, x, w);
    return x;
  }
  Vector pull(BatchRef u, Workspace& w) const {
    Vector JTu(network_.parameters());
    network_.pullback(u, JTu, w);
    return JTu;
  }

  const Network& network_;
  RandomStream& stream_;
  Index samples_;
  Vector theta_;
  Matrix in_, x_;
  Workspace w_;  // of the forward pass at theta_
};

constexpr Index kSamples = 5;
constexpr Real kDenseEntries = 4e6;  // of a Jacobian that is formed row by row

std::vector<std::string> specs() {
  std::vector<std::string> all = {"mlp[activation=tanh,layers=7]",
                                  "mlp[activation=sigmoid,layers=16-64-16,precision=double]",
                                  "mlp[activation=gelu,init=glorot]",
                                  "mlp[activation=gelu,precision=double]",
                                  "mlp[activation=relu,precision=double,layers=9-5]",
                                  "mlp[activation=tanh,precision=double,init=glorot]",
                                  "fno[modes=3,width=5]",
                                  "mean-matched"};
  for (const std::string& name : network_registry().names()) all.push_back(name);
  return all;
}

std::unique_ptr<Network> inner() {
  return make_network("mlp[layers=5-4,activation=tanh,precision=double]",
                      {.inputs = 6, .outputs = 6});
}

// From vectors to vectors where it can, from grids to grids elsewhere.
std::unique_ptr<Network> make(const std::string& spec) {
  if (spec == "mean-matched") return std::make_unique<MeanMatched>(inner());
  try {
    return make_network(spec, {.inputs = 2, .outputs = 3});
  } catch (const UsageError&) {
    return make_network(spec, {.inputs = 256, .outputs = 256, .grid = 16});
  }
}

class EveryNetwork : public ::testing::TestWithParam<std::string> {
 protected:
  const std::unique_ptr<Network> network = make(GetParam());
  RandomStream stream{1, "network", "conformance"};
  NetworkExamination at{*network, kSamples, stream};
};

TEST_P(EveryNetwork, PullbackIsTheAdjointOfPushforward) {
  const Vector v = at.direction();
  const Matrix u = at.cotangent(), Jv = at.push(v);
  const Vector JTu = at.pull(u);
  const Real scale = u.norm() * Jv.norm() + v.norm() * JTu.norm();
  EXPECT_LE(std::abs(u.cwiseProduct(Jv).sum() - v.dot(JTu)), at.rounding() * scale);
}

// Thousands of kinks, each felt by every sample, lie within any step that single precision
// resolves: such a network is held to a reference of its own.
bool are_differences_blurred(const Network& network) {
  return network.has_kinks() && network.is_single_precision() && !network.has_independent_samples();
}

TEST_P(EveryNetwork, PushforwardIsTheChangeOfForward) {
  if (are_differences_blurred(*network)) GTEST_SKIP() << "kinks";
  const Real gap =
      at.gap([&](Real h, const Vector& v) { return at.forward_at(at.theta() + h * v, at.in()); },
             [&](const Vector& v) { return at.push(v); });
  EXPECT_LE(gap, at.difference_limit());
}

TEST_P(EveryNetwork, CurvatureIsTheChangeOfPullback) {
  if (!network->has_curvature()) GTEST_SKIP() << "no second derivatives";
  if (are_differences_blurred(*network)) GTEST_SKIP() << "kinks";
  const Matrix u = at.cotangent(), du = at.cotangent();
  const Real gap =
      at.gap([&](Real h, const Vector& v) { return at.pull_at(at.theta() + h * v, u + h * du); },
             [&](const Vector& v) { return at.curvature(v, u, du); });
  EXPECT_LE(gap, at.difference_limit());
}

TEST_P(EveryNetwork, CurvatureIsSymmetric) {
  if (!network->has_curvature()) GTEST_SKIP() << "no second derivatives";
  const Matrix u = at.cotangent(), none = 0 * u;
  const Vector v = at.direction(), w = at.direction();
  const Vector Hv = at.curvature(v, u, none), Hw = at.curvature(w, u, none);
  const Real scale = Hv.norm() * w.norm() + Hw.norm() * v.norm();
  EXPECT_LE(std::abs(w.dot(Hv) - v.dot(Hw)), at.rounding() * scale);
}

TEST_P(EveryNetwork, JacobianHasThePullbacksAsRows) {
  constexpr Index kRows = 2;
  const Index n = network->parameters(), k = network->outputs();
  if (Real(kRows * kSamples * n) > kDenseEntries) GTEST_SKIP() << "too large";
  const Matrix dy_dx = stream.normal_vector(kRows * k * kSamples).reshaped(kRows, k * kSamples);
  const Matrix J = at.jacobian(dy_dx);
  Matrix rows(kRows * kSamples, n);
  for (Index b = 0; b < kSamples; ++b) {
    for (Index i = 0; i < kRows; ++i) {
      Matrix u = Matrix::Zero(k, kSamples);
      u.col(b) = dy_dx.row(i).segment(b * k, k);
      rows.row(b * kRows + i) = at.pull(u);
    }
  }
  EXPECT_LE((J - rows).norm(), at.rounding() * rows.norm());
}

TEST_P(EveryNetwork, LayerFactorsMakeTheGradient) {
  if (!network->has_layer_factors()) GTEST_SKIP() << "no dense layers";
  const Matrix u = at.cotangent();
  const Vector g = at.pull(u);
  const std::vector<Block> blocks = network->layout();
  for (const LayerFactor& factor : at.factors(u)) {
    const Block& W = blocks.at(static_cast<std::size_t>(factor.weight));
    const Block& b = blocks.at(static_cast<std::size_t>(factor.bias));
    const Matrix product = factor.cotangents * factor.inputs.transpose();
    const Vector sum = factor.cotangents.rowwise().sum();
    EXPECT_LE((product.reshaped() - g.segment(W.offset, W.rows * W.columns)).norm(),
              at.rounding() * product.norm());
    EXPECT_LE((sum - g.segment(b.offset, b.rows)).norm(), at.rounding() * g.norm());
  }
}

TEST_P(EveryNetwork, LayoutCoversTheParametersOnceInOrder) {
  Index next = 0;
  for (const Block& block : network->layout()) {
    EXPECT_EQ(block.offset, next);
    next += block.rows * block.columns;
  }
  EXPECT_EQ(next, network->parameters());
}

TEST_P(EveryNetwork, TreatsEachSampleAsIfItWereAlone) {
  if (!network->has_independent_samples()) GTEST_SKIP() << "depends on its batch";
  for (Index b = 0; b < kSamples; ++b)
    EXPECT_LE((at.forward_at(at.theta(), at.in().col(b)) - at.x().col(b)).norm(),
              at.rounding() * at.x().col(b).norm());
}

TEST_P(EveryNetwork, GivesTheSameBitsTwiceWhereverThetaLies) {
  const Matrix u = at.cotangent();
  const Vector g = at.pull(u);
  EXPECT_EQ(at.pull(u), g);
  EXPECT_EQ(at.pull_at(at.theta(), u), g);
  for (Index offset = 1; offset < 8; offset += 3) {
    Vector shifted(at.theta().size() + 8);
    shifted.segment(offset, at.theta().size()) = at.theta();
    const Eigen::Ref<const Vector> theta = shifted.segment(offset, at.theta().size());
    EXPECT_EQ(at.forward_at(theta, at.in()), at.x()) << offset;
    EXPECT_EQ(at.pull_at(theta, u), g) << offset;
  }
}

// In a batch of one size.
TEST_P(EveryNetwork, GivesASampleTheSameBitsAtEachPlaceOfItsBatch) {
  constexpr Index kPlaces[kSamples] = {4, 0, 3, 0, 2};  // permuted, and one repeated
  Matrix in(at.in().rows(), kSamples);
  for (Index b = 0; b < kSamples; ++b) in.col(b) = at.in().col(kPlaces[b]);
  Workspace w;
  const Vector statistics = network->statistics(at.theta(), at.in(), w);
  Matrix inferred(at.x().rows(), kSamples), moved = inferred;
  network->infer(at.theta(), statistics, at.in(), inferred, w);
  network->infer(at.theta(), statistics, in, moved, w);
  const Matrix x = at.forward_at(at.theta(), in);
  for (Index b = 0; b < kSamples; ++b) {
    EXPECT_EQ(moved.col(b), inferred.col(kPlaces[b])) << "inferred, at place " << b;
    if (network->has_independent_samples()) {
      EXPECT_EQ(x.col(b), at.x().col(kPlaces[b])) << b;
    }
  }
}

TEST_P(EveryNetwork, StartsFromItsStreamAlone) {
  RandomStream first(3, "network", "start"), second(3, "network", "start"),
      other(4, "network", "start");
  const Vector start = network->start(first);
  ASSERT_EQ(start.size(), network->parameters());
  EXPECT_EQ(start, network->start(second));
  EXPECT_NE(start, network->start(other));
  EXPECT_TRUE(is_finite(start));
}

TEST_P(EveryNetwork, SaysWhatItIs) {
  if (GetParam() == "mean-matched") GTEST_SKIP() << "a part of a problem";
  const NetworkEntry& entry = network_registry().at(parse_spec(GetParam()).name);
  EXPECT_FALSE(entry.title.empty());
  EXPECT_FALSE(entry.source.empty());
  for (const OptionField& option : entry.options) EXPECT_FALSE(option.doc.empty()) << option.name;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace_if(
      name, [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryNetwork, ::testing::ValuesIn(specs()), test_name);

TEST(MeanMatched, KeepsTheMeanOfEachSampleAndTheShapeOfTheOutput) {
  const auto network = make("mean-matched");
  RandomStream stream{1, "mean-matched", "test"};
  NetworkExamination at{*network, kSamples, stream};
  Matrix plain(6, kSamples), inferred(6, kSamples);
  Workspace w, v;
  inner()->forward(at.theta(), at.in(), plain, w);
  EXPECT_LE((at.x().colwise().mean() - at.in().colwise().mean()).norm(), 1e-15);
  const Matrix shift = at.x() - plain;
  for (Index b = 0; b < kSamples; ++b)
    EXPECT_LE((shift.col(b).array() - shift(0, b)).matrix().norm(), 1e-15);
  network->infer(at.theta(), network->statistics(at.theta(), at.in(), v), at.in(), inferred, v);
  EXPECT_EQ(inferred, at.x());
  EXPECT_THROW(MeanMatched(make_network("mlp", {.inputs = 2, .outputs = 3})), UsageError);
}

}  // namespace
}  // namespace isoline::networks
