// What every registered problem must satisfy, at its default options and some others. Grids are
// reduced to N = 8: the properties do not depend on the size.
#include "problems/conformance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "make.h"
#include "problems/dense_physics.h"

namespace isoline::problems {
namespace {

std::vector<std::string> specs() {
  std::vector<std::string> all = {"sine[form=paper]",
                                  "sine[xi=32]",
                                  "sine[xi=1,phi=15]",
                                  "scaling[alpha=1e-3]",
                                  "scaling[alpha=1e3]",
                                  "exponential[n=7]",
                                  "poisson[N=9]",
                                  "heat[N=9]",
                                  "navier-stokes[N=8,loss=amplitude]",
                                  "navier-stokes[N=8,ground-truth=collocated]",
                                  "sine[mode=learn,batch=4]",
                                  "coupled-oscillators[mode=learn,batch=2]",
                                  "box3d[m=3]",
                                  "brown-dennis[m=4]",
                                  "broyden-tridiagonal[n=3]",
                                  "variably-dimensioned[n=1]"};
  for (const auto& [name, entry] : all_problems().ready()) {
    const bool is_grid = std::ranges::any_of(
        entry.options, [](const OptionField& field) { return field.name == "N"; });
    all.push_back(is_grid ? name + "[N=8]" : name);
  }
  return all;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace_if(
      name, [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

class EveryProblem : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryProblem, SatisfiesWhatProblemsMust) {
  for (const std::uint64_t seed : {0, 1, 2}) {
    const Problem problem = make(GetParam(), seed);
    RandomStream stream(seed, GetParam(), "conformance");
    for (const Finding& finding : examine(problem, stream))
      EXPECT_LE(finding.figure, finding.limit)
          << finding.property << " (" << finding.reason << "), seed " << seed;
  }
}

TEST_P(EveryProblem, IsDrawnFromItsSeedAlone) {
  for (const std::uint64_t seed : {0, 1}) {
    const Problem first = make(GetParam(), seed), second = make(GetParam(), seed);
    EXPECT_EQ(first.start(), second.start());
    EXPECT_EQ(first.target(), second.target());
  }
}

TEST_P(EveryProblem, DiffersBetweenSeeds) {
  for (const std::uint64_t seed : {0, 1}) {
    const Problem first = make(GetParam(), seed), second = make(GetParam(), seed + 1);
    EXPECT_TRUE(first.start() != second.start() || first.target() != second.target());
  }
}

TEST_P(EveryProblem, DoesNotStartAtASolution) {
  const Problem problem = make(GetParam());
  if (!problem.minimum()) return;
  EXPECT_GT(loss_at_start(problem), *problem.minimum());
}

TEST_P(EveryProblem, HasAWindowOnlyWithTwoUnknowns) {
  const Problem problem = make(GetParam());
  if (!problem.window()) return;
  const auto [low1, high1, low2, high2] = *problem.window();
  EXPECT_EQ(problem.inputs(), 2);
  EXPECT_LT(low1, high1);
  EXPECT_LT(low2, high2);
  EXPECT_TRUE(low1 <= problem.start()[0] && problem.start()[0] <= high1);
  EXPECT_TRUE(low2 <= problem.start()[1] && problem.start()[1] <= high2);
}

TEST_P(EveryProblem, SaysWhatItIs) {
  const ProblemEntry& entry = all_problems().at(parse_spec(GetParam()).name);
  for (const std::string& text : {entry.title, entry.formula, entry.source})
    EXPECT_FALSE(text.empty());
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryProblem, ::testing::ValuesIn(specs()), test_name);

// A wrong derivative must be found, or the examination proves nothing.
class WrongSign final : public Physics {
 public:
  Index inputs() const override { return 2; }
  Index outputs() const override { return 2; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    y = x.array().square();
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = -2 * w.x.cwiseProduct(v);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    JTu = 2 * w.x.cwiseProduct(u);
  }
};

// Goes twice as far as it should.
class Overshooting final : public Physics {
 public:
  Index inputs() const override { return 2; }
  Index outputs() const override { return 2; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override { y = x; }
  void pushforward(BatchRef v, BatchOut Jv, Workspace&) const override { Jv = v; }
  void pullback(BatchRef u, BatchOut JTu, Workspace&) const override { JTu = u; }
  Inverse inverse_kind() const override { return Inverse::damped; }
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const override {
    x = x0 + 2.1 * (y - x0);
    return Success::Constant(y.cols(), true);
  }
};

TEST(Conformance, FindsADampedInverseThatGoesTooFar) {
  const Problem problem({.physics = std::make_unique<Overshooting>(),
                         .start = Vector::Ones(2),
                         .target = Vector::Zero(2)});
  RandomStream stream(0, "overshooting", "conformance");
  std::vector<std::string> failed;
  for (const Finding& finding : examine(problem, stream))
    if (!finding.holds()) failed.push_back(finding.property);
  const std::vector<std::string> expected = {"the damped inverse brings y no farther from y*",
                                             "the damped inverse undoes P on what P has smoothed"};
  EXPECT_EQ(failed, expected);
}

TEST(Conformance, AsksADampedInverseOfHeat) {
  const Problem problem = make("heat");
  RandomStream stream(0, "heat", "conformance");
  int asked = 0;
  for (const Finding& finding : examine(problem, stream))
    asked += finding.property.find("damped inverse") != std::string::npos;
  EXPECT_EQ(asked, 3);
}

TEST(Conformance, FindsAWrongPushforward) {
  const Problem problem({.physics = std::make_unique<WrongSign>(),
                         .start = Vector::Ones(2),
                         .target = Vector::Zero(2)});
  RandomStream stream(0, "wrong", "conformance");
  int failures = 0;
  for (const Finding& finding : examine(problem, stream)) failures += !finding.holds();
  EXPECT_GE(failures, 2);  // the adjoint identity and Taylor's slope
}

// P(x) = (1e4 x1, x2) from (1e-4, 1), with a minimum as a paper prints it.
class TwoScales final : public DensePhysics {
 public:
  TwoScales() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y << 1e4 * x[0], x[1]; }
  void derivative(VectorRef, BatchOut J) const override { J.diagonal() << 1e4, 1; }
};

Problem two_scales(Real minimum, Real error) {
  return Problem({.physics = std::make_unique<TwoScales>(),
                  .start = Eigen::Vector2d(1e-4, 1),
                  .start_scale = StartScale::own,
                  .target = Eigen::Vector2d(1, 2),
                  .minimum = minimum,
                  .minimum_error = error,
                  .truth = Eigen::Vector2d(1e-4, 2)});
}

bool holds(const Problem& problem) {
  RandomStream stream(0, "two-scales", "conformance");
  bool all = true;
  for (const Finding& finding : examine(problem, stream)) all = all && finding.holds();
  return all;
}

TEST(Conformance, TakesAPublishedMinimumWithTheErrorDeclaredOfIt) {
  EXPECT_TRUE(holds(two_scales(0, 0)));
  EXPECT_TRUE(holds(two_scales(4e-12, 5e-12)));   // of eleven digits, rounded up
  EXPECT_FALSE(holds(two_scales(4e-12, 0)));      // below what is declared
  EXPECT_FALSE(holds(two_scales(6e-12, 5e-12)));  // further off than declared
}

// 0.1 N(0, 1) beside an unknown of 1e-4 would be a thousand times the unknown.
TEST(Draw, StartsKeepTheScaleOfEachUnknownWhereItIsTheProblemsOwn) {
  const Eigen::Vector2d standard(1e-4, 1000);
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Draw draw(seed, "two-scales");
    const Vector start = draw.start(standard, StartScale::own).drawn;
    EXPECT_LT((start.cwiseQuotient(standard) - Vector::Ones(2)).cwiseAbs().maxCoeff(), 0.5) << seed;
    EXPECT_NE(start[0], standard[0]);
    const Vector wide = draw.start(standard).drawn;
    EXPECT_EQ(wide[1], start[1]) << "the same numbers, the same scale of 1000";
    EXPECT_GT(std::abs(wide[0] - standard[0]), 1e-4) << seed;
  }
  EXPECT_EQ(Draw(0, "two-scales").start(standard, StartScale::own).drawn, standard);
}

}  // namespace
}  // namespace isoline::problems
