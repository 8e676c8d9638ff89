// A network corrected to keep the mean of its input, over an inner one with second derivatives.
#include "networks/mean_matched.h"

#include <gtest/gtest.h>

#include "tests/networks/examination.h"

namespace isoline::networks {
namespace {

constexpr Index kSize = 6, kSamples = 4;

std::unique_ptr<Network> inner() {
  return make_network("mlp[layers=5-4,activation=tanh,precision=double]",
                      {.inputs = kSize, .outputs = kSize});
}

class MeanMatchedNetwork : public ::testing::Test {
 protected:
  const MeanMatched network{inner()};
  RandomStream stream{1, "mean-matched", "test"};
  NetworkExamination at{network, kSamples, stream};
};

TEST_F(MeanMatchedNetwork, KeepsTheMeanOfEachSampleAndTheShapeOfTheOutput) {
  Matrix plain(kSize, kSamples);
  Workspace w;
  inner()->forward(at.theta(), at.in(), plain, w);
  EXPECT_LE((at.x().colwise().mean() - at.in().colwise().mean()).norm(), 1e-15);
  const Matrix shift = at.x() - plain;
  for (Index b = 0; b < kSamples; ++b)
    EXPECT_LE((shift.col(b).array() - shift(0, b)).matrix().norm(), 1e-15);
}

TEST_F(MeanMatchedNetwork, ItsProductsBelongTogether) {
  const Vector v = at.direction();
  const Matrix u = at.cotangent(), du = at.cotangent();
  EXPECT_NEAR(u.cwiseProduct(at.push(v)).sum(), v.dot(at.pull(u)), 1e-12);
  const auto value = [&](Real h, const Vector& along) {
    return at.forward_at(at.theta() + h * along, at.in());
  };
  EXPECT_LE(at.gap(value, [&](const Vector& along) { return at.push(along); }),
            at.difference_limit());
  const auto gradient = [&](Real h, const Vector& along) {
    return at.pull_at(at.theta() + h * along, u + h * du);
  };
  EXPECT_LE(at.gap(gradient, [&](const Vector& along) { return at.curvature(along, u, du); }),
            at.difference_limit());
}

TEST_F(MeanMatchedNetwork, JacobianAndFactorsAreThoseOfItsPullback) {
  const Matrix u = at.cotangent();
  const Matrix J = at.jacobian(u.reshaped(1, kSize * kSamples));  // one row a sample: its own u
  const Vector g = at.pull(u);
  EXPECT_LE((J.colwise().sum().transpose() - g).norm(), 1e-14 * g.norm());
  const LayerFactor last = at.factors(u).back();
  EXPECT_LE((last.cotangents.rowwise().sum() - g.tail(kSize)).norm(), 1e-14 * g.norm());
}

TEST_F(MeanMatchedNetwork, InfersWhatItTrains) {
  Matrix x(kSize, kSamples);
  Workspace w;
  network.infer(at.theta(), network.statistics(at.theta(), at.in(), w), at.in(), x, w);
  EXPECT_EQ(x, at.x());
}

TEST(MeanMatched, WantsAsManyOutputsAsInputs) {
  EXPECT_THROW(MeanMatched(make_network("mlp", {.inputs = 2, .outputs = 3})), UsageError);
}

}  // namespace
}  // namespace isoline::networks
