// The U-net against PyTorch's, its products against each other, and its reproducibility.
#include <gtest/gtest.h>

#include <cmath>

#include "core/threads.h"
#include "networks/network.h"
#include "tests/refusal.h"

namespace isoline::networks {

namespace {

// sin(a i + b), which PyTorch's side of the golden values can draw too.
Matrix wave(Index rows, Index columns, Real a, Real b) {
  return (a * Vector::LinSpaced(rows * columns, 0, Real(rows * columns - 1)).array() + b)
      .sin()
      .matrix()
      .reshaped(rows, columns);
}

NetworkShape grids(Index N, Index in = 1, Index out = 1) {
  return {.inputs = in * N * N,
          .outputs = out * N * N,
          .grid = N,
          .input_channels = in,
          .output_channels = out};
}

// A network at its start, and directions given by formulas.
struct Trial {
  std::unique_ptr<Network> network;
  Matrix in, u, du, x, Jv;
  Vector theta, v, gradient, curvature;
  Workspace w;

  Trial(const std::string& spec, const NetworkShape& shape, Index samples)
      : network(make_network(spec, shape)) {
    const Index n = network->parameters(), k = network->outputs();
    in = wave(network->inputs(), samples, 0.9, 0.1);
    u = wave(k, samples, 1.3, 0.2);
    du = wave(k, samples, 0.4, 0.6);
    RandomStream stream(0, "unet", "start");
    theta = network->start(stream);
    v = wave(n, 1, 0.7, 0.5);
    x = Jv = Matrix(k, samples);
    gradient = curvature = Vector(n);
  }
  void run() {
    network->forward(theta, in, x, w);
    network->pullback(u, gradient, w);
    network->pushforward(v, Jv, w);
    network->curvature(v, u, du, curvature, w);
  }
};

// PyTorch 1.13 in double precision: the modules of benchmarks/micro/unet_pytorch.py at θ_i =
// ½ sin(1.7 i + 0.3), in its own order, with the input and the directions of Trial; the curvature
// by differentiating its gradient. Norms, and products with u, v and sin(1.1 i + 0.2).
struct Golden {
  const char* spec;
  Index channels_in, channels_out, N, samples, parameters;
  Real x, x_u, gradient, gradient_v, curvature, curvature_q;
};
const Golden kGoldens[] = {
    {"unet[levels=2,filters=3,padding=circular]", 2, 1, 4, 2, 598, 0.917424233, 0.238907503,
     6.38925041, 7.82690312, 68.827216, 38.10909},
    {"unet[levels=2,filters=3,padding=zero]", 2, 1, 4, 2, 598, 0.932892986, -0.383050752,
     7.51864848, -0.821467046, 50.1412502, -10.4973976},
    {"unet[levels=3,filters=17,padding=circular]", 1, 2, 8, 3, 29310, 21.4300252, -0.71876818,
     88.9902532, 1.40032496, 2755.04022, -2359.56841},
    {"unet[levels=3,filters=17,padding=zero]", 1, 2, 8, 3, 29310, 21.4347258, 4.09572909,
     71.1078985, 185.556935, 3474.94657, 3079.69565},
    {"unet[levels=1,filters=16,padding=circular]", 1, 1, 4, 1, 2561, 3.36941294, -0.0979275998,
     19.8253844, 9.16803249, 240.609023, 115.626484},
};

constexpr Real kSingle = 2e-5;  // of the norm: single precision through up to ten batch norms

TEST(Unet, AgreesWithPyTorch) {
  for (const Golden& golden : kGoldens) {
    SCOPED_TRACE(golden.spec);
    const NetworkShape shape = grids(golden.N, golden.channels_in, golden.channels_out);
    Trial trial(golden.spec, shape, golden.samples);
    ASSERT_EQ(trial.network->parameters(), golden.parameters);
    trial.theta = wave(golden.parameters, 1, 1.7, 0.3) / 2;
    trial.run();
    const Vector q = wave(golden.parameters, 1, 1.1, 0.2);
    const auto expect = [&](Real given, Real wanted, Real scale) {
      EXPECT_NEAR(given, wanted, kSingle * scale);
    };
    expect(trial.x.norm(), golden.x, golden.x);
    expect(trial.x.cwiseProduct(trial.u).sum(), golden.x_u, golden.x * trial.u.norm());
    expect(trial.gradient.norm(), golden.gradient, golden.gradient);
    expect(trial.gradient.dot(trial.v), golden.gradient_v, golden.gradient * trial.v.norm());
    expect(trial.curvature.norm(), golden.curvature, golden.curvature);
    expect(trial.curvature.dot(q), golden.curvature_q, golden.curvature * q.norm());
  }
}

// Shapes that take another path each: more images a task, blocks half full, many channels in.
const std::tuple<std::string, NetworkShape, Index> kShapes[] = {
    {"unet", grids(16), 6},
    {"unet[padding=zero]", grids(16), 1},
    {"unet[levels=3,filters=5]", grids(12, 2, 3), 5},
    {"unet[levels=2,filters=32]", grids(40, 1, 2), 2},
    {"unet[levels=2,filters=8,padding=zero]", grids(6, 16, 1), 3},
    {"unet[levels=2,filters=8]", grids(6, 19, 1), 3},
};

TEST(Unet, PullbackIsTheTransposeOfPushforwardAndCurvatureOfAFixedCotangentIsSymmetric) {
  for (const auto& [spec, shape, samples] : kShapes) {
    Trial a(spec, shape, samples), b(spec, shape, samples);
    a.du.setZero();
    b.du.setZero();
    b.v = wave(b.v.size(), 1, 1.1, 0.2);
    a.run();
    b.run();
    EXPECT_NEAR(a.gradient.dot(a.v), a.Jv.cwiseProduct(a.u).sum(),
                1e-5 * a.Jv.norm() * a.u.norm())  // single precision
        << spec;
    const Real scale = a.curvature.norm() * b.v.norm() + b.curvature.norm() * a.v.norm();
    EXPECT_NEAR(a.curvature.dot(b.v), b.curvature.dot(a.v), 1e-5 * scale) << spec;
  }
}

TEST(Unet, GivesTheSameBitsAgainAndOnMoreThreadsAndFromArraysThatLieElsewhere) {
  Trial first("unet", grids(32), 6);
  first.run();
  Trial again("unet", grids(32), 6);
  again.run();
  again.run();
  set_library_threads(3);
  Trial threaded("unet", grids(32), 6);
  Matrix memory(1024 + 1, 6);
  memory.bottomRows(1024) = first.in;
  threaded.run();
  threaded.network->forward(first.theta, memory.bottomRows(1024), threaded.x, threaded.w);
  threaded.network->pullback(first.u, threaded.gradient, threaded.w);
  for (const Trial* other : {&again, &threaded}) {
    EXPECT_EQ(other->x, first.x);
    EXPECT_EQ(other->gradient, first.gradient);
    EXPECT_EQ(other->Jv, first.Jv);
    EXPECT_EQ(other->curvature, first.curvature);
  }
}

TEST(Unet, AWorkspaceServesBatchesOfAnySize) {
  Trial large("unet[levels=2]", grids(8), 7), small("unet[levels=2]", grids(8), 2);
  small.run();
  large.run();
  Trial reused("unet[levels=2]", grids(8), 2);
  std::swap(reused.w, large.w);
  reused.run();
  EXPECT_EQ(reused.x, small.x);
  EXPECT_EQ(reused.gradient, small.gradient);
  EXPECT_EQ(reused.curvature, small.curvature);
}

TEST(Unet, InferByTheBatchsOwnStatisticsIsForward) {
  Trial trial("unet[filters=12]", grids(16), 5);
  trial.network->forward(trial.theta, trial.in, trial.x, trial.w);
  const Vector statistics = trial.network->statistics(trial.theta, trial.in, trial.w);
  EXPECT_EQ(statistics.size(), 14 * 2 * 12);  // units, mean and variance, channels
  Matrix inferred(trial.x.rows(), trial.x.cols());
  trial.network->infer(trial.theta, statistics, trial.in, inferred, trial.w);
  EXPECT_LT((inferred - trial.x).norm(), 1e-5 * trial.x.norm());  // single precision
  Matrix alone(trial.x.rows(), 1);
  trial.network->infer(trial.theta, statistics, trial.in.col(2), alone, trial.w);
  EXPECT_EQ(alone, inferred.col(2)) << "given statistics, a sample does not see the others";
}

TEST(Unet, BiasesBeforeBatchNormChangeNothingButTheStatistics) {
  Trial plain("unet[levels=2]", grids(8), 3), shifted("unet[levels=2]", grids(8), 3);
  Index at = 0;
  for (const Block& block : plain.network->layout()) {
    if (block.kind != Block::Kind::bias || block.offset + block.rows == plain.theta.size())
      continue;
    shifted.theta.segment(block.offset, block.rows).array() += 1;
    ++at;
  }
  EXPECT_EQ(at, 6);
  plain.run();
  shifted.run();
  EXPECT_EQ(plain.x, shifted.x);
  const Vector before = plain.network->statistics(plain.theta, plain.in, plain.w);
  const Vector after = shifted.network->statistics(shifted.theta, shifted.in, shifted.w);
  EXPECT_NEAR((after - before).sum(), 6 * 16, 1e-9);
}

TEST(Unet, HasThePublishedParametersAndTheStartThatPyTorchDraws) {
  const auto network = make_network("unet", grids(64));
  EXPECT_EQ(network->parameters(), 37697);
  EXPECT_EQ(make_network("unet[levels=5,filters=16]", grids(64, 2, 2))->parameters(), 49570);
  RandomStream stream(0, "unet", "start");
  const Vector theta = network->start(stream);
  const std::vector<Block> blocks = network->layout();
  EXPECT_LE(theta.segment(0, 9 * 16).lpNorm<Eigen::Infinity>(), 1.0 / 3);  // fan_in = 9
  EXPECT_GT(theta.segment(0, 9 * 16).lpNorm<Eigen::Infinity>(), 0.3);
  EXPECT_EQ(theta.segment(blocks[2].offset, 16), Vector::Ones(16));
  EXPECT_EQ(theta.segment(blocks[3].offset, 16), Vector::Zero(16));
}

std::string refusal_of(const std::string& spec, const NetworkShape& shape) {
  return refusal([&] { make_network(spec, shape); });
}

TEST(Unet, AShapeThatDoesNotFitIsOneSentence) {
  EXPECT_TRUE(refusal_of("unet", grids(60)).ends_with("multiple of 8, got 60"));
  EXPECT_TRUE(
      refusal_of("unet", {.inputs = 3, .outputs = 2}).ends_with("got columns of 3 numbers"));
}

// The moments of its convolutions against a U-net of this file, in double precision and pixel by
// pixel: patches summed by hand, cotangents by differences of its outputs.

using Grids = std::vector<Matrix>;  // one a sample: (N², channels)

// Adds h to one number of the output of one convolution.
struct Nudge {
  std::size_t unit = 0;
  Index sample = 0, place = 0, channel = 0;
  Real h = 0;
};

// Two levels, or one: N×N grids, `in` channels to one, θ in the order of layout().
struct Reference {
  Index N, levels, filters, in;
  bool is_circular;
  const Vector& theta;
  Nudge nudge = {};
  std::vector<Grids> patches = {};  // of each convolution: one a sample, (rows of ā, places)
  Index at = 0;                     // what of θ is read

  Index size(const Grids& grids) const {
    return static_cast<Index>(std::lround(std::sqrt(Real(grids[0].rows()))));
  }
  Matrix kernel(Index outputs, Index rows) {  // one row for each output
    const Matrix W = theta.segment(at, outputs * rows).reshaped(rows, outputs).transpose();
    at += outputs * rows;
    return W;
  }
  Vector numbers(Index count) {
    at += count;
    return theta.segment(at - count, count);
  }

  // ā = (a, 1) at each place: of each channel the taps, [column][row].
  Grids patches_of(const Grids& a, Index reach) const {
    const Index n = size(a), side = 2 * reach + 1, taps = side * side, channels = a[0].cols();
    Grids all;
    for (const Matrix& grid : a) {
      Matrix P = Matrix::Zero(taps * channels + 1, n * n);
      P.row(taps * channels).setOnes();
      for (Index place = 0; place < n * n; ++place)
        for (Index tap = 0; tap < taps; ++tap) {
          Index column = place / n + tap / side - reach, row = place % n + tap % side - reach;
          if (is_circular) {
            column = (column + n) % n;
            row = (row + n) % n;
          }
          if (column < 0 || column >= n || row < 0 || row >= n) continue;
          for (Index c = 0; c < channels; ++c) P(c * taps + tap, place) = grid(column * n + row, c);
        }
      all.push_back(P);
    }
    return all;
  }
  Grids convolve(const Grids& a, Index outputs, Index reach) {
    const std::size_t unit = patches.size();
    patches.push_back(patches_of(a, reach));
    Matrix Wb(outputs, patches[unit][0].rows());
    const Matrix W = kernel(outputs, Wb.cols() - 1);
    Wb << W, numbers(outputs);
    Grids z;
    for (const Matrix& P : patches[unit]) z.emplace_back((Wb * P).transpose());
    if (unit == nudge.unit) z[std::size_t(nudge.sample)](nudge.place, nudge.channel) += nudge.h;
    return z;
  }
  Grids unit(const Grids& a) {
    Grids z = convolve(a, filters, 1);
    const Vector gamma = numbers(filters), beta = numbers(filters);
    for (Index c = 0; c < filters; ++c) {
      const Real count = Real(z[0].rows()) * Real(z.size());
      Real mean = 0, variance = 0;
      for (const Matrix& grid : z) mean += grid.col(c).sum() / count;
      for (const Matrix& grid : z) variance += (grid.col(c).array() - mean).square().sum() / count;
      for (Matrix& grid : z)
        grid.col(c) =
            (gamma[c] * (grid.col(c).array() - mean) / std::sqrt(variance + 1e-5) + beta[c]).max(0);
    }
    return z;
  }
  Grids pooled(const Grids& a) const {
    const Index n = size(a) / 2;
    Grids all;
    for (const Matrix& grid : a) {
      Matrix coarse(n * n, grid.cols());
      for (Index column = 0; column < n; ++column)
        for (Index row = 0; row < n; ++row) {
          const Index first = 4 * n * column + 2 * row;
          coarse.row(column * n + row) = grid.row(first)
                                             .cwiseMax(grid.row(first + 1))
                                             .cwiseMax(grid.row(first + 2 * n))
                                             .cwiseMax(grid.row(first + 2 * n + 1));
        }
      all.push_back(coarse);
    }
    return all;
  }
  // The skipped channels, then the coarse ones, linear between the centres of their pixels.
  Grids joined(const Grids& skipped, const Grids& coarse) const {
    const Index n = size(coarse);
    Matrix L = Matrix::Zero(2 * n, n);  // along one side
    for (Index i = 0; i < 2 * n; ++i) {
      const Real x = std::clamp((Real(i) + 0.5) / 2 - 0.5, Real(0), Real(n - 1));
      const auto left = std::min(static_cast<Index>(x), std::max<Index>(n - 2, 0));
      L(i, left) += 1 - (x - Real(left));
      if (left + 1 < n) L(i, left + 1) += x - Real(left);
    }
    Grids all;
    for (std::size_t b = 0; b < coarse.size(); ++b) {
      Matrix both(4 * n * n, skipped[b].cols() + coarse[b].cols());
      both.leftCols(skipped[b].cols()) = skipped[b];
      for (Index c = 0; c < coarse[b].cols(); ++c)
        both.col(skipped[b].cols() + c) =
            (L * coarse[b].col(c).reshaped(n, n) * L.transpose()).reshaped();
      all.push_back(both);
    }
    return all;
  }

  Matrix operator()(const Matrix& input) {
    Grids a;
    for (Index b = 0; b < input.cols(); ++b) a.emplace_back(input.col(b).reshaped(N * N, in));
    a = unit(unit(a));
    if (levels == 2) a = unit(unit(joined(a, unit(unit(pooled(a))))));
    const Grids x = convolve(a, 1, 0);
    Matrix out(N * N, input.cols());
    for (Index b = 0; b < input.cols(); ++b) out.col(b) = x[std::size_t(b)];
    EXPECT_EQ(at, theta.size());
    return out;
  }
};

struct Case {
  const char* padding;
  Index N, levels, filters, in, samples;
};

struct MomentTrial {
  std::unique_ptr<Network> network;
  Matrix in, u, x;
  Vector theta, gradient;
  std::vector<LayerMoments> moments;
  Workspace w;

  explicit MomentTrial(const Case& of)
      : network(make_network("unet[levels=" + std::to_string(of.levels) + ",filters=" +
                                 std::to_string(of.filters) + ",padding=" + of.padding + "]",
                             {.inputs = of.in * of.N * of.N,
                              .outputs = of.N * of.N,
                              .grid = of.N,
                              .input_channels = of.in})),
        in(wave(network->inputs(), of.samples, 0.9, 0.1)),
        u(wave(network->outputs(), of.samples, 1.3, 0.2)),
        x(u),
        theta(0.5 * wave(network->parameters(), 1, 1.7, 0.3)),
        gradient(theta) {}
  void run() {
    network->forward(theta, in, x, w);
    network->layer_moments(u, moments, gradient, w);
  }
};

const Case kCases[] = {{"circular", 4, 2, 3, 2, 2},
                       {"zero", 4, 2, 3, 2, 2},
                       {"zero", 4, 2, 9, 1, 3},  // more filters than a block of channels
                       {"circular", 1, 1, 2, 3, 4},
                       {"zero", 2, 1, 4, 1, 3}};

TEST(LayerMoments, InputsAreThePatchesSummedOverPlacesByHand) {
  const Case large[] = {{"circular", 32, 2, 5, 1, 3}, {"zero", 32, 2, 5, 2, 3}};  // many tasks
  for (const Case& of :
       {kCases[0], kCases[1], kCases[2], kCases[3], kCases[4], large[0], large[1]}) {
    SCOPED_TRACE(std::string(of.padding) + " " + std::to_string(of.N));
    MomentTrial trial(of);
    trial.run();
    Reference reference{
        of.N, of.levels, of.filters, of.in, of.padding == std::string("circular"), trial.theta};
    const Matrix x = reference(trial.in);
    ASSERT_LE((trial.x - x).norm(), kSingle * x.norm());
    ASSERT_EQ(trial.moments.size(), reference.patches.size());
    for (std::size_t l = 0; l < trial.moments.size(); ++l) {
      Matrix expected = 0 * reference.patches[l][0] * reference.patches[l][0].transpose();
      for (const Matrix& P : reference.patches[l]) expected += P * P.transpose() / Real(of.samples);
      ASSERT_EQ(trial.moments[l].inputs.rows(), expected.rows()) << l;
      EXPECT_LE((trial.moments[l].inputs - expected).norm(), kSingle * expected.norm()) << l;
    }
  }
}

TEST(LayerMoments, CotangentsAreThoseOfDifferencesMeanOverPlaces) {
  for (const Case& of : kCases) {
    SCOPED_TRACE(std::string(of.padding) + " " + std::to_string(of.N));
    MomentTrial trial(of);
    trial.run();
    const auto value = [&](const Nudge& nudge) {
      Reference reference{
          of.N,        of.levels, of.filters, of.in, of.padding == std::string("circular"),
          trial.theta, nudge};
      return reference(trial.in).cwiseProduct(trial.u).sum();
    };
    for (std::size_t l = 0; l < trial.moments.size(); ++l) {
      const bool is_coarse = of.levels == 2 && (l == 2 || l == 3);
      const Index places = of.N * of.N / (is_coarse ? 4 : 1);
      const Index channels = l + 1 == trial.moments.size() ? 1 : of.filters;
      Matrix expected = Matrix::Zero(channels, channels);
      for (Index b = 0; b < of.samples; ++b)
        for (Index t = 0; t < places; ++t) {
          Vector g(channels);
          for (Index c = 0; c < channels; ++c) {
            constexpr Real kStep = 1e-6;
            g[c] = (value({l, b, t, c, kStep}) - value({l, b, t, c, -kStep})) / (2 * kStep);
          }
          expected += g * g.transpose() / Real(of.samples * places);
        }
      // Differences of sums of this size round at 1e-9; the rest is the network's.
      EXPECT_LE((trial.moments[l].cotangents - expected).norm(),
                10 * kSingle * expected.norm() + 1e-8)
          << l;
    }
  }
}

TEST(LayerMoments, NameTheBlocksOfTheirKernelsAndComeWithThePullback) {
  MomentTrial trial(kCases[0]);
  trial.run();
  Vector pulled = trial.gradient;
  trial.network->pullback(trial.u, pulled, trial.w);
  EXPECT_EQ(trial.gradient, pulled);
  const std::vector<Block> layout = trial.network->layout();
  for (const LayerMoments& of : trial.moments) {
    const Block &W = layout.at(std::size_t(of.weight)), &b = layout.at(std::size_t(of.bias));
    EXPECT_EQ(W.kind, Block::Kind::convolution);
    EXPECT_EQ(b.kind, Block::Kind::bias);
    EXPECT_EQ(of.cotangents.rows(), b.rows);
    EXPECT_EQ((of.inputs.rows() - 1) * b.rows, W.rows * W.columns);
  }
}

TEST(LayerMoments, AreTheSameBitsAgainAndOnMoreThreads) {
  const Case of{"zero", 32, 2, 9, 1, 4};
  MomentTrial first(of), again(of), threaded(of);
  first.run();
  again.run();
  again.run();
  set_library_threads(3);
  threaded.run();
  set_library_threads(1);
  for (std::size_t l = 0; l < first.moments.size(); ++l)
    for (const MomentTrial* other : {&again, &threaded}) {
      EXPECT_EQ(other->moments[l].inputs, first.moments[l].inputs) << l;
      EXPECT_EQ(other->moments[l].cotangents, first.moments[l].cotangents) << l;
    }
}

}  // namespace
}  // namespace isoline::networks
