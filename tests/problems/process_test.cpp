// A problem that another program computes is the problem that it would be in the tree.
#include <gtest/gtest.h>

#include "make.h"
#include "problems/conformance.h"
#include "tests/clients/programs.h"

namespace isoline::problems {
namespace {

const std::string kValley = process_of(example("rosenbrock.py"));

Matrix jacobian_at(const Problem& problem, VectorRef theta) {
  Point at;
  Matrix J;
  problem.forward(theta, at);
  problem.jacobian(J, at);
  return J;
}

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
  try {
    make(spec);
    ADD_FAILURE() << spec;
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << spec << error.what();
  }
}

TEST(Process, SaysWhatIsMissing) {
  expect_complaint("process", "process needs a command, such as process[command=");
  expect_complaint(process_of("python3 'mine.py"), "must not end inside a quote");
  expect_complaint(process_of("a-program-that-nobody-has"),
                   "cannot start 'a-program-that-nobody-has': No such file or directory");
  expect_complaint(process_of("true"), "closed its socket; it exited with code 0");
}

TEST(Process, ThatDiesAtImportIsQuotedByItsLastLines) {
  const std::string dead = process_of(misbehaving("misbehaving.py dies-at-import"));
  expect_complaint(dead, "it exited with code 1, and last printed:");
  expect_complaint(dead, "ModuleNotFoundError: No module named 'a_package_that_nobody_has'");
}

TEST(Process, ThatIsLateIsToldFromOneThatIsSilent) {
  expect_complaint(process_of(misbehaving("misbehaving.py is-late"), ",startup=0.2"),
                   "did not answer within 0.2 s; it is still running");
  expect_complaint(process_of(misbehaving("misbehaving.py is-silent")),
                   "closed its socket; it exited with code 0, and printed nothing");
}

TEST(Process, ThatIsAnOptimizerSaysSo) {
  expect_complaint(process_of(example("descent.py")), "this script is an optimizer");
}

}  // namespace
}  // namespace isoline::problems
