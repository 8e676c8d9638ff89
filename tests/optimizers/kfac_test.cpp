// Kronecker factors where they are the whole curvature, of dense layers and of convolutions, and
// what is left of it elsewhere.
#include <gtest/gtest.h>

#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

using networks::LayerMoments;
namespace {

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
    EXPECT_EQ(why("kfac", published(spec)), "") << spec;
  const std::string lack = "the problem has no network of dense layers or convolutions";
  EXPECT_EQ(why("kfac", published("sine")), lack);
  EXPECT_EQ(why("kfac", published("poisson[mode=learn,network=fno]")), lack);
  EXPECT_EQ(why("kfac", published("sine[mode=learn,network=mlp[layers=5000]]")),
            "a layer of 5000 inputs or outputs, and kfac is limited to 4096");
}

// JJᵀ layer by layer is of dense layers, whose rows are outer products.
TEST(Kfac, AloneTakesConvolutionsByTheirMoments) {
  EXPECT_EQ(
      why("hig[factorization=layers]", published("poisson-hig[mode=learn,network=unet[levels=3]]")),
      "the problem has no network of dense layers");
}

// They end at a thirtieth and at a thirteenth of their start.
TEST(Kfac, LowersTheLossOfAUnet) {
  const std::string small = "[mode=learn,N=8,batch=8,network=unet[levels=2,filters=4]]";
  for (const auto& [problem, spec] : {std::pair{"poisson", "kfac[rate=0.01,damping=1]"},
                                      {"heat", "kfac[rate=0.03,damping=1e-6]"}}) {
    const Outcome result = run(published(problem + small), spec, iterations(60));
    EXPECT_LT(result.trace->last.loss, 0.3 * result.trace->start_loss) << problem;
  }
}

}  // namespace
}  // namespace isoline::optimizers
