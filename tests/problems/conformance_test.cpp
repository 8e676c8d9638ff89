// Properties of every registered problem, at its default options and some others. Grids are reduced
// to N = 8: the properties do not depend on the size.
#include "problems/conformance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "core/workspace.h"
#include "make.h"
#include "problems/dense_physics.h"
#include "problems/features.h"
#include "tests/clients/programs.h"
#include "tests/refusal.h"

namespace isoline::problems {
namespace {

std::vector<std::string> specs() {
  const std::string smooth = "network=mlp[layers=5-4,activation=tanh,precision=double]";
  std::vector<std::string> all = {
      "sine[form=paper]", "sine[xi=32]", "sine[xi=1,phi=15]", "scaling[alpha=1e-3]",
      "scaling[alpha=1e3]", "exponential[n=7]", "poisson[N=9]", "heat[N=9]",
      "navier-stokes[N=8,loss=amplitude]", "navier-stokes[N=8,ground-truth=collocated]",
      "navier-stokes[N=8,viscosity=3]", "navier-stokes[N=8,steps=5,rescale=none]",
      "sine[mode=learn,batch=4]", "sine[mode=learn,batch=6," + smooth + "]",
      "exponential[mode=learn,batch=6," + smooth + "]", "hig-toy[batch=6," + smooth + "]",
      "burgers[mode=learn,N=8,batch=3," + smooth + "]",
      // nine samples: one group of lanes and a rest
      "linear-chain[mode=learn,batch=9,epoch=0]", "coupled-oscillators[mode=learn,batch=2]",
      "coupled-oscillators[mode=learn,batch=9,epoch=0," + smooth + "]",
      "quantum-dipole[mode=learn,batch=9,epoch=0]",
      "quantum-dipole[mode=learn,batch=9,epoch=0,loss=residual]", "box3d[m=3]", "brown-dennis[m=4]",
      "linear-chain[steps=96]", "coupled-oscillators[steps=48]", "wave-packet[samples=256]",
      "wave-packet[sigma=0]", "quantum-dipole[steps=96]", "quantum-dipole[steps=192,loss=residual]",
      "broyden-tridiagonal[n=3]", "variably-dimensioned[n=1]",
      "pinn-poisson[dimension=5,layers=7-6,interior=9,boundary=5]",
      "pinn-poisson[dimension=10,layers=4-3-5,interior=6,boundary=4,points=fixed]",
      "pinn-burgers[layers=5-4,points=9]", "pinn-forward[layers=5-4,interior=9,boundary=4]",
      "pinn-forward[equation=convection,layers=5,interior=9,boundary=4]",
      "regression[function=polynomial,batch=6]", "rippled-square[ripple=0.01]", "parabola[batch=6]",
      "wave-packet[count=optimum]", "hig-toy[batch=6,samples=pairs," + smooth + "]"};
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

// P(x + d) − P(x) = ∫ J(x + td) d dt over 0 < t < 1, the fundamental theorem of calculus, by
// Simpson's rule over a short path. The flow is left out: its paths cross points without a
// derivative.
TEST_P(EveryProblem, ChangesByItsAverageDerivativeAlongAPath) {
  const Problem problem = make(GetParam());
  if (!problem.has_identity_network() || GetParam().starts_with("navier-stokes")) return;
  RandomStream stream(0, GetParam(), "path");
  const Vector x = problem.start();
  const Real least = problem.start_scale() == StartScale::own ? 0 : 1;
  const Vector d =
      1e-3 * x.cwiseAbs().cwiseMax(least).cwiseProduct(stream.uniform_vector(x.size(), -1, 1));
  Point at;
  problem.forward(x + d, at);
  Matrix secant = at.y, mean = Matrix::Zero(at.y.rows(), at.y.cols()), slope = mean;
  for (const auto& [t, weight] : {std::pair{0.5, 4.0 / 6}, {1.0, 1.0 / 6}, {0.0, 1.0 / 6}}) {
    problem.forward(x + t * d, at);
    problem.pushforward(d, slope, at);
    mean += weight * slope;
  }
  secant -= at.y;
  EXPECT_LE((mean - secant).norm(), 1e-7 * secant.norm() + 1e-13 * at.y.norm());
}

// P(a) + P(b) = P(a + b) + P(0) of the linear ones. Rounding of a sum over thousands of cells stays
// below 1e-9, and no nonlinear problem comes near it at distances of the size of its unknowns.
TEST(Problems, DeclareWhetherTheyAreLinear) {
  for (const auto& [name, entry] : all_problems().ready()) {
    if (name == "conduct") continue;  // by its option input
    const Problem problem = make(name.find("heat") == 0 ? name + "[N=16]" : name);
    if (!problem.has_identity_network() || problem.is_learned() || !problem.is_least_squares())
      continue;
    RandomStream stream(0, name, "linearity");
    const Vector sizes = problem.start().cwiseAbs().cwiseMax(1);
    const auto at_random = [&](Real share) -> Vector {
      return problem.start() +
             share * sizes.cwiseProduct(stream.uniform_vector(sizes.size(), 0.1, 1));
    };
    const Vector a = at_random(0.1), b = at_random(0.2), start = problem.start();
    const auto value = [&](const Vector& x) {
      Point at;
      problem.forward(x, at);
      return Matrix(at.y);
    };
    const Matrix gap = value(a) + value(b) - value(a + b - start) - value(start);
    const Real size = (value(a) - value(start)).norm() + (value(b) - value(start)).norm();
    EXPECT_EQ(gap.norm() <= 1e-9 * size + 1e-13 * value(start).norm(), entry.is_linear) << name;
  }
}

TEST(Problems, OfOneOperatorAreOneFamily) {
  const auto family = [](const char* name) { return family_of(all_problems().at(name)); };
  EXPECT_EQ(family("poisson"), family("poisson-hig"));
  EXPECT_EQ(family("diffusivity"), family("poisson-field"));
  EXPECT_EQ(family("heat"), family("deconvolution-1d"));
  EXPECT_EQ(family("linear-chain"), family("coupled-oscillators"));
  EXPECT_EQ(family("wave-packet"), "wave-packet");
}

// P⁻¹(y + Δy; x) − x tends to J⁻¹Δy, and differs from it by O(Δy²): the limit of small steps, in
// which the inverse is local.
TEST(LocalInverse, TendsToTheInverseJacobian) {
  for (const char* spec : {"square", "sine[xi=1]", "sine[xi=32]", "exponential"}) {
    const Problem problem = make(spec);
    Point at;
    problem.forward(problem.start(), at);
    Matrix J(at.y.size(), at.x().size());
    for (Index j = 0; j < J.cols(); ++j)
      problem.pushforward(Vector::Unit(J.cols(), j), J.col(j), at);
    const Vector away = problem.target() - at.y;
    const auto rest = [&](Real share) {
      Matrix found = at.x();
      EXPECT_TRUE(problem.local_inverse(at.y + share * away, found, at).all());
      Vector linear;
      EXPECT_TRUE(solve_square(J, share * away, linear));
      return (found - at.x() - linear).norm();
    };
    EXPECT_NEAR(rest(1e-4) / rest(5e-5), 4, 0.05) << spec;
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
  if (GetParam() == "conduct") GTEST_SKIP() << "its inputs are fixed";
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
  int failures = 0;
  for (const Finding& finding : examine(problem, stream)) {
    EXPECT_TRUE(finding.holds() || finding.property.starts_with("the damped inverse"));
    failures += !finding.holds();
  }
  EXPECT_EQ(failures, 2);
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

// The loss at the start is 0 then, and nothing can be relative to it.
// Their remainder falls with the first power of the step, as that of a wrong J does.
TEST(Conformance, AllowsDifferencesOfALinearProblem) {
  for (const std::string kind : {"forward", "central"})
    EXPECT_TRUE(holds(
        with_features(make("linear-chain"), {{"derivatives", kind}}, Draw(0, "linear-chain"))))
        << kind;
}

TEST(Conformance, AStartThatIsTheTruthIsAllowedAndNaNIsNamed) {
  const auto of = [](const Vector& start, const Vector& target) {
    return Problem({.physics = std::make_unique<TwoScales>(),
                    .start = start,
                    .target = target,
                    .minimum = 0,
                    .truth = Eigen::Vector2d(1, 2)});
  };
  EXPECT_TRUE(holds(of(Eigen::Vector2d(1, 2), Eigen::Vector2d(1e4, 2))));
  for (const Problem& broken : {of(Eigen::Vector2d(NAN, 2), Eigen::Vector2d(1e4, 2)),
                                of(Eigen::Vector2d(1, 2), Eigen::Vector2d(NAN, 2))}) {
    RandomStream stream(0, "broken", "conformance");
    const std::vector<Finding> findings = examine(broken, stream);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_NE(findings[0].property.find("finite"), std::string::npos);
  }
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

// Differences across kinks: a step across a declared kink is drawn again.

// y = (|x1| + x1², x2), with its kink as near to the start as short steps go, and told or not.
class Folded final : public Physics {
 public:
  explicit Folded(bool tells) : tells_(tells) {}
  Index inputs() const override { return 2; }
  Index outputs() const override { return 2; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    y = x;
    y.row(0) = x.row(0).array().abs() + x.row(0).array().square();
    if (tells_) w.as<Sides>().is_right = x.array().reshaped() > 0;
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = v;
    Jv.row(0) = (w.x.row(0).array().sign() + 2 * w.x.row(0).array()) * v.row(0).array();
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override { pushforward(u, JTu, w); }

 private:
  struct Sides final : Scratch, Pieces {
    Success is_right;
    void add_choices(PieceDigest& digest) override {
      for (const bool choice : is_right) digest.add(choice);
    }
  };
  bool tells_;
};

bool examines_well(bool tells_its_kink) {
  // Most of the halved steps are longer than the way to the kink. Beside 1e9, a start of 6e-6 is
  // taken for an unknown of size 1.
  bool all = true;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Problem problem({.physics = std::make_unique<Folded>(tells_its_kink),
                           .start = Eigen::Vector2d(6e-6, 1e9),
                           .start_scale = StartScale::own,
                           .target = Vector::Ones(2)});
    RandomStream stream(seed, "folded", "conformance");
    for (const Finding& finding : examine(problem, stream)) all = all && finding.holds();
  }
  return all;
}

TEST(Kinks, AreNotCrossedByWaysAlongWhichDifferencesAreTaken) {
  EXPECT_TRUE(examines_well(true));
  EXPECT_FALSE(examines_well(false)) << "else the redrawing proves nothing";
}

// Every choice counts, whichever it is.
TEST(Kinks, ArePassedWhereAChoiceDiffers) {
  Folded folded(true);
  const auto piece = [&](Real first, Real second) {
    Workspace w;
    Matrix y(2, 1);
    folded.forward(Eigen::Vector2d(first, second), Matrix(), y, w);
    PieceDigest digest;
    dynamic_cast<Pieces&>(*w.own).add_choices(digest);
    return digest.value();
  };
  EXPECT_EQ(piece(1, 1), piece(2, 0.1));
  EXPECT_NE(piece(1, 1), piece(-1, 1));
  EXPECT_NE(piece(-1, 1), piece(1, -1));
}

// A problem that another program computes equals the same problem in this program.

const std::string kValley = process_of(example("rosenbrock.py"));

TEST(Process, ComputesTheSameBitsAsTheTree) {
  const Problem theirs = make(valley_of_this_build()), ours = make("rosenbrock");
  EXPECT_EQ(theirs.start(), ours.start());
  EXPECT_EQ(theirs.target(), ours.target());
  EXPECT_EQ(theirs.minimum(), ours.minimum());
  EXPECT_EQ(*theirs.truth(), *ours.truth());
  EXPECT_TRUE(theirs.is_elsewhere());
  RandomStream stream(0, "process", "test");
  for (int i = 0; i < 20; ++i) {
    const Vector theta = stream.normal_vector(2);
    Point a, b;
    theirs.forward(theta, a);
    ours.forward(theta, b);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(jacobian_at(theirs, theta), jacobian_at(ours, theta));
    Matrix x(2, 1), expected(2, 1);
    EXPECT_TRUE(theirs.local_inverse(b.y, x, a).all());
    ours.local_inverse(b.y, expected, b);
    EXPECT_EQ(x, expected);
  }
}

// The harness looks elsewhere while a method keeps its point.
TEST(Process, ProductsBelongToThePointTheyAreAskedAt) {
  const Problem problem = make(kValley);
  Point first, second, third;
  problem.forward(Eigen::Vector2d(2, 0), first);
  problem.forward(Eigen::Vector2d(3, 0), second);
  Vector pulled(2);
  problem.pullback(Eigen::Vector2d(1, 0), pulled, first);
  EXPECT_EQ(pulled, Eigen::Vector2d(-40, 10));
  problem.forward(Eigen::Vector2d(4, 0), third);
  problem.pullback(Eigen::Vector2d(1, 0), pulled, second);
  EXPECT_EQ(pulled, Eigen::Vector2d(-60, 10));
}

void expect_certified(const std::string& spec, std::uint64_t seed) {
  const Problem problem = make(spec, seed);
  RandomStream stream(seed, "process", "check");
  std::size_t count = 0;
  for (const Finding& finding : examine(problem, stream)) {
    EXPECT_TRUE(finding.holds()) << spec << ": " << finding.property << " " << finding.figure;
    ++count;
  }
  EXPECT_GE(count, 4U);
}

TEST(Process, PassesTheCertificateOfEveryProblem) {
  for (const std::uint64_t seed : {0, 1, 2}) expect_certified(kValley, seed);
}

// y = (x1², x2²) with two solutions, ±(1, 1), and y* off by 0.01.
TEST(Process, MeasuresErrorsInXAndScalesStartsAsItSays) {
  const std::string squares = process_of(misbehaving("squares.py"));
  const Problem problem = make(squares);
  EXPECT_EQ(problem.aim(), Aim::x);
  EXPECT_DOUBLE_EQ(problem.x_error(Eigen::Vector2d(-1, -1)), 0);
  EXPECT_DOUBLE_EQ(problem.x_error(Eigen::Vector2d(-1, -2)), 1);
  EXPECT_EQ(problem.x_floor(problem.batch()), 0.005);
  EXPECT_LT((make(squares, 3).start() - Eigen::Vector2d(1e-3, 1000)).cwiseAbs()[0], 1e-3);
  expect_certified(squares, 1);
}

// 500 beside 1e-4, whether the program declares it ("own") or not.
TEST(Process, OfUnknownsOfUnlikeSizesIsCertifiedByStepsOfTheirSizes) {
  const auto misra = [](const std::string& words) {
    return process_of(misbehaving("misra.py " + words));
  };
  for (const char* words : {"exact", "exact own", "differences", "differences own"}) {
    expect_certified(misra(words), 0);
    EXPECT_EQ(make(misra(words)).start_scale() == StartScale::own,
              std::string(words).ends_with("own"));
  }
  for (const char* words : {"exact box", "differences box", "differences rounded"})
    expect_certified(misra(words), 0);
  expect_certified(misra("exact own"), 1);
  for (const char* words : {"wrong", "wrong own"}) EXPECT_FALSE(holds(make(misra(words)))) << words;
  const Problem exact = make(misra("exact"));
  const Matrix J = jacobian_at(exact, exact.start());
  const Matrix D = jacobian_at(make(misra("differences")), exact.start());
  for (Index j = 0; j < 2; ++j) EXPECT_LT((D - J).col(j).norm(), 1e-6 * J.col(j).norm()) << j;
}

TEST(Process, SeedsDrawTheStartAsEverywhere) {
  EXPECT_EQ(make(kValley, 3).start(), make(kValley, 3).start());
  EXPECT_NE(make(kValley, 3).start(), make(kValley, 4).start());
  EXPECT_EQ(make(kValley, 3).standard_start(), make(kValley).start());
}

TEST(Process, OffersAndPricesWhatItHas) {
  const std::string offers = misbehaving("offers.py ");
  const Problem alone = make(process_of(offers + "forward"));
  EXPECT_FALSE(alone.offers().contains(Oracle::pullback));
  EXPECT_FALSE(alone.offers().contains(Oracle::jacobian));
  const Problem pulls = make(process_of(offers + "vjp"));
  EXPECT_TRUE(pulls.offers().contains(Oracle::pullback));
  EXPECT_FALSE(pulls.offers().contains(Oracle::pushforward));
  const auto price = [](const Problem& problem, Oracle oracle) {
    return problem.prices()[static_cast<std::size_t>(oracle)];
  };
  EXPECT_EQ(price(pulls, Oracle::jacobian), 3) << "by rows, of which there are three";
  const Problem differences = make(process_of(offers + "differences"));
  EXPECT_EQ(price(differences, Oracle::pushforward), 2);
  EXPECT_EQ(price(differences, Oracle::pullback), 4) << "two forwards an unknown";
  for (const char* kind : {"forward", "vjp", "jvp", "jacobian", "differences"})
    expect_certified(process_of(offers + kind), 1);
}

TEST(Process, AJacobianThatIsGivenIsThatOfTheProducts) {
  const std::string offers = misbehaving("offers.py ");
  const Eigen::Vector2d theta(0.3, -2);
  const Matrix given = jacobian_at(make(process_of(offers + "jacobian")), theta);
  for (const char* kind : {"vjp", "jvp"})
    EXPECT_EQ(jacobian_at(make(process_of(offers + kind)), theta), given) << kind;
}

// The program raises an error where it is asked below 0, and would so end the test.
TEST(Process, OutsideItsBoundsThereIsNoValueAndItIsNotAsked) {
  const std::string roots = process_of(misbehaving("bounded.py"));
  const Problem problem = make(roots);
  Point at;
  for (const Eigen::Vector2d& outside :
       {Eigen::Vector2d(-1, 4), Eigen::Vector2d(10, 4), Eigen::Vector2d(NAN, 4)}) {
    problem.forward(outside, at);
    EXPECT_TRUE(at.y.array().isNaN().all()) << outside.transpose();
  }
  problem.forward(Eigen::Vector2d(9, 16), at);
  EXPECT_EQ(at.y, Eigen::Vector2d(3, 4));
  bool is_at_the_bound = false;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    const Vector start = make(roots, seed).start();
    EXPECT_GE(start[0], 0.25);
    is_at_the_bound |= start[0] == 0.25;
  }
  EXPECT_TRUE(is_at_the_bound) << "half of the seeds are drawn below it";
  for (const std::uint64_t seed : {0, 1, 2, 3}) expect_certified(roots, seed);
}

TEST(Process, OfNumPyAndOfPyTorchPassTheCertificate) {
  for (const auto& [library, script] :
       {std::pair{"numpy", "spring.py"}, {"torch", "spring_torch.py"}}) {
    const std::string python = python_with(library);
    if (python.empty()) GTEST_SKIP() << library << " is not installed";
    expect_certified(process_of(example(script, python)), 1);
  }
}

// --- what is wrong before anything is computed

void expect_complaint(const std::string& spec, const std::string& part) {
  const std::string said = refusal([&] { make(spec); });
  EXPECT_NE(said.find(part), std::string::npos) << spec << said;
}

TEST(Process, SaysWhatIsMissing) {
  expect_complaint("process", "such as process[command=");
  expect_complaint(process_of("python3 'mine.py"), "inside a quote");
  expect_complaint(process_of("a-missing-program"), "'a-missing-program': No such file");
  expect_complaint(process_of("true"), "it exited with code 0");
}

TEST(Process, ThatDiesAtImportIsQuotedByItsLastLines) {
  const std::string dead = process_of(misbehaving("misbehaving.py dies-at-import"));
  expect_complaint(dead, "it exited with code 1");
  expect_complaint(dead, "ModuleNotFoundError: No module named 'a_package_that_nobody_has'");
}

TEST(Process, ThatIsLateIsToldFromOneThatIsSilent) {
  expect_complaint(process_of(misbehaving("misbehaving.py is-late"), ",startup=0.2"),
                   "within 0.2 s; it is still");
  expect_complaint(process_of(misbehaving("misbehaving.py is-silent")),
                   "code 0, and printed nothing");
}

TEST(Process, NamesTheFunctionWhoseResultIsNoNumber) {
  expect_complaint(process_of(misbehaving("misbehaving.py returns-nothing")), "forward(x) is None");
  expect_complaint(process_of(misbehaving("misbehaving.py returns-text")), "only real numbers");
  expect_complaint(process_of(misbehaving("misbehaving.py has-no-finite-minimum")),
                   "minimum must be");
}

TEST(Process, ThatIsAnOptimizerSaysSo) {
  expect_complaint(process_of(example("descent.py")), " is an optimizer");
}

}  // namespace
}  // namespace isoline::problems
