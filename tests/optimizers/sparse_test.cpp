// Sparse Jacobians: linear least squares by blocks against QR, large problems, and bundle
// adjustment by our methods and by Ceres.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "core/decompose.h"
#include "optimizers/sparse_least_squares.h"
#include "problems/conformance.h"
#include "tests/optimizers/run.h"

namespace isoline::optimizers {
namespace {

std::int64_t count_of(const Outcome& outcome, Oracle oracle) {
  return outcome.trace->last.counts[static_cast<std::size_t>(oracle)];
}

const char* const kScene = "bal[cameras=6,points=80]";  // 294 unknowns

// --- linear least squares

// Blocks of unlike sizes: two kept ones of 2 and 1 columns, eliminated ones of 1 and 2, the last
// residual block without an eliminated one.
SparsePattern unlike_blocks() {
  SparsePattern pattern;
  pattern.columns = 6;
  pattern.parameter_block = {0, 2, 3, 4, 6};
  pattern.first_eliminated = 2;
  const std::vector<std::pair<int, std::vector<int>>> blocks = {
      {2, {0, 1, 3}}, {1, {2, 3}}, {3, {0, 1, 2, 4, 5}}, {2, {2, 4, 5}}, {2, {0, 1, 2}}};
  pattern.residual_block = {0};
  for (const auto& [rows, columns] : blocks) {
    for (int row = 0; row < rows; ++row) {
      pattern.column.insert(pattern.column.end(), columns.begin(), columns.end());
      pattern.row_start.push_back(static_cast<int>(pattern.column.size()));
    }
    pattern.residual_block.push_back(static_cast<int>(pattern.row_start.size()) - 1);
  }
  return pattern;
}

// Against QR of A with √μ below it.
void expect_least_squares(const SparsePattern& pattern, const Vector& values, Real mu) {
  const Index m = pattern.rows(), n = pattern.columns;
  const Vector inverse = Vector::LinSpaced(n, 0.5, 1.5), b = Vector::LinSpaced(m, -1, 2);
  Matrix A = Matrix::Zero(m + n, n);
  pattern.expand(values.data(), A.topRows(m));
  A *= inverse.asDiagonal();
  A.bottomRows(n).diagonal().setConstant(std::sqrt(mu));
  Vector right = Vector::Zero(m + n), expected, s, As;
  right.head(m) = b;
  ASSERT_TRUE(least_squares(A, right, 1e-15, expected));
  SparseLeastSquares squares;
  squares.start(pattern);
  squares.set(values, inverse);
  ASSERT_TRUE(squares.solve(mu, b, s, As));
  expect_near(s, expected, 1e-9, "the minimizer");
  expect_near(As, A.topRows(m) * expected, 1e-9, "its image");
}

TEST(SparseLeastSquares, EqualQrWithAndWithoutEliminatedBlocks) {
  SparsePattern pattern = unlike_blocks();
  ASSERT_EQ(pattern.defect(10, 6), "");
  RandomStream stream(0, "sparse", "values");
  const Vector values = stream.normal_vector(pattern.values());
  for (const Real mu : {0.0, 1e-3, 10.0}) expect_least_squares(pattern, values, mu);
  pattern.first_eliminated = pattern.parameter_blocks();
  for (const Real mu : {0.0, 1e-3, 10.0}) expect_least_squares(pattern, values, mu);
}

TEST(SparseLeastSquares, EqualQrForBundleAdjustment) {
  const Problem problem = make(kScene);
  Point at;
  Vector values;
  problem.forward(problem.start(), at);
  problem.sparse_jacobian(values, at);
  const SparsePattern& pattern = *problem.sparse_pattern();
  Vector squares(problem.unknowns());
  pattern.squared_columns(values.data(), squares);
  for (Index p = 0; p < values.size(); ++p)
    values[p] /= std::sqrt(squares[pattern.column[static_cast<std::size_t>(p)]]);
  for (const Real mu : {1e-4, 1.0}) expect_least_squares(pattern, values, mu);
}

TEST(SparsePattern, DefectsAreFound) {
  const SparsePattern sound = unlike_blocks();
  EXPECT_NE(sound.defect(10, 7), "");
  SparsePattern wrong = sound;
  std::swap(wrong.column[0], wrong.column[1]);  // descends
  EXPECT_NE(wrong.defect(10, 6), "");
  wrong = sound;
  wrong.column.back() = 3;  // another row of its block has column 2
  EXPECT_NE(wrong.defect(10, 6), "");
  wrong = sound;
  wrong.first_eliminated = 1;  // a residual block depends on two such blocks
  EXPECT_NE(wrong.defect(10, 6), "");
}

// y = x², whose sparse values are 2x times a factor.
class ScaledSquares final : public problems::Physics {
 public:
  explicit ScaledSquares(Real factor) : factor_(factor) {
    pattern_.columns = 3;
    for (int i = 0; i < 3; ++i) {
      pattern_.column.push_back(i);
      pattern_.row_start.push_back(i + 1);
    }
    set_single_blocks(pattern_);
  }
  Index inputs() const override { return 3; }
  Index outputs() const override { return 3; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override { y = x.cwiseAbs2(); }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = 2 * w.x.cwiseProduct(v);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    JTu = 2 * w.x.cwiseProduct(u);
  }
  const SparsePattern* sparse_pattern() const override { return &pattern_; }
  void sparse_jacobian(VectorOut values, Workspace& w) const override {
    values = 2 * factor_ * w.x.col(0);
  }

 private:
  Real factor_;
  SparsePattern pattern_;
};

TEST(SparseJacobian, IsComparedWithTheProducts) {
  for (const Real factor : {1.0, 1.5}) {
    const Problem problem({.physics = std::make_unique<ScaledSquares>(factor),
                           .start = Vector::Ones(3),
                           .target = Matrix::Zero(3, 1)});
    RandomStream stream(0, "squares", "check");
    const auto findings = problems::examine(problem, stream);
    EXPECT_EQ(std::ranges::count_if(findings, [](const auto& one) { return !one.holds(); }),
              factor == 1 ? 0 : 2);  // by J v and by Jᵀu
  }
}

// --- 100,000 unknowns

constexpr const char* kLarge = "broyden-tridiagonal[n=100000]";

TEST(Large, BroydenIsSolvedByOneSparseJacobianPerStep) {
  const Problem problem = make(kLarge);
  for (const char* method : {"levenberg-marquardt", "gauss-newton", "ceres-lm"}) {
    const Outcome outcome = run(problem, method, {.iterations = 50, .target = 1e-20});
    EXPECT_EQ(outcome.status, Status::target) << method;
    EXPECT_LT(outcome.trace->last.x_error, 1e-10 * problem.truth()->norm()) << method;
    EXPECT_EQ(count_of(outcome, Oracle::jacobian), 0) << method;
    EXPECT_GT(count_of(outcome, Oracle::sparse_jacobian), 0) << method;
    EXPECT_LE(count_of(outcome, Oracle::sparse_jacobian), count_of(outcome, Oracle::forward))
        << method;
  }
}

TEST(Large, DenseMethodsAreInapplicableWithTheSize) {
  const Problem problem = make(kLarge);
  for (const char* method : {"newton", "levenberg-marquardt[factorization=orthogonal]", "hig",
                             "gauss-newton[factorization=svd]", "ceres-lm[linear-solver=dense-qr]",
                             "ceres-bfgs", "saddle-free-newton"})
    EXPECT_NE(why(method, problem).find("100000"), std::string::npos)
        << method << ": " << why(method, problem);
  for (const char* method : {"levenberg-marquardt", "levenberg-marquardt-cg", "gauss-newton",
                             "ceres-lm", "ceres-dogleg", "ceres-lbfgs", "adam"})
    EXPECT_EQ(why(method, problem), "") << method;
  EXPECT_NE(why("ceres-lm[linear-solver=sparse-schur]", problem), "");
}

// --- an unknown field in a differential equation

TEST(Diffusivity, IsFoundByOneSparseFactorizationPerStep) {
  const Problem problem = make("diffusivity[n=24]");  // 1,152 unknowns
  // With acceleration, Levenberg-Marquardt ends in another minimum here.
  for (const char* method : {"levenberg-marquardt[acceleration=0]", "gauss-newton", "ceres-lm"}) {
    const Outcome outcome = run(problem, method, {.iterations = 60, .target = 1e-20});
    EXPECT_LT(outcome.trace->last.x_error, 1e-6 * problem.truth()->norm()) << method;
    EXPECT_EQ(count_of(outcome, Oracle::jacobian), 0) << method;
    EXPECT_GT(count_of(outcome, Oracle::sparse_jacobian), 0) << method;
  }
}

TEST(Diffusivity, IsTooLargeForDenseMethodsOnAFineGrid) {
  const Problem problem = make("diffusivity[n=256]");
  for (const char* method : {"newton", "levenberg-marquardt[factorization=orthogonal]", "hig"})
    EXPECT_NE(why(method, problem).find("131072"), std::string::npos) << why(method, problem);
  for (const char* method : {"levenberg-marquardt", "gauss-newton", "ceres-lm"})
    EXPECT_EQ(why(method, problem), "") << method;
}

// --- bundle adjustment

TEST(Bundle, EveryLinearSolverFindsTheSameMinimum) {
  const Problem problem = make(kScene);
  const Budget budget{.iterations = 60, .target = 0};
  const Outcome dense = run(problem, "levenberg-marquardt[factorization=orthogonal]", budget);
  EXPECT_LT(dense.trace->last.x_error, 0.05);  // 0.5 pixels of 500, at a distance of 10
  for (const char* method :
       {"levenberg-marquardt", "levenberg-marquardt[factorization=sparse]", "ceres-lm",
        "ceres-lm[linear-solver=dense-qr]", "ceres-lm[linear-solver=sparse-normal-cholesky]",
        "ceres-lm[linear-solver=sparse-schur]", "ceres-lm[linear-solver=dense-schur]",
        "ceres-lm[linear-solver=iterative-schur]", "ceres-dogleg"})
    EXPECT_NEAR(run(problem, method, budget).trace->last.loss / dense.trace->last.loss, 1, 1e-8)
        << method;
  EXPECT_NE(why("ceres-dogleg[linear-solver=iterative-schur]", problem), "");
}

TEST(Bundle, OneCallOfTheProblemFillsAllBlocks) {
  const Problem problem = make(kScene);
  for (const char* method : {"ceres-lm", "levenberg-marquardt"}) {
    const Outcome outcome = run(problem, method, iterations(4));
    EXPECT_EQ(count_of(outcome, Oracle::forward), 5) << method;
    EXPECT_LE(count_of(outcome, Oracle::sparse_jacobian), 5) << method;
    EXPECT_EQ(count_of(outcome, Oracle::jacobian), 0) << method;
  }
}

TEST(Bundle, ExactDataAreFittedToRounding) {
  const Problem problem = make("bal[cameras=6,points=80,sigma=0]");
  const Outcome outcome = run(problem, "levenberg-marquardt", {.iterations = 60, .target = 1e-16});
  EXPECT_EQ(outcome.status, Status::target);
  EXPECT_LT(outcome.trace->last.x_error, 1e-5);
}

TEST(Bundle, ProductsAloneLowerTheLoss) {
  const Problem problem = make(kScene);
  const Outcome outcome = run(problem, "levenberg-marquardt-cg", iterations(30));
  EXPECT_LT(outcome.trace->last.loss, 0.1 * outcome.trace->start_loss);
  EXPECT_EQ(count_of(outcome, Oracle::sparse_jacobian), 0);
}

// The block diagonal of JᵀJ brings unknowns of all scales to one: fewer products reach the loss of
// factorizations. In units of the unknowns they do not reach it.
TEST(Bundle, ABlockDiagonalPreconditionsProducts) {
  const Problem problem = make(kScene);
  const Real factorized = run(problem, "levenberg-marquardt", iterations(30)).trace->last.loss;
  const Outcome blocks =
                    run(problem, "levenberg-marquardt-cg[preconditioner=blocks]", iterations(30)),
                plain = run(problem, "levenberg-marquardt-cg", iterations(30));
  EXPECT_LE(blocks.trace->last.loss, 1.01 * factorized);
  EXPECT_GT(plain.trace->last.loss, 1.01 * factorized);
  EXPECT_LT(count_of(blocks, Oracle::pushforward), count_of(plain, Oracle::pushforward));
  EXPECT_NE(why("levenberg-marquardt-cg[preconditioner=blocks]", make("sine")), "");
}

// As the state of a run that another process continues.
TEST(Bundle, AContinuedRunTakesTheSameSteps) {
  const Problem problem = make(kScene);
  const OptimizerEntry& entry = optimizers().at("levenberg-marquardt");
  const OptionValues options = options_of_spec(entry, "levenberg-marquardt");
  Trace traces[2];
  Meter one(problem, iterations(9), needs_of(entry, options, problem), traces[0]);
  Meter other(problem, iterations(9), needs_of(entry, options, problem), traces[1]);
  const auto first = entry.make(options, optimizers()), second = entry.make(options, optimizers());
  Vector theta = problem.start();
  one.begin(theta);
  first->start(one, theta);
  for (int i = 0; i < 2; ++i) first->step(one, theta);
  Archive written;
  ASSERT_TRUE(first->persist(written));
  Vector again = theta;
  other.begin(again);
  second->start(other, again);
  Archive read(written.bytes());
  ASSERT_TRUE(second->persist(read));
  for (int i = 0; i < 3; ++i) {
    first->step(one, theta);
    second->step(other, again);
  }
  EXPECT_EQ(theta, again);
}

// --- the files of Agarwal et al., where ISOLINE_BAL names their folder; losses as Ceres 2.1 of
// Debian printed them, at the iterations named

struct Path {
  const char* file;
  std::vector<std::pair<std::size_t, Real>> losses;
};
const Path kPaths[] = {{"problem-16-22106-pre.txt",
                        {{0, 4.185660e6},
                         {1, 1.062590e5},
                         {2, 4.992817e4},
                         {3, 1.899774e4},
                         {4, 1.808729e4},
                         {5, 1.803399e4},
                         {6, 1.803390e4}}},
                       {"problem-49-7776-pre.txt",
                        {{0, 8.509125e5},
                         {1, 4.648193e4},
                         {2, 1.481752e4},
                         {3, 1.346029e4},
                         {4, 1.343304e4},
                         {5, 1.338876e4}}}};

TEST(BundleFiles, CeresFollowsItsPublishedPath) {
  if (!std::getenv("ISOLINE_BAL")) GTEST_SKIP() << "ISOLINE_BAL is not set";
  for (const Path& path : kPaths) {
    const Problem problem = make(std::string("bal[file=") + path.file + "]");
    for (const char* solver : {"dense-schur", "sparse-schur"}) {
      const Outcome outcome = run(problem, std::string("ceres-lm[linear-solver=") + solver + "]",
                                  iterations(static_cast<std::int64_t>(path.losses.back().first)));
      for (const auto& [iteration, loss] : path.losses)
        EXPECT_EQ(fmt::format("{:.6e}", outcome.trace->point[iteration].loss),
                  fmt::format("{:.6e}", loss))
            << path.file << " " << solver << " " << iteration;
    }
  }
}

TEST(BundleFiles, OurOwnMethodComesAsFar) {
  if (!std::getenv("ISOLINE_BAL")) GTEST_SKIP() << "ISOLINE_BAL is not set";
  const Outcome dubrovnik =
      run(make("bal[file=problem-16-22106-pre.txt]"), "levenberg-marquardt", iterations(20));
  EXPECT_NEAR(dubrovnik.trace->last.loss / 1.803390e4, 1, 1e-3);
  const Outcome ladybug =
      run(make("bal[file=problem-49-7776-pre.txt]"), "levenberg-marquardt", iterations(40));
  EXPECT_NEAR(ladybug.trace->last.loss / 1.334432e4, 1, 1e-3);
}

TEST(BundleFiles, AnAbsentOneIsInapplicableAndAWrongOneIsRefused) {
  EXPECT_THROW(make("bal[file=no-such-file.txt]"), NotApplicable);
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "isoline-bal.txt";
  const std::string spec = "bal[file=" + path.string() + "]";
  std::ofstream(path) << "1 1 1\n0 0 3 4\n0 0 0 0 0 0 100 0 0\n0.03 0.04 -1\n";
  EXPECT_NEAR(loss_at_start(make(spec)), 0, 1e-25);  // p = (0.03, 0.04), y = 100 p
  std::ofstream(path) << "1 1 1\n0 1 3 4\n";         // there is no point 1
  EXPECT_THROW(make(spec), UsageError);
  std::ofstream(path) << "1 1 1\n0 0 3 4\n0 0 0\n";  // it ends too early
  EXPECT_THROW(make(spec), UsageError);
  const std::string scene = "0 0 3D0 +4\n0 0 0 0 0 0 100 0 0\n0.03 0.04 -1\n";
  std::ofstream(path) << "1 1 1\r\n" << scene;
  EXPECT_NEAR(loss_at_start(make(spec)), 0, 1e-25);
  for (const std::string header : {"1 1 0\n", "1 1 2\n", "1 2 1\n", "2 1 1\n", "1 1 1\n7\n"}) {
    std::ofstream(path) << header << scene;  // numbers are left over, missing or shifted
    EXPECT_THROW(make(spec), UsageError) << header;
  }
  std::filesystem::remove(path);
}

// Scenes that differ by rotation, translation and scale have one y and no distance in x.
TEST(Bundle, TheErrorInXIgnoresRotationTranslationAndScale) {
  const Problem problem = make(kScene);
  Vector x = problem.truth()->col(0);
  auto points = x.tail(3 * 80).reshaped(3, 80);
  const Matrix turned = points.colwise().reverse();  // a reflection: not one of them
  points = (2 * points).colwise() + Eigen::Vector3d(1, 2, 3);
  EXPECT_LT(problem.x_error(x), 1e-12);
  x.tail(3 * 80) = turned.reshaped();
  EXPECT_GT(problem.x_error(x), 0.1);
}

}  // namespace
}  // namespace isoline::optimizers
