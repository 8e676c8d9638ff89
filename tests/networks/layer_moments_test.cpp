// The moments of a U-net's convolutions against a U-net of this file, in double precision and pixel
// by pixel: patches summed by hand, cotangents by differences of its outputs.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "core/threads.h"
#include "networks/network.h"
#include "tests/networks/wave.h"

namespace isoline::networks {
namespace {

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

struct Trial {
  std::unique_ptr<Network> network;
  Matrix in, u, x;
  Vector theta, gradient;
  std::vector<LayerMoments> moments;
  Workspace w;

  explicit Trial(const Case& of)
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

constexpr Real kSingle = 2e-5;  // of the norm: single precision through up to six batch norms

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
    Trial trial(of);
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
    Trial trial(of);
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
  Trial trial(kCases[0]);
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

// Each sample twice: no mean changes, but the tasks that share the work do.
TEST(LayerMoments, AreMeansOverSamplesInHoweverManyTasks) {
  for (const Index N : {4, 32}) {
    Trial once({"circular", N, 2, 5, 1, 3}), twice({"circular", N, 2, 5, 1, 6});
    twice.in << once.in, once.in;
    twice.u << once.u, once.u;
    once.run();
    twice.run();
    for (std::size_t l = 0; l < once.moments.size(); ++l) {
      const auto& [weight, bias, inputs, cotangents] = once.moments[l];
      EXPECT_LE((twice.moments[l].inputs - inputs).norm(), kSingle * inputs.norm());
      EXPECT_LE((twice.moments[l].cotangents - cotangents).norm(), kSingle * cotangents.norm());
    }
  }
}

TEST(LayerMoments, AreTheSameBitsAgainAndOnMoreThreads) {
  const Case of{"zero", 32, 2, 9, 1, 4};
  Trial first(of), again(of), threaded(of);
  first.run();
  again.run();
  again.run();
  set_library_threads(3);
  threaded.run();
  set_library_threads(1);
  for (std::size_t l = 0; l < first.moments.size(); ++l)
    for (const Trial* other : {&again, &threaded}) {
      EXPECT_EQ(other->moments[l].inputs, first.moments[l].inputs) << l;
      EXPECT_EQ(other->moments[l].cotangents, first.moments[l].cotangents) << l;
    }
}

}  // namespace
}  // namespace isoline::networks
