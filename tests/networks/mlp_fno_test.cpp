// Multilayer perceptrons and Fourier neural operators.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/fourier.h"
#include "networks/activation.h"
#include "networks/fno.h"
#include "networks/network.h"

namespace isoline::networks {
namespace {

std::unique_ptr<Network> make(const std::string& options, Index inputs, Index outputs) {
  return make_network("mlp[" + options + "]", {.inputs = inputs, .outputs = outputs});
}

// Published counts: Holl, Koltun, Thuerey (2022), exponential and sine problems; Schnell, Holl,
// Thuerey (2022), toy example, oscillators and linear chain.
TEST(Perceptron, HasThePublishedNumbersOfParameters) {
  EXPECT_EQ(make("layers=16-64-16,activation=sigmoid", 1, 1)->parameters(), 2177);
  EXPECT_EQ(make("layers=32-64-32", 2, 2)->parameters(), 4354);
  EXPECT_EQ(make("layers=7,activation=tanh", 1, 2)->parameters(), 30);
  EXPECT_EQ(make("layers=20-20-20", 4, 96)->parameters(), 2956);
  EXPECT_EQ(make("layers=20-20-20,activation=tanh", 4, 24)->parameters(), 1444);
}

TEST(Perceptron, BadLayersAreAUsageError) {
  for (const char* layers : {"", "-", "32-", "-32", "32--64", "0", "3.5", "32x64", "32 64", "1e3",
                             "-7", "99999999999999999999"})
    EXPECT_THROW(make(std::string("layers=") + layers, 1, 1), UsageError) << layers;
}

// x = W₂ s(W₁ in + b₁) + b₂ written out, with θ in the declared order.
TEST(Perceptron, IsItsFormula) {
  const Vector theta{{0.5, -1.0, 2.0, 0.25, -0.75, 0.1, -0.2, 1.5, -0.5, 0.3}};
  const Matrix W1 = theta.head(4).reshaped(2, 2), W2 = theta.segment(6, 2).reshaped(1, 2);
  const Vector in{{0.7, -0.4}}, z = W1 * in + theta.segment(4, 2);
  const auto expected = [&](Real (*s)(Real)) { return (W2 * z.unaryExpr(s))[0] + theta[8]; };
  const auto actual = [&](const std::string& activation) {
    Workspace w;
    Matrix x(1, 1);
    make("layers=2,precision=double,activation=" + activation, 2, 1)
        ->forward(theta.head(9), in, x, w);
    return x(0, 0);
  };
  EXPECT_NEAR(actual("relu"), expected([](Real t) { return std::max(t, 0.0); }), 1e-15);
  EXPECT_NEAR(actual("tanh"), expected([](Real t) { return std::tanh(t); }), 1e-15);
  EXPECT_NEAR(actual("sigmoid"), expected([](Real t) { return 1 / (1 + std::exp(-t)); }), 1e-15);
  EXPECT_NEAR(actual("gelu"), expected([](Real t) { return t * std::erfc(-t / std::sqrt(2)) / 2; }),
              1e-15);
}

// What a network gives in both precisions at one θ.
struct Twice {
  explicit Twice(const std::string& activation) {
    for (const char* precision : {"float", "double"}) {
      const auto network = make("activation=" + activation + ",precision=" + precision, 2, 2);
      RandomStream stream(1, "mlp", "test");
      const Vector theta = network->start(stream);
      const Matrix in = 3 * stream.normal_vector(200).reshaped(2, 100),
                   u = stream.normal_vector(200).reshaped(2, 100);
      Workspace w;
      x.emplace_back(2, 100);
      g.emplace_back(theta.size());
      network->forward(theta, in, x.back(), w);
      network->pullback(u, g.back(), w);
    }
  }
  std::vector<Matrix> x;
  std::vector<Vector> g;
};

TEST(Perceptron, FloatAgreesWithDoubleToItsPrecision) {
  for (const char* activation : {"relu", "tanh", "sigmoid", "gelu"}) {
    const Twice twice(activation);
    EXPECT_LE((twice.x[0] - twice.x[1]).norm(), 1e-6 * twice.x[1].norm()) << activation;
    EXPECT_LE((twice.g[0] - twice.g[1]).norm(), 1e-5 * twice.g[1].norm()) << activation;
    EXPECT_NE(twice.x[0], twice.x[1]) << activation << ": both are of one precision";
  }
}

// What belongs to a sample, x, its change along v and its rows of the Jacobian, may not depend on
// its place: neither on the batch around it, nor on where vector registers end, nor on the kernels
// that a library picks.
TEST(Perceptron, EqualSamplesGetEqualBits) {
  constexpr Index kRows = 2;
  for (const std::string options : {"activation=relu", "activation=tanh", "activation=sigmoid",
                                    "activation=gelu", "activation=tanh,precision=double"}) {
    const auto network = make("layers=7-33-5," + options, 3, 2);
    RandomStream stream(1, "mlp", "test");
    const Vector theta = network->start(stream), sample = stream.normal_vector(3),
                 v = stream.normal_vector(network->parameters());
    const Matrix dy_dx = stream.normal_vector(2 * kRows).reshaped(kRows, 2);
    Matrix x1, Jv1, J1;
    for (const Index samples : {1, 2, 15, 16, 37, 100}) {
      Matrix x(2, samples), Jv(2, samples), J(kRows * samples, network->parameters());
      Workspace w;
      network->forward(theta, sample.replicate(1, samples), x, w);
      network->pushforward(v, Jv, w);
      network->jacobian(dy_dx.replicate(1, samples), J, w);
      if (samples == 1) {
        x1 = x;
        Jv1 = Jv;
        J1 = J;
      }
      for (Index b = 0; b < samples; ++b) {
        EXPECT_EQ(x.col(b), x1) << options << ": " << b << " of " << samples;
        EXPECT_EQ(Jv.col(b), Jv1) << options << ": " << b << " of " << samples;
        EXPECT_EQ(J.middleRows(b * kRows, kRows), J1) << options << ": " << b << " of " << samples;
      }
    }
  }
}

// ReLU's second derivative is 0: of one hidden layer, only the products of weights of two layers
// remain, so the curvature along a change of the first layer has no entries in that layer.
TEST(Perceptron, OfReluHasNoSecondDerivativeWithinALayer) {
  for (const char* activation : {"relu", "tanh"}) {
    const auto network =
        make(fmt::format("layers=5,precision=double,activation={}", activation), 3, 2);
    RandomStream stream(1, "mlp", "test");
    const Vector theta = network->start(stream);
    const Matrix in = stream.normal_vector(12).reshaped(3, 4), u = Matrix::Ones(2, 4);
    constexpr Index kFirst = 5 * 3 + 5;
    Vector v = stream.normal_vector(theta.size()), bend(theta.size());
    v.tail(theta.size() - kFirst).setZero();
    Workspace w;
    Matrix x(2, 4), change(2, 4);
    network->forward(theta, in, x, w);
    network->pushforward(v, change, w);
    network->curvature(v, u, Matrix::Zero(2, 4), bend, w);
    EXPECT_EQ(bend.head(kFirst).norm() == 0, std::string(activation) == "relu") << activation;
    EXPECT_GT(bend.tail(theta.size() - kFirst).norm(), 0) << activation;
  }
}

TEST(Perceptron, DoesNotHideWhatIsNotFinite) {
  for (const char* activation : {"relu", "tanh", "sigmoid", "gelu"}) {
    const auto network = make(std::string("activation=") + activation, 1, 1);
    Workspace w;
    Matrix x(1, 1);
    const Matrix in = Matrix::Constant(1, 1, std::nan(""));
    network->forward(Vector::Ones(network->parameters()), in, x, w);
    EXPECT_FALSE(is_finite(x)) << activation;
  }
}

// Bounds of the two initial distributions, and biases of zero where they are asked for.
TEST(Perceptron, StartsAsPyTorchOrKerasDo) {
  RandomStream stream(1, "mlp", "test");
  const Vector torch = make("layers=400", 100, 1)->start(stream);
  EXPECT_NEAR(torch.head(400 * 101).cwiseAbs().maxCoeff(), 1 / std::sqrt(100.0), 1e-4);
  EXPECT_NEAR(torch.tail(401).cwiseAbs().maxCoeff(), 1 / std::sqrt(400.0), 1e-3);
  const Vector glorot = make("layers=400,init=glorot", 100, 1)->start(stream);
  EXPECT_NEAR(glorot.head(40'000).cwiseAbs().maxCoeff(), std::sqrt(6.0 / 500), 1e-4);
  EXPECT_EQ(glorot.segment(40'000, 400).norm(), 0);
  EXPECT_EQ(glorot[glorot.size() - 1], 0);
}

// Against the C library in extended precision, over the seam at 0.625 and both ends.
TEST(Activations, TheHyperbolicTangentInDoubleIsExactToTwoUnitsOfTheLastPlace) {
  constexpr Index kNumbers = 4000;
  const Real kUnit = std::numeric_limits<Real>::epsilon();
  Flat<double> z(kNumbers), a(kNumbers);
  for (Index i = 0; i < kNumbers; ++i)  // 1e-8 to 1e2, both signs
    z[i] = (i % 2 == 0 ? 1 : -1) * std::pow(10.0, -8 + 10.0 * Real(i) / kNumbers);
  activate<double>(Activation::tanh, z, a);
  for (Index i = 0; i < kNumbers; ++i) {
    const long double exact = std::tanh(static_cast<long double>(z[i]));
    EXPECT_LE(std::abs(static_cast<Real>(a[i] / exact - 1)), 2 * kUnit) << z[i];
  }
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  z.head(4) << std::nan(""), kInfinity, -kInfinity, 0;
  activate<double>(Activation::tanh, z, a);
  EXPECT_TRUE(std::isnan(a[0]));
  EXPECT_EQ(a[1], 1);
  EXPECT_EQ(a[2], -1);
  EXPECT_EQ(a[3], 0);
}

// The Fourier neural operator.

std::unique_ptr<Network> make(const std::string& spec, Index N) {
  return make_network(spec, {.inputs = N * N, .outputs = N * N, .grid = N});
}

// 1,188,353 where a complex number counts once, Holl, Koltun, Thuerey (2022).
TEST(FourierOperator, HasThePublishedNumberOfParameters) {
  const auto network = make("fno", 64);
  EXPECT_EQ(network->parameters(), 2'368'001);
  Index complex = 0;
  for (const Block& block : network->layout())
    if (block.kind == Block::Kind::spectrum) complex += block.rows * block.columns / 2;
  EXPECT_EQ(network->parameters() - complex, 1'188'353);
}

// A row is the real or imaginary part of a pair of channels, a column a mode of one corner.
TEST(FourierOperator, SpectraAreLaidOutByPairsOfChannelsAndModes) {
  constexpr Index kWidth = 3, kModesKept = 2;
  const auto network = make("fno[modes=2,width=3]", 8);
  Index spectra = 0;
  for (const Block& block : network->layout()) {
    if (block.kind != Block::Kind::spectrum) continue;
    EXPECT_EQ(block.rows, 2 * kWidth * kWidth);
    EXPECT_EQ(block.columns, kModesKept * kModesKept);
    ++spectra;
  }
  EXPECT_EQ(spectra, 4 * 2);  // layers, corners of the half spectrum
}

TEST(FourierOperator, WantsAGridWithRoomForItsModes) {
  EXPECT_THROW(make_network("fno", {.inputs = 4, .outputs = 4}), UsageError);
  EXPECT_THROW(make("fno[modes=13]", 16), UsageError);  // 26 of 25 cells
  EXPECT_NO_THROW(make("fno[modes=12,width=2]", 16));
}

constexpr Index kSize = 11, kModes = 4;

// Column of mode (k, frequency f along columns).
Index column(Index k, Index f) { return k + kModes * (f < 0 ? f + 2 * kModes : f); }

TEST(TruncatedFourier, HasTheLowestModesOfTheWholeTransform) {
  RandomStream stream(1, "fno", "test");
  const Matrix grids = stream.normal_vector(2 * kSize * kSize).reshaped(kSize, 2 * kSize);
  const TruncatedFourier few(kSize, kModes);
  TruncatedFourier::Spectra S;
  TruncatedFourier::Room room;
  few.analyze(TruncatedFourier::Weights::none, grids.cast<float>(), S, room);
  RealFourier2d whole(kSize, kSize);
  for (Index grid = 0; grid < 2; ++grid) {
    whole.forward(grids.middleCols(grid * kSize, kSize).reshaped());
    for (Index k = 0; k < kModes; ++k) {
      for (Index f = -kModes; f < kModes; ++f) {
        const auto expected = whole.spectrum()(k, (f + kSize) % kSize);
        const std::complex<Real> found(S(grid, 2 * column(k, f)), S(grid, 2 * column(k, f) + 1));
        EXPECT_LE(std::abs(found - expected), 1e-5) << k << " " << f;  // 121 terms in float
      }
    }
  }
}

// All that is kept, transformed back, is what the whole transform gives with the rest at zero.
TEST(TruncatedFourier, SynthesisIsTheInverseOfTheHalfSpectrum) {
  RandomStream stream(2, "fno", "test");
  TruncatedFourier::Spectra S(1, 4 * kModes * kModes);
  RealFourier2d whole(kSize, kSize);
  whole.spectrum().setZero();
  for (Index k = 0; k < kModes; ++k) {
    for (Index f = -kModes; f < kModes; ++f) {
      const std::complex<Real> value(stream.normal(), stream.normal());
      whole.spectrum()(k, (f + kSize) % kSize) = value;
      S(0, 2 * column(k, f)) = static_cast<float>(value.real());
      S(0, 2 * column(k, f) + 1) = static_cast<float>(value.imag());
    }
  }
  Vector expected(kSize * kSize);
  whole.inverse(expected);
  expected /= whole.round_trip();
  Gemm<float>::Array grid = Gemm<float>::Array::Zero(kSize, kSize);
  TruncatedFourier::Room room;
  TruncatedFourier(kSize, kModes).synthesize(TruncatedFourier::Weights::inverse, S, grid, room);
  EXPECT_LE((grid.cast<Real>().reshaped() - expected).norm(), 1e-6 * expected.norm());  // float
}

}  // namespace
}  // namespace isoline::networks
