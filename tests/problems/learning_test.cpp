// Learning problems: their samples, the laws of these, and the derivatives through a network.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

const std::vector<std::string> kLearned = {
    "sine[mode=learn,xi=32]",
    "exponential[mode=learn]",
    "poisson[mode=learn,N=16,batch=3,network=unet[levels=2]]",
    "heat[mode=learn,N=16,batch=3,network=unet[levels=2]]",
    "burgers[mode=learn,N=16,batch=3]",
    "hig-toy"};

Batch batch_of(const Problem& problem, std::int64_t step) {
  Batch batch;
  problem.draw_batch(step, batch);
  return batch;
}

TEST(Learning, EachStepHasItsOwnSamplesAndTheSameEveryTime) {
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, 1), again = make(spec, 1), other = make(spec, 2);
    EXPECT_EQ(batch_of(problem, 3).target, batch_of(again, 3).target) << spec;
    EXPECT_NE(batch_of(problem, 3).target, batch_of(other, 3).target) << spec;
    if (problem.has_fresh_batches()) {
      EXPECT_NE(batch_of(problem, 3).target, batch_of(problem, 4).target) << spec;
    }
    Batch validation;
    problem.draw_validation(validation);
    EXPECT_NE(validation.target.col(0), problem.target().col(0)) << spec;
  }
}

TEST(Learning, BatchSizesAndSweepsSeeTheSameSamples) {
  const Problem small = make("sine[mode=learn,batch=4]"), large = make("sine[mode=learn,batch=8]");
  EXPECT_EQ(batch_of(large, 0).target.leftCols(4), batch_of(small, 0).target);
  EXPECT_EQ(batch_of(large, 0).target.rightCols(4), batch_of(small, 1).target);
  EXPECT_EQ(batch_of(make("sine[mode=learn,xi=1]"), 5).target,
            batch_of(make("sine[mode=learn,xi=64]"), 5).target);
}

TEST(Learning, OnFiniteDataEveryStepHasAllSamples) {
  const Problem problem = make("sine[mode=learn,data=37]");
  EXPECT_FALSE(problem.has_fresh_batches());
  EXPECT_EQ(problem.samples(), 37);
  EXPECT_EQ(batch_of(problem, 9).target, problem.target());
}

// Instance 2 with start 1: the data of seed 2, θ₀ and fresh batches of seed 1.
TEST(Learning, APairHasTheDataOfItsInstanceAndTheStartOfItsStart) {
  const std::uint64_t pair = seed_of(2, 1);
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, pair), instance = make(spec, 2), start = make(spec, 1);
    EXPECT_EQ(problem.start(), start.start()) << spec;
    Batch validation, expected;
    problem.draw_validation(validation);
    instance.draw_validation(expected);
    EXPECT_EQ(validation.target, expected.target) << spec;
  }
  for (const auto& [spec, seed] : {std::pair{"sine[mode=learn]", 1U},
                                   {"sine[mode=learn,data=37]", 2U},
                                   {"quantum-dipole[mode=learn,epoch=200,batch=100]", 2U}})
    EXPECT_EQ(batch_of(make(spec, pair), 1).target, batch_of(make(spec, seed), 1).target) << spec;
}

TEST(Learning, MethodsOfOneSeedStartAlikeAndSeedsApart) {
  EXPECT_EQ(make("sine[mode=learn,xi=1]", 3).start(), make("sine[mode=learn,xi=32]", 3).start());
  EXPECT_NE(make("sine[mode=learn]", 3).start(), make("sine[mode=learn]", 4).start());
}

// The truth makes the target, and has no error in x.
TEST(Learning, TruthIsWhatWasObserved) {
  for (const std::string& spec : kLearned) {
    const Problem problem = make(spec, 1);
    const Batch batch = batch_of(problem, 2);
    Point at;
    problem.physics_forward(batch.truth, batch, at);
    EXPECT_LT((at.y - batch.target).norm(), 1e-11 * batch.target.norm()) << spec;  // rounding
    EXPECT_LT(problem.x_error(batch.truth, batch), 1e-11 * batch.truth.cwiseAbs().sum()) << spec;
  }
}

TEST(Learning, ExponentialTargetsAreLogUniform) {
  Batch validation;
  make("exponential[mode=learn]").draw_validation(validation);
  const Eigen::ArrayXXd x = validation.truth;
  EXPECT_GE(x.minCoeff(), -12);
  EXPECT_LE(x.maxCoeff(), 0);
  const Real error = 12 / std::sqrt(12.0 * 1024);  // of the mean of 1,024 samples
  EXPECT_NEAR(x.mean(), -6, 4 * error);
}

TEST(Learning, SineTeachesEveryBranchOfItsInverse) {
  const Problem problem = make("sine[mode=learn,xi=1,phi=0]");
  Batch validation;
  problem.draw_validation(validation);
  const Eigen::ArrayXd phase = 10 * validation.truth.row(0).array();  // γ z₁ with ξ = 1, φ = 0
  EXPECT_LT(phase.minCoeff(), -2 * M_PI);
  EXPECT_GT(phase.maxCoeff(), 2 * M_PI);
  EXPECT_LE(validation.target.cwiseAbs().maxCoeff(), 1);
}

// Poisson's inverse is linear and exact: what SIP aims at is the label of supervised training.
TEST(Learning, PoissonTargetsOfSipAreTheLabels) {
  const Problem problem = make("poisson[mode=learn,N=16,batch=3,network=unet[levels=2]]");
  Point at;
  problem.forward(problem.start(), at);
  Matrix aimed(problem.inputs(), problem.samples());
  EXPECT_TRUE(problem.local_inverse(problem.target(), aimed, at).all());
  const Matrix& label = problem.batch().truth;
  EXPECT_LT((aimed - label).norm(), 1e-11 * label.norm());  // rounding by the condition of ∇²
}

TEST(Learning, HeatGivesTheNetworkTheMean) {
  const Problem problem = make("heat[mode=learn,N=16,batch=3,network=unet[levels=2]]");
  Point at;
  problem.forward(problem.start(), at);
  const Eigen::RowVectorXd means = at.x().colwise().mean() - problem.batch().truth.colwise().mean();
  EXPECT_LT(means.cwiseAbs().maxCoeff(), 1e-6);  // the network is of single precision
}

// ½⟨sin² 6t⟩ + ½⟨cos² 9t⟩ over t ∈ [−1, 1] is ½ + sin(18)/72 − sin(12)/48, and the second half
// alone, what a network leaves that fits y₁ only, is ¼ + sin(18)/72 = 0.2396.
TEST(Learning, ToyHasThePublishedFloors) {
  const Problem problem = make("hig-toy[lambda=0.01,data=100000]");
  const Matrix y = problem.target();
  EXPECT_NEAR(0.5 * y.row(1).squaredNorm() / 1e5, 0.25 + std::sin(18.0) / 72, 2e-3);  // 1/√1e5
  EXPECT_NEAR(0.5 * y.squaredNorm() / 1e5, 0.5005, 3e-3);
}

TEST(Learning, ToyWatchesItsNeuronsAndItsPath) {
  const Problem problem = make("hig-toy[lambda=0.01]");
  EXPECT_EQ(problem.unknowns(), 30);
  Point at;
  problem.forward(problem.start(), at);
  Vector values(static_cast<Index>(problem.series().names.size()));
  problem.series().evaluate(problem, problem.start(), at, values);
  EXPECT_LT(std::abs(values[0]), 1);  // of tanh
  EXPECT_GT(values[1], 0);
  Index nearest = 0;
  (problem.batch().input.row(0).array() - M_PI / 9).abs().minCoeff(&nearest);
  EXPECT_EQ(values.segment(2, 2), at.y.col(nearest));
}

}  // namespace
}  // namespace isoline::problems
