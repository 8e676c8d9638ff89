// Problems small enough to check optimizers by hand.
#pragma once

#include <cmath>

#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline::optimizers {

using networks::Block;
using networks::LayerFactor;
using networks::Network;
using problems::DensePhysics;
using problems::HalfSquared;

// y = M x, M (m, k); x by least squares, unique where M has full column rank.
class Linear final : public DensePhysics {
 public:
  explicit Linear(Matrix M) : DensePhysics(M.cols(), M.rows()), M_(std::move(M)) {}
  void value(VectorRef x, VectorOut y) const override { y.noalias() = M_ * x; }
  void derivative(VectorRef, BatchOut J) const override { J = M_; }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef, BatchOut) const override {}
  Inverse inverse_kind() const override {
    return M_.rows() == M_.cols() ? Inverse::exact : Inverse::none;
  }
  bool invert(VectorRef y, VectorRef, VectorOut x) const override {  // Cramer's rule, k = 2
    const Real determinant = M_(0, 0) * M_(1, 1) - M_(0, 1) * M_(1, 0);
    x << M_(1, 1) * y[0] - M_(0, 1) * y[1], M_(0, 0) * y[1] - M_(1, 0) * y[0];
    x /= determinant;
    return true;
  }

 private:
  Matrix M_;
};

inline Problem linear(const Matrix& M, const Vector& start, const Vector& target, Real weight = 1) {
  return Problem({.physics = std::make_unique<Linear>(M),
                  .start = start,
                  .target = target,
                  .loss = std::make_unique<HalfSquared>(weight),
                  .minimum = 0});
}

// cond 2.6: a convex quadratic on which every method must arrive.
inline Matrix easy_matrix() { return Eigen::Matrix2d{{2, 1}, {0, 1}}; }
inline Problem easy() {
  return linear(easy_matrix(), Eigen::Vector2d(1, 2), Eigen::Vector2d(0.5, -0.3));
}

// y = x², one sample at a time, invertible for y ≥ 0 alone.
class Squares final : public DensePhysics {
 public:
  Squares() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = x[0] * x[0]; }
  void derivative(VectorRef x, BatchOut J) const override { J(0, 0) = 2 * x[0]; }
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef x0, VectorOut x) const override {
    x[0] = std::copysign(std::sqrt(y[0]), x0[0]);
    return y[0] >= 0;
  }
};

// x² = 4 from so near 0, where the slope vanishes, that the first steps overshoot by far.
inline Problem far_root() {
  return Problem({.physics = std::make_unique<Squares>(),
                  .start = Vector::Constant(1, 1e-3),
                  .target = Matrix::Constant(1, 1, 4),
                  .minimum = 0});
}

// x = θ₀ + θ₁ · input, one sample a column.
class Line final : public Network {
 public:
  Index parameters() const override { return 2; }
  Index inputs() const override { return 1; }
  Index outputs() const override { return 1; }
  Vector start(RandomStream&) const override { return Eigen::Vector2d(1, 0); }
  std::vector<Block> layout() const override { return {{0, 2, 1, Block::Kind::weight}}; }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    w.x = in;
    x = (theta[0] + theta[1] * in.array()).matrix();
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    Jv = (v[0] + v[1] * w.x.array()).matrix();
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    JTu << u.sum(), u.cwiseProduct(w.x).sum();
  }
};

// Learns x = 2 + input from the squares of x. A last target below zero is out of the physics'
// reach.
inline Problem learned_line(bool with_impossible_sample = false) {
  Matrix input(1, 4), target(1, 4);
  input << -1, -0.5, 0.5, 1;
  target = (2 + input.array()).square().matrix();
  if (with_impossible_sample) target(0, 3) = -1;
  return Problem({.physics = std::make_unique<Squares>(),
                  .start = Eigen::Vector2d(1, 0),
                  .target = target,
                  .network = std::make_unique<Line>(),
                  .input = input,
                  .minimum = 0});
}

// x = W in + b, the least network of one dense layer.
class Affine final : public Network {
 public:
  Affine(Index inputs, Index outputs) : inputs_(inputs), outputs_(outputs) {}
  Index parameters() const override { return outputs_ * (inputs_ + 1); }
  Index inputs() const override { return inputs_; }
  Index outputs() const override { return outputs_; }
  Vector start(RandomStream& stream) const override { return stream.normal_vector(parameters()); }
  std::vector<Block> layout() const override {
    return {{0, outputs_, inputs_, Block::Kind::weight},
            {outputs_ * inputs_, outputs_, 1, Block::Kind::bias}};
  }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    w.x = in;
    pushforward(theta, x, w);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    Jv.noalias() = Eigen::Map<const Matrix>(v.data(), outputs_, inputs_) * w.x;
    Jv.colwise() += v.tail(outputs_);
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    Eigen::Map<Matrix>(JTu.data(), outputs_, inputs_).noalias() = u * w.x.transpose();
    JTu.tail(outputs_) = u.rowwise().sum();
  }
  bool has_curvature() const override { return true; }
  void curvature(VectorRef, BatchRef, BatchRef du, VectorOut out, Workspace& w) const override {
    pullback(du, out, w);
  }
  bool has_layer_factors() const override { return true; }
  void layer_factors(BatchRef u, std::vector<LayerFactor>& out, Workspace& w) const override {
    out.resize(1);
    out[0].weight = 0;
    out[0].bias = 1;
    out[0].inputs = w.x;
    out[0].cotangents = u;
  }

 private:
  Index inputs_, outputs_;
};

// Numbers that act one by one, laid out as these blocks, and no layer besides; x starts at 1.
class Separate final : public Network {
 public:
  explicit Separate(std::vector<Block> layout) : layout_(std::move(layout)) {}
  Index parameters() const override { return 4; }
  Index inputs() const override { return 0; }
  Index outputs() const override { return 4; }
  Vector start(RandomStream&) const override { return Vector::Ones(4); }
  std::vector<Block> layout() const override { return layout_; }
  void forward(VectorRef theta, BatchRef, BatchOut x, Workspace&) const override {
    x.col(0) = theta;
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace&) const override { Jv.col(0) = v; }
  void pullback(BatchRef u, VectorOut JTu, Workspace&) const override { JTu = u.col(0); }
  bool has_curvature() const override { return true; }
  void curvature(VectorRef, BatchRef, BatchRef du, VectorOut out, Workspace&) const override {
    out = du.col(0);
  }
  bool has_layer_moments() const override { return true; }
  void layer_moments(BatchRef u, std::vector<networks::LayerMoments>& out, VectorOut JTu,
                     Workspace&) const override {
    out.clear();
    JTu = u.col(0);
  }

 private:
  std::vector<Block> layout_;
};

// Of which the curvatures, like the gradient, are 1, 4, 9, 16.
inline Problem separate(const std::vector<Block>& layout) {
  const Matrix M = Eigen::Vector4d(1, 2, 3, 4).asDiagonal();
  return Problem({.physics = std::make_unique<Linear>(M),
                  .start = Vector::Ones(4),
                  .target = Matrix::Zero(4, 1),
                  .network = std::make_unique<Separate>(layout),
                  .input = Matrix(0, 1),
                  .minimum = 0});
}

// Learns x = (1 + in₀, 2 − in₁) for y = M x; `data` 0: fresh samples at each step.
inline Problem learned_affine(Index batch, Index data = 0) {
  auto network = std::make_unique<Affine>(2, 2);
  RandomStream start(1, "trial", "start");
  const auto draw = [](RandomStream& stream, Index b, Batch& to) {
    to.input.col(b) << stream.uniform(-1, 1), stream.uniform(-1, 1);
    to.truth.col(b) << 1 + to.input(0, b), 2 - to.input(1, b);
    to.target.col(b) = easy_matrix() * to.truth.col(b);
  };
  const auto stream = [](std::string_view purpose) { return RandomStream(1, "trial", purpose); };
  Vector theta = network->start(start);
  return Problem({.physics = std::make_unique<Linear>(easy_matrix()),
                  .start = std::move(theta),
                  .network = std::move(network),
                  .minimum = 0,
                  .x_error = [](BatchRef x, const Batch& to) { return (x - to.truth).norm(); },
                  .samples = {.batch = batch, .data = data, .stream = stream, .draw = draw}});
}

}  // namespace isoline::optimizers
