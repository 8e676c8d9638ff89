// Random streams are named, reproducible and well spread.
#include "core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isoline {
namespace {

TEST(RandomStream, TheSameKeyGivesTheSameDraws) {
  RandomStream a(1, "sine", "start"), b(1, "sine", "start");
  EXPECT_EQ(a.normal_vector(100), b.normal_vector(100));
}

TEST(RandomStream, EveryPartOfTheKeyMatters) {
  const Vector drawn = RandomStream(1, "sine", "start", 0).normal_vector(4);
  EXPECT_NE(RandomStream(2, "sine", "start", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "heat", "start", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "sine", "target", 0).normal_vector(4), drawn);
  EXPECT_NE(RandomStream(1, "sine", "start", 1).normal_vector(4), drawn);
}

// Means and variances of n draws lie within five standard errors of the law's own: a fixed seed
// makes the outcome certain, and a wrong law misses by far more.
TEST(RandomStream, UniformAndNormalHaveTheirMoments) {
  constexpr Index kDraws = 100'000;
  RandomStream stream(3, "test", "moments");
  const Vector uniform = stream.uniform_vector(kDraws, 0, 1);
  const Vector normal = stream.normal_vector(kDraws);
  const Real root = std::sqrt(Real(kDraws));
  EXPECT_GE(uniform.minCoeff(), 0);
  EXPECT_LT(uniform.maxCoeff(), 1);
  EXPECT_NEAR(uniform.mean(), 0.5, 5 * std::sqrt(1.0 / 12) / root);
  EXPECT_NEAR(normal.mean(), 0, 5 / root);
  EXPECT_NEAR(normal.squaredNorm() / kDraws, 1, 5 * std::sqrt(2.0) / root);
}

TEST(RandomStream, SignsAreFairAndOfBothKinds) {
  constexpr Index kCount = 100001;  // no multiple of what one draw yields
  Vector z(kCount);
  RandomStream(1, "test", "signs").signs(z);
  EXPECT_TRUE((z.cwiseAbs().array() == 1).all());
  EXPECT_LT(std::abs(z.mean()), 4 / std::sqrt(kCount));  // four standard deviations
  EXPECT_LT(std::abs(z.head(kCount - 1).dot(z.tail(kCount - 1)) / kCount), 4 / std::sqrt(kCount));
}

}  // namespace
}  // namespace isoline
