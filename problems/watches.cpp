// Series of learning problems: error in x squared, noise of gradients, spectra of updates.
#include "problems/watches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/fourier.h"

namespace isoline::problems {
namespace {

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

Batch part_of(const Batch& whole, Index first, Index count) {
  const auto columns = [&](const Matrix& all) -> Matrix {
    return all.size() > 0 ? Matrix(all.middleCols(first, count)) : all;
  };
  return {columns(whole.input), columns(whole.context), columns(whole.target),
          columns(whole.truth)};
}

struct Noise {
  Real length, direction;
};

// Of gradients, one a column. With unit vectors u_i the mean cosine of two of n is
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

// What the noise is taken from, sized once.
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
      const Batch part = part_of(judging, i * size, size);
      problem.forward(theta, part, at);
      problem.cotangent(at, g);
      problem.pullback(g, gradients.col(i), at);
      update(problem, at, U);
      U /= -static_cast<Real>(size);
      problem.network_pullback(U, updates.col(i), at);
    }
  }
};

constexpr std::array kEdges = {0.05, 0.1, 0.2};  // of the bands, in cycles a cell
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

Series half_squared_error() {
  return {.names = {"½Σ(x − x*)²"},
          .evaluate = [](const Problem&, VectorRef, Point& at, VectorOut values) {
            values[0] =
                0.5 * (at.x() - at.batch->truth).squaredNorm() / static_cast<Real>(at.x().cols());
          }};
}

Series batch_noise() {
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

}  // namespace isoline::problems
