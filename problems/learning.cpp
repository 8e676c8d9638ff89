// Series of learning problems: error in x squared, noise of gradients, spectra of updates.
#include "problems/learning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/fourier.h"

namespace isoline::problems {
namespace {

// The values of the hidden neurons, layer below layer, (neurons, B).
Matrix hidden_values(const Problem& problem, Point& at) {
  std::vector<LayerFactor> layers;
  problem.network().layer_factors(Matrix::Zero(problem.inputs(), at.y.cols()), layers, at.network);
  Matrix values(0, at.y.cols());
  for (std::size_t l = 1; l < layers.size(); ++l) {
    const auto layer = layers[l].inputs.leftCols(at.y.cols());
    values.conservativeResize(values.rows() + layer.rows(), values.cols());
    values.bottomRows(layer.rows()) = layer;
  }
  return values;
}

// The count first, then the means of the neurons shown, then their spreads.
void saturation_of(const Matrix& hidden, Index last, VectorOut values) {
  constexpr Real kNear = 0.01;  // of ±1, and of a spread of 0
  const Vector means = hidden.rowwise().mean();
  const Vector spreads =
      (hidden.colwise() - means).array().square().rowwise().mean().sqrt().matrix();
  const Eigen::Array<bool, Eigen::Dynamic, 1> at_one =
      spreads.array() < kNear && means.array().abs() > 1 - kNear;
  const Eigen::Array<bool, Eigen::Dynamic, 1> at_zero = (hidden.array() == 0).rowwise().all();
  const Index shown = values.size() / 2;
  values[0] = static_cast<Real>((at_one || at_zero).count());
  values.segment(1, shown) = means.tail(last).head(shown);
  values.tail(shown) = spreads.tail(last).head(shown);
}

// U = P⁻¹(y*; x) − x; 0 where a sample has no inverse, not-a-number where the physics has none.
void update(const Problem& problem, Point& at, Matrix& U) {
  U = at.x();
  if (problem.inverse_kind() == Inverse::none) {
    U.setConstant(std::nan(""));
    return;
  }
  const Success success = problem.local_inverse(at.batch->target, U, at);
  U -= at.x();
  for (Index b = 0; b < success.size(); ++b)
    if (!success[b]) U.col(b).setZero();
}

Batch batch_part(const Batch& whole, Index first, Index count) {
  const auto columns = [&](const Matrix& all) -> Matrix {
    return all.size() > 0 ? Matrix(all.middleCols(first, count)) : all;
  };
  return {columns(whole.input), columns(whole.context), columns(whole.target),
          columns(whole.truth)};
}

struct Noise {
  Real length, direction;
};

// For gradients, one per column. With unit vectors u_i the mean cosine of two of n is
// (‖Σ uᵢ‖² − n)/(n² − n).
Noise noise_of(const Matrix& gradients) {
  const Vector norms = gradients.colwise().norm();
  const auto n = static_cast<Real>(norms.size());
  const Real mean = norms.mean();
  const Real deviation = std::sqrt((norms.array() - mean).square().sum() / (n - 1));
  Vector sum = Vector::Zero(gradients.rows());
  for (Index i = 0; i < norms.size(); ++i)
    if (norms[i] > 0) sum += gradients.col(i) / norms[i];
  return {deviation / mean, 1 - (sum.squaredNorm() - n) / (n * (n - 1))};
}

// The inputs of the noise, allocated once.
struct Parts {
  Point at;
  Matrix g, U;                // (m, B), (k, B)
  Matrix gradients, updates;  // (n, parts): of L, of SIP's proxy

  void fill(const Problem& problem, VectorRef theta, const Batch& judging) {
    constexpr Index kFewest = 4;  // parts: two have one cosine
    const Index size = std::min(problem.samples(), judging.samples() / kFewest);
    const Index count = judging.samples() / size;
    gradients.resize(problem.unknowns(), count);
    updates.resize(problem.unknowns(), count);
    g.resize(problem.outputs(), size);
    for (Index i = 0; i < count; ++i) {
      const Batch part = batch_part(judging, i * size, size);
      problem.forward(theta, part, at);
      problem.cotangent(at, g);
      problem.pullback(g, gradients.col(i), at);
      update(problem, at, U);
      U /= -static_cast<Real>(size);
      problem.network_pullback(U, updates.col(i), at);
    }
  }
};

constexpr std::array kEdges = {0.05, 0.1, 0.2};  // limits of the bands, in cycles per cell
constexpr std::array kBands = {"k ≤ 0.05", "0.05 < k ≤ 0.1", "0.1 < k ≤ 0.2", "k > 0.2"};
constexpr std::array kSpectra = {"x* − x", "∂L/∂x", "U"};

class Spectrum {
 public:
  explicit Spectrum(Index N) : N_(N), fourier_(N, N) {}

  void evaluate(const Problem& problem, Point& at, VectorOut values) {
    constexpr auto kCount = static_cast<Index>(kBands.size());
    Matrix field = at.batch->truth - at.x(), g(problem.outputs(), at.y.cols());
    values.head(kCount) = shares(field);
    problem.cotangent(at, g);
    problem.physics_pullback(g, field, at);
    values.segment(kCount, kCount) = shares(field);
    update(problem, at, field);
    values.tail(kCount) = shares(field);
  }

 private:
  // The columns but for the first and, of even N, the last stand for two modes: k and −k.
  Vector shares(const Matrix& fields) {
    Vector sum = Vector::Zero(static_cast<Index>(kBands.size()));
    for (Index b = 0; b < fields.cols(); ++b) {
      Vector power = Vector::Zero(sum.size());
      fourier_.forward(fields.col(b));
      for (Index j = 0; j < N_; ++j)
        for (Index i = 0; i <= N_ / 2; ++i) {
          if (i == 0 && j == 0) continue;
          const Real twice = i == 0 || 2 * i == N_ ? 1 : 2;
          power[band(i, std::min(j, N_ - j))] += twice * std::norm(fourier_.spectrum()(i, j));
        }
      if (const Real total = power.sum(); total > 0) sum += power / total;
    }
    return sum / static_cast<Real>(fields.cols());
  }
  Index band(Index i, Index j) const {
    const Real k = std::hypot(static_cast<Real>(i), static_cast<Real>(j)) / static_cast<Real>(N_);
    return std::lower_bound(kEdges.begin(), kEdges.end(), k) - kEdges.begin();
  }

  Index N_;
  RealFourier2d fourier_;
};

}  // namespace

Series joined(Series first, Series second) {
  if (first.names.empty()) return second;
  if (second.names.empty()) return first;
  const auto count = static_cast<Index>(first.names.size());
  Series both{.names = first.names};
  both.names.insert(both.names.end(), second.names.begin(), second.names.end());
  both.evaluate = [first, second, count](const Problem& problem, VectorRef theta, Point& at,
                                         VectorOut values) {
    first.evaluate(problem, theta, at, values.head(count));
    second.evaluate(problem, theta, at, values.tail(values.size() - count));
  };
  return both;
}

Series hidden_activity(const Network& network) {
  if (!network.has_layer_factors()) return {};
  return {.names = {"mean of the hidden neurons", "spread of the hidden neurons"},
          .evaluate = [](const Problem& problem, VectorRef, Point& at, VectorOut values) {
            const Matrix hidden = hidden_values(problem, at);
            const Real mean = hidden.mean();
            values << mean, std::sqrt((hidden.array() - mean).square().mean());
          }};
}

Series saturation(const Network& network, Index shown) {
  if (!network.has_layer_factors()) return {};
  Index last = 0;  // neurons of the last hidden layer, which are the last of the hidden values
  for (const networks::Block& block : network.layout())
    if (block.kind == networks::Block::Kind::weight) last = block.columns;
  Series series{.names = {"saturated neurons"},
                .evaluate = [last](const Problem& problem, VectorRef, Point& at, VectorOut values) {
                  saturation_of(hidden_values(problem, at), last, values);
                }};
  for (const char* of : {"mean of neuron ", "spread of neuron "})
    for (Index i = 1; i <= std::min(last, shown); ++i)
      series.names.push_back(of + std::to_string(i));
  return series;
}

void add_neurons(ProblemParts& parts) {
  const Network& network = *parts.network;
  parts.series = joined(std::move(parts.series),
                        joined(hidden_activity(network), saturation(network, /*shown=*/0)));
}

Series path(std::vector<std::string> names, std::function<Index(const Batch& batch)> which) {
  return {.names = std::move(names),
          .evaluate = [which = std::move(which)](const Problem&, VectorRef, Point& at,
                                                 VectorOut values) {
            values = at.y.col(which(*at.batch)).head(values.size());
          }};
}

// ½Σ(x − x*)² over the components, the mean over samples: what the published curves of grids show
// beside Σ|x − x*|.
static Series half_squared_error() {
  return {.names = {"½Σ(x − x*)²"},
          .evaluate = [](const Problem&, VectorRef, Point& at, VectorOut values) {
            values[0] =
                0.5 * (at.x() - at.batch->truth).squaredNorm() / static_cast<Real>(at.x().cols());
          }};
}

// How far the gradients in θ of two batches differ at the same θ: of L, and of what SIP descends,
// (1/B) Σ ½‖x − x̃‖² with x̃ = P⁻¹(y*; x) held. The batches are the validation in parts of the size
// of a training batch, at most a quarter of it. `length` is the standard deviation of the
// gradients' norms over their mean, `direction` 1 − the mean cosine of two of them.
static Series batch_noise() {
  const auto parts = std::make_shared<Parts>();
  return {
      .names = {"noise of ∇L: length", "noise of ∇L: direction", "noise of U: length",
                "noise of U: direction"},
      .evaluate = [parts](const Problem& problem, VectorRef theta, Point& at, VectorOut values) {
        parts->fill(problem, theta, *at.batch);
        const Noise loss = noise_of(parts->gradients), proxy = noise_of(parts->updates);
        values << loss.length, loss.direction, proxy.length, proxy.direction;
      }};
}

Series spectrum(Index grid) {
  const auto of = std::make_shared<Spectrum>(grid);
  Series series{.evaluate = [of](const Problem& problem, VectorRef, Point& at, VectorOut values) {
    of->evaluate(problem, at, values);
  }};
  for (const std::string quantity : kSpectra)
    for (const char* range : kBands)
      series.names.push_back("spectrum of " + quantity + ", " + range);
  return series;
}

// Learning problems from their options.

ProblemParts from_exact_data(std::unique_ptr<Physics> physics, const Vector& truth,
                             const Draw& draw, StartScale scale) {
  Workspace w;
  Matrix target(physics->outputs(), 1);
  physics->forward(truth, Matrix(0, 1), target, w);
  return {.physics = std::move(physics),
          .start = draw.start(Vector::Zero(truth.size()), scale),
          .start_scale = scale,
          .target = target,
          .minimum = 0,
          .truth = truth};
}

Real summed_error(BatchRef x, const Batch& batch) {
  return (x - batch.truth).cwiseAbs().sum() / static_cast<Real>(x.cols());
}

std::function<void(RandomStream&, Index, Batch&)> sample_of(
    std::shared_ptr<const SelfAdjointPhysics> physics, std::function<Vector(RandomStream&)> truth) {
  return [physics, truth](RandomStream& stream, Index b, Batch& batch) {
    batch.truth.col(b) = truth(stream);
    physics->apply(batch.truth.col(b), batch.target.col(b));
    batch.input.col(b) = batch.target.col(b);
  };
}

// The same samples, but the input of each is that of the next one, and of the last that of the
// first.
static auto shuffled(std::function<void(RandomStream&, Index, Batch&)> draw) {
  return [draw = std::move(draw)](RandomStream& stream, Index b, Batch& batch) {
    draw(stream, b, batch);
    const Index last = batch.samples() - 1;
    if (b < last) return;
    const Vector first = batch.input.col(0);
    for (Index i = 0; i < last; ++i) batch.input.col(i) = batch.input.col(i + 1);
    batch.input.col(last) = first;
  };
}

ProblemParts learn(const Learning& options, const NetworkShape& shape, const Draw& draw,
                   ProblemParts parts) {
  if (!parts.network) parts.network = networks::make_network(options.network, shape);
  RandomStream stream = draw.start_stream("network");
  parts.start = parts.network->start(stream);
  parts.samples.batch = options.batch;
  parts.samples.data = options.data;
  if (options.inputs == "shuffled") parts.samples.draw = shuffled(std::move(parts.samples.draw));
  const Index epoch = options.data > 0 ? 0 : parts.samples.epoch;
  require(epoch % options.batch == 0, "epoch must be a multiple of batch");
  const bool is_fresh = options.data == 0 && epoch == 0;
  parts.samples.stream = [draw, is_fresh](std::string_view purpose) {
    return is_fresh && purpose == "training" ? draw.start_stream(purpose) : draw.stream(purpose);
  };
  if (shape.grid > 0) parts.series = joined(std::move(parts.series), half_squared_error());
  if (options.watch == "noise") parts.series = joined(std::move(parts.series), batch_noise());
  if (options.watch == "spectrum") {
    require(shape.grid > 0, "watch=spectrum requires samples that are fields on a grid");
    parts.series = joined(std::move(parts.series), spectrum(shape.grid));
  }
  return parts;
}

}  // namespace isoline::problems
