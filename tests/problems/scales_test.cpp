// By what a loss and an error in x are called small: the problem's own measure, whatever the start
// that was drawn.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/status.h"
#include "problems/dense_physics.h"
#include "tests/problems/make.h"

namespace isoline::problems {
namespace {

class Doubled final : public DensePhysics {
 public:
  Doubled() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y = 2 * x; }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 2; }
};

Real loss_scale(const Problem& problem) { return problem.loss_scale(problem.batch()); }
Real x_scale(const Problem& problem) { return problem.x_scale(problem.batch()); }

TEST(Scales, OfALossWithoutSignalIsThatOfTheStandardStart) {
  for (const char* name : {"rosenbrock", "beale", "wood", "square", "scaling"}) {
    const Real published = loss_scale(make(name));
    EXPECT_EQ(published, loss_at_start(make(name))) << name;
    for (const std::uint64_t seed : {1U, 2U, 3U})
      EXPECT_EQ(loss_scale(make(name, seed)), published) << name << ", seed " << seed;
  }
}

TEST(Scales, OfALossWithASignalIsThatOfNoOutput) {
  const Problem sine = make("sine");
  EXPECT_DOUBLE_EQ(loss_scale(sine), 0.5 * sine.target().squaredNorm());
  const Problem exponential = make("exponential");  // y* = e⁻⁶: its start is at y = 1
  EXPECT_DOUBLE_EQ(loss_scale(exponential), 0.5 * std::exp(-12));
  EXPECT_GT(loss_at_start(exponential), 1e4 * loss_scale(exponential));
}

TEST(Scales, OfALossThatDoesNotVanishIsItsLeast) {
  const Problem problem = make("brown-dennis", 3);
  EXPECT_EQ(loss_scale(problem), *problem.minimum());
}

TEST(Scales, OfALossIsWhatTheProblemDeclares) {
  const Problem problem({.physics = std::make_unique<Doubled>(),
                         .start = Vector::Ones(1),
                         .target = Matrix::Ones(1, 1),
                         .minimum = 0,
                         .scale = 7,
                         .x_error = [](BatchRef x, const Batch&) { return x.norm(); },
                         .x_scale = 5});
  EXPECT_EQ(loss_scale(problem), 7);
  EXPECT_EQ(x_scale(problem), 5);
  EXPECT_EQ(problem.x_floor(problem.batch()), 0);
}

// Seed 1002001 is instance 2 with start 1; its scales are those of the instance.
TEST(Seeds, APairHasTheTargetOfItsInstanceAndTheOffsetOfItsStart) {
  for (const auto& [name, entry] : all_problems().ready()) {
    if (!entry.in_all) continue;
    const Problem pair = make(name, 1'002'001), instance = make(name, 2), start = make(name, 1);
    if (pair.is_learned()) continue;
    EXPECT_EQ(pair.target(), instance.target()) << name;
    EXPECT_EQ(pair.truth(), instance.truth()) << name;
    EXPECT_EQ(pair.standard_start(), instance.standard_start()) << name;
    EXPECT_EQ(pair.loss_scale(pair.batch()), instance.loss_scale(instance.batch())) << name;
    EXPECT_NE(pair.start(), instance.start()) << name;
    if (instance.standard_start() == start.standard_start()) {
      EXPECT_EQ(pair.start(), start.start()) << name;
    }
    EXPECT_EQ(make(name, seed_of(0, 1)).target(), make(name, 0).target()) << name;
    EXPECT_EQ(make(name, seed_of(1, 0)).start(), make(name, seed_of(1, 0)).standard_start())
        << name;
  }
  EXPECT_EQ(Draw(7, "p").stream("target").uniform(), RandomStream(7, "p", "target").uniform());
}

TEST(Scales, OfXAreTheSolutionsNormOrThatOfTheStandardStart) {
  EXPECT_DOUBLE_EQ(x_scale(make("exponential")), 6);  // |log e⁻⁶|
  EXPECT_DOUBLE_EQ(x_scale(make("rosenbrock", 3)), std::sqrt(2));
  EXPECT_DOUBLE_EQ(x_scale(make("square", 3)), std::hypot(3, 3));  // x* = 0; the standard start
  const Problem poisson = make("poisson[N=8]", 2);
  EXPECT_DOUBLE_EQ(x_scale(poisson), poisson.truth()->norm());
}

TEST(Scales, OfALearningProblemAreMeansOverItsValidation) {
  const Problem problem = make("exponential[mode=learn]");
  Batch validation;
  problem.draw_validation(validation);
  EXPECT_DOUBLE_EQ(problem.x_scale(validation), validation.truth.cwiseAbs().mean());
  EXPECT_FALSE(problem.minimum().has_value());  // no network attains 0
}

// The floor from its definition: the singular value decomposition of J(x*), cut where values
// differ.
Real floor_by_svd(const Problem& problem) {
  Point at;
  problem.forward(problem.truth()->col(0), at);
  Matrix J;
  problem.jacobian(J, at);
  const Eigen::JacobiSVD<Matrix> svd(J, Eigen::ComputeThinV);
  const Vector missing = svd.matrixV().transpose() * (problem.start() - problem.truth()->col(0));
  const Vector& sigma = svd.singularValues();
  const Real unit = std::numeric_limits<Real>::epsilon() / 2;
  const Real noise = std::pow(unit * problem.target().norm(), 2) / Real(sigma.size());
  Real least = missing.norm(), kept = 0;
  for (Index i = 0; i < sigma.size(); ++i) {
    kept += noise / (sigma(i) * sigma(i));
    if (i + 1 < sigma.size() && sigma(i) < 1.5 * sigma(i + 1)) continue;
    least = std::min(least, std::sqrt(kept + missing.tail(sigma.size() - 1 - i).squaredNorm()));
  }
  return least;
}

// Singular values of some modes are a few times the rounding of the largest: their directions are
// right to a part of 10⁻⁴ or so.
TEST(Scales, HeatHasTheFloorOfTheBestSpectralCutOff) {
  for (const std::uint64_t seed : {0, 1, 2}) {
    const Problem problem = make("heat[N=8]", seed);
    const Real floor = problem.x_floor(problem.batch()), other = floor_by_svd(problem);
    EXPECT_NEAR(floor, other, 1e-3 * other) << seed;
    EXPECT_LT(floor, (problem.start() - problem.truth()->col(0)).norm());
    Point at;
    problem.forward(Vector::Zero(problem.unknowns()), at);
    Matrix x = Matrix::Zero(problem.inputs(), 1);
    problem.local_inverse(problem.target(), x, at);
    if (seed == 0) {
      EXPECT_LT(floor, (x - *problem.truth()).norm()) << "the damped inverse cannot move it";
    }
  }
  const Problem poisson = make("poisson[N=8]");
  EXPECT_EQ(poisson.x_floor(poisson.batch()), 0);
}

TEST(Scales, WhoSeeksXSaysSoAndKnowsIt) {
  for (const auto& [name, entry] : all_problems().ready()) {
    const Problem problem = make(name);
    EXPECT_EQ(problem.aim(), entry.aim) << name;
    if (entry.aim == Aim::x && !problem.is_learned()) {
      EXPECT_GT(x_scale(problem), 0) << name;
    }
  }
  EXPECT_EQ(all_problems().at("heat").aim, Aim::x);
  EXPECT_EQ(all_problems().at("rosenbrock").aim, Aim::loss);
}

}  // namespace
}  // namespace isoline::problems
