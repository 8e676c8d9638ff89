// Identities between methods that follow from their formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/decompose.h"
#include "problems/features.h"
#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

namespace isoline::optimizers {
using networks::LayerMoments;

namespace {

// To 1e-10, and to rounding times cond(J)² where that is more.
void expect_same_path(const Problem& problem, const std::string& one, const std::string& other) {
  constexpr int kSteps = 10;
  const Outcome a = run(problem, one, iterations(kSteps)),
                b = run(problem, other, iterations(kSteps));
  ASSERT_EQ(a.path.size(), b.path.size()) << one;
  ASSERT_GE(a.path.size(), 1U) << one;
  Point at;
  Svd svd;
  Matrix J;
  for (std::size_t i = 0; i < a.path.size(); ++i) {
    problem.forward(a.path[i], at);
    problem.jacobian(J, at);
    ASSERT_TRUE(thin_svd(J, svd));
    const Real cond = svd.sigma[0] / svd.sigma[svd.sigma.size() - 1];
    EXPECT_LE((a.path[i] - b.path[i]).norm() / a.path[i].norm(),
              std::max(1e-10, 1e-15 * cond * cond))
        << one << ", " << other << ", step " << i;
  }
}

// Problems of the registry whose Jacobian has full column rank along the first steps.
const std::vector<std::string> kRegular = {"sine",
                                           "exponential",
                                           "rosenbrock",
                                           "beale",
                                           "helical-valley",
                                           "brown-dennis",
                                           "wood",
                                           "broyden-tridiagonal",
                                           "variably-dimensioned",
                                           "scaling[alpha=0.01]",
                                           "poisson[N=8]"};

TEST(HalfInverse, KappaOneIsGaussNewton) {
  expect_same_path(easy(), "hig[kappa=1,cutoff=0,rate=0.3]", "gauss-newton[rate=0.3]");
  for (const std::string& name : kRegular) {
    SCOPED_TRACE(name);
    expect_same_path(make(name), "hig[kappa=1,cutoff=0,rate=0.3]", "gauss-newton[rate=0.3]");
  }
  // A loss without ½ doubles g, on which the family acts, and leaves r, on which Gauss-Newton does.
  expect_same_path(make("square"), "hig[kappa=1,cutoff=0,rate=0.15]", "gauss-newton[rate=0.3]");
}

// σ = 1 and 1e-3: with a cut-off of 0.1 the second is discarded, or counts as 0.1.
TEST(HalfInverse, SmallSingularValuesAreDiscardedOrClamped) {
  const Matrix M = Eigen::Vector2d(1, 1e-3).asDiagonal();
  const Problem problem = linear(M, Eigen::Vector2d(2, 3), Vector::Zero(2));
  for (const Real kappa : {1.0, 0.5}) {
    const std::string options = "[cutoff=0.1,kappa=" + std::to_string(kappa);
    const auto step = [&](const std::string& rest) {
      return Vector(run(problem, "hig" + options + rest, iterations(1)).theta - problem.start());
    };
    const Real g = 3e-3;  // ∂L/∂y₂
    EXPECT_LE((step("]") - Eigen::Vector2d(-2, 0)).norm(), 1e-14);
    const Eigen::Vector2d clamped(-2, -g * std::pow(0.1, -kappa));
    EXPECT_LE((step(",small=clamp]") - clamped).norm(), 1e-14);
  }
}

TEST(HalfInverse, KappaMinusOneIsGradientDescent) {
  expect_same_path(easy(), "hig[kappa=-1,cutoff=0,rate=0.1]", "gd[rate=0.1]");
  constexpr const char* kCautious = "1e-9";  // below 2 over the largest curvature of them all
  for (const std::string& name : kRegular)
    expect_same_path(make(name), std::string("hig[kappa=-1,cutoff=0,rate=") + kCautious + "]",
                     std::string("gd[rate=") + kCautious + "]");
  expect_same_path(make("broyden-tridiagonal"), "hig[kappa=-1,cutoff=0,rate=0.02]",
                   "gd[rate=0.02]");
}

TEST(InverseGradient, StepsAsGaussNewtonWhereTheJacobianIsSquare) {
  expect_same_path(make("broyden-tridiagonal"), "inverse-gradient", "gauss-newton");
}

TEST(CeresGaussNewton, TakesTheStepsOfGaussNewton) {
  const Problem problem = make("broyden-tridiagonal");
  for (int steps = 1; steps <= 4; ++steps) {  // at the fifth both stand at the root
    const Vector ours = run(problem, "gauss-newton", iterations(steps)).theta;
    const Vector theirs = run(problem, "ceres-gauss-newton", iterations(steps)).theta;
    expect_near(theirs, ours, 1e-10, std::to_string(steps));
  }
}

// Candidates that raise the loss are counted as rejected and leave θ where it was.
// x = Σ σᵢ/(σᵢ² + α) vᵢ uᵢᵀ y* of P(x) = A x with the penalty ½α‖x‖².
TEST(LeastSquares, FindTikhonovsSolutionOfALinearProblem) {
  constexpr Real kAlpha = 1e-3;
  for (const char* spec : {"poisson[N=4]", "deconvolution-1d[N=32]"}) {
    const Problem plain = make(spec);
    const Problem penalized =
        with_features(make(spec), {{"noise", 0.01}, {"tikhonov", kAlpha}}, problems::Draw(0, spec));
    Point at;
    Matrix A;
    plain.forward(plain.start(), at);
    plain.jacobian(A, at);
    Svd svd;
    ASSERT_TRUE(thin_svd(A, svd));
    const Vector filter = svd.sigma.array() / (svd.sigma.array().square() + kAlpha);
    const Vector data = penalized.target().topRows(A.rows()).reshaped();
    const Vector x = svd.Vt.transpose() * (filter.asDiagonal() * (svd.U.transpose() * data));
    for (const char* method :
         {"gauss-newton", "levenberg-marquardt", "ceres-gauss-newton", "minpack-lmder"})
      EXPECT_LE((run(penalized, method, {.iterations = 100, .target = 0}).theta - x).norm(),
                1e-10 * x.norm())
          << method << " on " << spec;
  }
}

TEST(LevenbergMarquardt, LossNeverRises) {
  const Outcome result = run(far_root(), "levenberg-marquardt", iterations(60));
  Real before = result.trace->start_loss;
  for (int i = 0; i < result.trace->points; ++i) {
    EXPECT_LE(result.trace->point[i].loss, before) << i;
    before = result.trace->point[i].loss;
  }
  EXPECT_GT(result.trace->rejected_steps, 0);
  EXPECT_LE(before, 1e-20);
}

// Of unit length for any number of unknowns, as small as a gradient may be before the loss is zero.
TEST(Rescaled, StepsHaveUnitLengthAgainstTheGradient) {
  for (const Real size : {1.0, 1e-150}) {
    const Problem problem = linear(easy_matrix(), size * Eigen::Vector2d(3, -4), Vector::Zero(2));
    Point at;
    problem.forward(problem.start(), at);
    const Vector slope = easy_matrix().transpose() * (at.y / size);
    const Vector step = first_step(problem, "rescaled[network-optimizer=gd[rate=1]]");
    EXPECT_LE((step + slope.normalized()).norm(), 1e-14) << size;
  }
}

TEST(Sip, IdentityNetworkAndUnitStepSolveInOne) {
  for (const char* spec : {"sip", "sip[inverse=lbfgs]"}) {
    const Outcome result = run(easy(), spec, iterations(1));
    EXPECT_LE((easy_matrix() * result.theta - Eigen::Vector2d(0.5, -0.3)).norm(), 1e-12) << spec;
  }
}

TEST(Sip, NetworkIsDrawnToTheInvertedTargets) {
  for (const char* spec :
       {"sip[network-optimizer=gd[rate=1]]", "sip[network-optimizer=gd,step=0.5]",
        "sip[inverse=lbfgs,network-optimizer=gd[rate=1]]",
        "sip[network-optimizer=adam[rate=0.05]]"}) {
    const Outcome result = run(learned_line(), spec, {.iterations = 5000, .target = 1e-8});
    EXPECT_EQ(result.status, Status::target) << spec;
    EXPECT_NEAR(result.theta[0], 2, 1e-3) << spec;
    EXPECT_NEAR(result.theta[1], 1, 1e-3) << spec;
  }
}

// One sample of four has no inverse: it adds nothing to the mean, the others all they would.
TEST(Sip, SampleWithoutInverseTeachesNothing) {
  const Vector step =
      first_step(learned_line(true), "sip[inverse=analytic,network-optimizer=gd[rate=1]]");
  const Vector gap = Eigen::Vector3d(1 - 1, 1.5 - 1, 2.5 - 1);  // x̃ − x of the first three
  EXPECT_NEAR(step[0], gap.sum() / 4, 1e-14);
  EXPECT_NEAR(step[1], gap.dot(Eigen::Vector3d(-1, -0.5, 0.5)) / 4, 1e-14);
}

TEST(Sip, L1ProxySeesSignsAlone) {
  const Vector step = first_step(learned_line(), "sip[proxy=l1,network-optimizer=gd[rate=1]]");
  EXPECT_NEAR(step[0], 3.0 / 4, 1e-14);  // one sample is right already: x = 1, y* = 1
  EXPECT_NEAR(step[1], (-0.5 + 0.5 + 1) / 4, 1e-14);
}

TEST(Sip, AnalyticInverseIsRefusedWhereThereIsNone) {
  const Problem problem = make("broyden-tridiagonal");
  EXPECT_NE(why("sip[inverse=analytic]", problem).find("local inverse"), std::string::npos);
  EXPECT_EQ(why("sip", problem), "");
  EXPECT_EQ(why("sip[inverse=lbfgs]", problem), "");
}

TEST(InverseGradient, NeedsAsManyResidualsAsUnknowns) {
  const Problem tall = linear(Matrix::Ones(3, 2), Vector::Ones(2), Vector::Zero(3));
  EXPECT_TRUE(why("inverse-gradient", tall).ends_with(": 3 residuals, 2 unknowns"));
}

// Invariance under rescaled inputs, as declared: `scaling` from the same y₀ = (3, 3) in units of x
// that differ by α, so that a method whose path in y depends on them shows it.

constexpr int kSteps = 10;

Problem scaling(Real alpha) { return make("scaling[alpha=" + std::to_string(alpha) + "]"); }

// The largest difference, relative to ‖y₀‖, between the paths in y for α and for 1.
Real path_difference(const std::string& spec, Real alpha) {
  const Outcome a = run(scaling(1), spec, iterations(kSteps));
  const Outcome b = run(scaling(alpha), spec, iterations(kSteps));
  const int points = std::max<int>(a.trace->points, b.trace->points);
  Real largest = 0;
  for (int i = 0; i < points; ++i) {  // a path that has ended stays where it is
    const std::vector<Real>& ya =
        a.parts.trajectory->y[std::size_t(std::min<int>(i, a.trace->points - 1))];
    const std::vector<Real>& yb =
        b.parts.trajectory->y[std::size_t(std::min<int>(i, b.trace->points - 1))];
    for (std::size_t row = 0; row < 2; ++row) {
      const Real gap = std::abs(ya[row] - yb[row]);
      largest = std::isfinite(gap) ? std::max(largest, gap) : 1;
    }
  }
  return largest / std::hypot(3, 3);
}

// Steps of 0.3 of the whole way, where the method has such an option.
std::string cautious(const OptimizerEntry& entry) {
  for (const char* option : {"step", "rate"})
    for (const OptionField& field : entry.options)
      if (field.name == option) return entry.name + "[" + option + "=0.3]";
  return entry.name;
}

Real worst_difference(const std::string& spec) {
  Real worst = 0;
  for (const Real alpha : {1e-3, 1e-2, 0.1, 7.0, 1e2, 1e3})
    worst = std::max(worst, path_difference(spec, alpha));
  return worst;
}

TEST(Invariance, DeclaredMethodsAgreeAndOthersDoNot) {
  for (const auto& [name, entry] : optimizers()) {
    if (!why_inapplicable(entry, options_of_spec(entry, name), scaling(1)).empty()) continue;
    if (name == "dfo-gn") continue;  // its round trust region holds the solution for each α
    const Real worst = worst_difference(cautious(entry));
    EXPECT_EQ(worst <= 1e-9, entry.is_input_scale_invariant) << name << ": " << worst;
  }
}

TEST(Invariance, IsDeclaredByTheMethodsOfWhichItIsClaimed) {
  for (const char* name : {"newton", "gauss-newton", "inverse-gradient", "sip"})
    EXPECT_TRUE(optimizers().at(name).is_input_scale_invariant) << name;
}

// Kronecker factors where they are the whole curvature, of dense layers and of convolutions, and
// what they approximate elsewhere.

// A convolution of periodic N×N grids and nothing after it: taps up to `reach` away, bias.
class Convolved final : public Network {
 public:
  Convolved(Index N, Index in, Index out, Index reach)
      : N_(N), in_(in), out_(out), reach_(reach), rows_(in * side() * side()) {}
  Index parameters() const override { return out_ * (rows_ + 1); }
  Index inputs() const override { return in_ * N_ * N_; }
  Index outputs() const override { return out_ * N_ * N_; }
  Vector start(RandomStream& stream) const override { return stream.normal_vector(parameters()); }
  std::vector<Block> layout() const override {
    return {{0, side() * side(), in_ * out_, Block::Kind::convolution},
            {rows_ * out_, out_, 1, Block::Kind::bias}};
  }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    w.saved.clear();
    for (Index b = 0; b < in.cols(); ++b) w.saved.push_back(patches(in.col(b)));
    pushforward(theta, x, w);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < Jv.cols(); ++b)
      Jv.col(b) = (w.saved[b].transpose() * matrix(v)).reshaped();
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    Matrix sum = Matrix::Zero(rows_ + 1, out_);
    for (Index b = 0; b < u.cols(); ++b) sum += w.saved[b] * u.col(b).reshaped(N_ * N_, out_);
    JTu << sum.topRows(rows_).reshaped(), sum.row(rows_).transpose();
  }
  bool has_layer_moments() const override { return true; }
  void layer_moments(BatchRef u, std::vector<LayerMoments>& out, VectorOut JTu,
                     Workspace& w) const override {
    pullback(u, JTu, w);
    const Real samples = Real(u.cols()), places = Real(N_ * N_);
    LayerMoments all{.weight = 0,
                     .bias = 1,
                     .inputs = Matrix::Zero(rows_ + 1, rows_ + 1),
                     .cotangents = Matrix::Zero(out_, out_)};
    for (Index b = 0; b < u.cols(); ++b) {
      const Matrix g = u.col(b).reshaped(N_ * N_, out_);
      all.inputs += w.saved[b] * w.saved[b].transpose() / samples;
      all.cotangents += g.transpose() * g / (samples * places);
    }
    out = {all};
  }

 private:
  Index side() const { return 2 * reach_ + 1; }
  // [W b]ᵀ, one output a column.
  Matrix matrix(VectorRef theta) const {
    Matrix Wb(rows_ + 1, out_);
    Wb << theta.head(rows_ * out_).reshaped(rows_, out_), theta.tail(out_).transpose();
    return Wb;
  }
  Matrix patches(VectorRef in) const {  // (taps · channels + 1, places)
    Matrix P = Matrix::Ones(rows_ + 1, N_ * N_);
    for (Index place = 0; place < N_ * N_; ++place)
      for (Index i = 0; i < rows_; ++i) {
        const Index tap = i % (side() * side()), channel = i / (side() * side());
        const Index column = (place / N_ + tap / side() - reach_ + N_) % N_;
        const Index row = (place % N_ + tap % side() - reach_ + N_) % N_;
        P(i, place) = in[(channel * N_ + column) * N_ + row];
      }
    return P;
  }

  Index N_, in_, out_, reach_, rows_;
};

Matrix drawn(Index rows, Index columns, std::uint64_t seed) {
  return RandomStream(seed, "trial", "data").normal_vector(rows * columns).reshaped(rows, columns);
}

// Fits y = M N(input; θ) to numbers drawn at random.
Problem fit(const Matrix& M, std::unique_ptr<Network> network, const Vector& start, Index samples) {
  const Matrix input = drawn(network->inputs(), samples, 1);
  return Problem({.physics = std::make_unique<Linear>(M),
                  .start = start,
                  .target = drawn(M.rows(), samples, 2),
                  .network = std::move(network),
                  .input = input});
}

// One layer and a linear physics: its Gauss-Newton matrix is A ⊗ G, whatever the inputs.
TEST(Kfac, IsTheNaturalGradientOfOneLayer) {
  const Problem problem = learned_affine(20);
  expect_near(first_step(problem, "kfac[rate=1,damping=1e-24]"),
              first_step(problem, "gauss-newton"), 1e-10, "one layer");
}

// All cotangents but one are zero, so that the draw of signs is the sum over outputs.
TEST(Kfac, DrawsOneCotangentOfManyOutputs) {
  constexpr Index kMany = 65;
  const Matrix one = Eigen::RowVector2d(2, -1);
  Matrix many = Matrix::Zero(kMany, 2);
  many.row(3) = one;
  const Vector start = drawn(8, 1, 4);
  Problem first = fit(one, std::make_unique<Affine>(3, 2), start, 5);
  Matrix target = Matrix::Zero(kMany, 5);
  target.row(3) = first.target();
  const Problem second({.physics = std::make_unique<Linear>(many),
                        .start = start,
                        .target = target,
                        .network = std::make_unique<Affine>(3, 2),
                        .input = first.batch().input});
  const std::string spec = "kfac[rate=0.5,damping=0.1]";
  expect_near(run(second, spec, iterations(4)).theta, run(first, spec, iterations(4)).theta, 1e-12,
              "drawn");
}

// A dense layer's weights lie column by column, a convolution's output by output.
TEST(Kfac, OfAConvolutionAtOnePlaceIsThatOfADenseLayer) {
  constexpr Index kIn = 3, kOut = 2;
  const auto as_dense = [](Vector theta) {
    theta.head(kIn * kOut) =
        theta.head(kIn * kOut).reshaped(kIn, kOut).transpose().reshaped().eval();
    return theta;
  };
  const Matrix M = Eigen::RowVector2d(2, -1);
  const Vector start = drawn(kOut * (kIn + 1), 1, 4);
  const Problem dense = fit(M, std::make_unique<Affine>(kIn, kOut), as_dense(start), 5);
  const Problem convolution = fit(M, std::make_unique<Convolved>(1, kIn, kOut, 0), start, 5);
  const std::string spec = "kfac[rate=0.5,damping=0.1]";
  expect_near(as_dense(run(convolution, spec, iterations(4)).theta),
              run(dense, spec, iterations(4)).theta, 1e-12, "one place");
}

// Of one channel that is the output, cotangents of different places are uncorrelated and alike.
TEST(Kfac, IsTheNaturalGradientOfAConvolutionWhoseOutputIsSeenPlaceByPlace) {
  const Index places = 9;
  const Problem problem = fit(3 * Matrix::Identity(places, places),
                              std::make_unique<Convolved>(3, 2, 1, 1), drawn(19, 1, 4), 4);
  expect_near(first_step(problem, "kfac[rate=1,damping=1e-24]"),
              first_step(problem, "gauss-newton"), 1e-9, "places");
}

TEST(Kfac, StepsABatchNormOverTheMeanOfEachBlocksDiagonal) {
  const Problem problem = separate({{0, 2, 1, Block::Kind::norm}, {2, 2, 1, Block::Kind::norm}});
  const Eigen::Vector4d gradient(1, 4, 9, 16), mean(2.5, 2.5, 12.5, 12.5);
  const Vector expected = -(gradient.array() / (mean.array() + 0.5)).matrix();
  expect_near(first_step(problem, "kfac[rate=1,damping=0.5]"), expected, 1e-14, "norms");
}

TEST(Kfac, IsForDenseLayersAndConvolutionsOfUpToSomeThousandInputs) {
  EXPECT_EQ(why("kfac", learned_affine(3)), "");
  for (const char* spec : {"poisson[mode=learn]", "heat[mode=learn]", "navier-stokes[mode=learn]",
                           "burgers[mode=learn]"})
    EXPECT_EQ(why("kfac", make(spec)), "") << spec;
  EXPECT_TRUE(why("kfac", make("sine")).ends_with("dense layers or convolutions"));
  EXPECT_TRUE(why("kfac", make("poisson[mode=learn,network=fno]")).ends_with(" or convolutions"));
  EXPECT_TRUE(why("kfac", make("sine[mode=learn,network=mlp[layers=5000]]"))
                  .ends_with(" kfac is limited to 4096"));
}

// JJᵀ layer by layer is of dense layers, whose rows are outer products.
TEST(Kfac, AloneTakesConvolutionsByTheirMoments) {
  EXPECT_TRUE(
      why("hig[factorization=layers]", make("poisson-hig[mode=learn,network=unet[levels=3]]"))
          .ends_with("network of dense layers"));
}

// They end at a thirtieth and at a thirteenth of their start.
TEST(Kfac, LowersTheLossOfAUnet) {
  const std::string small = "[mode=learn,N=8,batch=8,network=unet[levels=2,filters=4]]";
  for (const auto& [problem, spec] : {std::pair{"poisson", "kfac[rate=0.01,damping=1]"},
                                      {"heat", "kfac[rate=0.03,damping=1e-6]"}}) {
    const Outcome result = run(make(problem + small), spec, iterations(60));
    EXPECT_LT(result.trace->last.loss, 0.3 * result.trace->start_loss) << problem;
  }
}

}  // namespace
}  // namespace isoline::optimizers
