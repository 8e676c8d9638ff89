// The U-net against PyTorch's, its products against each other, and what it promises of sameness.
#include <gtest/gtest.h>

#include "core/threads.h"
#include "networks/network.h"
#include "tests/networks/wave.h"

namespace isoline::networks {

namespace {

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

TEST(Unet, AgreesWithPyTorch) {
  constexpr Real kSingle = 2e-5;  // of the norm: single precision through up to ten batch norms
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

TEST(Unet, HasThePublishedParameters) {
  EXPECT_EQ(make_network("unet", grids(64))->parameters(), 37697);
  EXPECT_EQ(make_network("unet[levels=5,filters=16]", grids(64, 2, 2))->parameters(), 49570);
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

TEST(Unet, PullbackIsTheTransposeOfPushforward) {
  for (const auto& [spec, shape, samples] : kShapes) {
    Trial trial(spec, shape, samples);
    trial.run();
    const Real forward = trial.Jv.cwiseProduct(trial.u).sum();
    const Real scale = trial.Jv.norm() * trial.u.norm();
    EXPECT_NEAR(trial.gradient.dot(trial.v), forward, 1e-5 * scale) << spec;  // single precision
  }
}

// The curvature is linear in (u, du), symmetric in v for fixed u, and with v = 0 the pullback.
TEST(Unet, CurvatureOfAFixedCotangentIsSymmetric) {
  for (const auto& [spec, shape, samples] : kShapes) {
    Trial a(spec, shape, samples), b(spec, shape, samples);
    a.du.setZero();
    b.du.setZero();
    b.v = wave(b.v.size(), 1, 1.1, 0.2);
    a.run();
    b.run();
    const Real scale = a.curvature.norm() * b.v.norm() + b.curvature.norm() * a.v.norm();
    EXPECT_NEAR(a.curvature.dot(b.v), b.curvature.dot(a.v), 1e-5 * scale) << spec;
  }
}

TEST(Unet, CurvatureAlongNothingIsThePullback) {
  Trial trial("unet", grids(16), 4);
  trial.v.setZero();
  trial.run();
  Vector pulled(trial.gradient.size());
  trial.network->pullback(trial.du, pulled, trial.w);
  EXPECT_LT((trial.curvature - pulled).norm(), 1e-6 * pulled.norm());  // single precision
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

TEST(Unet, LayoutCoversThetaAndAKernelIsAColumn) {
  Index end = 0;
  const auto network = make_network("unet", grids(64, 2, 3));
  for (const Block& block : network->layout()) {
    EXPECT_EQ(block.offset, end);
    end += block.rows * block.columns;
    if (block.kind != Block::Kind::convolution) continue;
    EXPECT_TRUE(block.rows == 9 || block.rows == 1) << block.rows;
  }
  EXPECT_EQ(end, network->parameters());
}

TEST(Unet, StartIsPyTorchsDefault) {
  const auto network = make_network("unet", grids(64));
  RandomStream stream(0, "unet", "start");
  const Vector theta = network->start(stream);
  const std::vector<Block> blocks = network->layout();
  EXPECT_LE(theta.segment(0, 9 * 16).lpNorm<Eigen::Infinity>(), 1.0 / 3);  // fan_in = 9
  EXPECT_GT(theta.segment(0, 9 * 16).lpNorm<Eigen::Infinity>(), 0.3);
  EXPECT_EQ(theta.segment(blocks[2].offset, 16), Vector::Ones(16));
  EXPECT_EQ(theta.segment(blocks[3].offset, 16), Vector::Zero(16));
}

// The sentence of the UsageError.
std::string refusal(const std::string& spec, const NetworkShape& shape) {
  try {
    make_network(spec, shape);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(Unet, AShapeThatDoesNotFitIsOneSentence) {
  EXPECT_EQ(refusal("unet", grids(60)), "unet: with levels=4 N must be a multiple of 8, got 60");
  EXPECT_EQ(refusal("unet", {.inputs = 3, .outputs = 2}),
            "unet: the samples must be grids, got columns of 3 numbers");
}

}  // namespace
}  // namespace isoline::networks
