// What every network must satisfy, measured at a random input and cotangent around its start.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "networks/network.h"

namespace isoline::networks {

class NetworkExamination {
 public:
  NetworkExamination(const Network& network, Index samples, RandomStream& stream)
      : network_(network), stream_(stream), samples_(samples), theta_(network.start(stream)) {
    // Nothing stays at its start: a bias of zero would hide a missing term.
    theta_ += 0.1 * direction();
    in_ = normal(network.inputs());
    x_.resize(network.outputs(), samples);
    network.forward(theta_, in_, x_, w_);
  }

  const Vector& theta() const { return theta_; }
  const Matrix& in() const { return in_; }
  const Matrix& x() const { return x_; }

  // Each number as large as its parameter, or a tenth of the root mean square where that is zero:
  // a step of h changes small and large blocks alike by about the fraction h.
  Vector direction() {
    const Vector v = stream_.normal_vector(network_.parameters());
    const Real floor = 0.1 * theta_.norm() / std::sqrt(Real(v.size()));
    return v.array() * theta_.array().abs().max(floor);
  }
  Matrix normal(Index rows) {
    return stream_.normal_vector(rows * samples_).reshaped(rows, samples_);
  }
  Matrix cotangent() { return normal(network_.outputs()); }

  Matrix push(VectorRef v) {
    Matrix Jv(x_.rows(), samples_);
    network_.pushforward(v, Jv, w_);
    return Jv;
  }
  Vector pull(BatchRef u) { return pull(u, w_); }
  Vector curvature(VectorRef v, BatchRef u, BatchRef du) {
    Vector out(network_.parameters());
    push(v);
    network_.curvature(v, u, du, out, w_);
    return out;
  }
  Matrix jacobian(BatchRef dy_dx) {
    Matrix J(dy_dx.rows() * samples_, network_.parameters());
    network_.jacobian(dy_dx, J, w_);
    return J;
  }
  std::vector<LayerFactor> factors(BatchRef u) {
    std::vector<LayerFactor> all;
    network_.layer_factors(u, all, w_);
    return all;
  }

  Matrix forward_at(VectorRef theta, BatchRef in) const {
    Workspace w;
    return forward_at(theta, in, w);
  }
  Vector pull_at(VectorRef theta, BatchRef u) const {
    Workspace w;
    forward_at(theta, in_, w);
    return pull(u, w);
  }

  // The gap between `derivative(v)` and central differences of `value(h, v)`, relative to the
  // larger. Where steps may cross a kink, the direction of many along which differences over h and
  // h/2 agree best: they do not where one was crossed.
  template <class Value, class Derivative>
  Real gap(Value value, Derivative derivative) {
    constexpr int kDirections = 30;
    Real best = std::numeric_limits<Real>::infinity(), result = 1;
    for (int i = 0; i < (network_.has_kinks() ? kDirections : 1); ++i) {
      const Vector v = direction();
      const auto difference = [&](Real h) -> Matrix {
        return (value(h, v) - value(-h, v)) / (2 * h);
      };
      const Matrix wide = difference(step()), narrow = difference(step() / 2);
      const Real disagreement = (wide - narrow).norm() / narrow.norm();
      if (disagreement >= best) continue;
      best = disagreement;
      const Matrix exact = derivative(v);
      result = (narrow - exact).norm() / std::max(narrow.norm(), exact.norm());
    }
    return result;
  }

  // ε^⅓ leaves truncation of h² and rounding of ε/h, amplified by the depth. In a large network
  // some of its kinks, a part of the order of h, are crossed by every step.
  Real step() const { return network_.is_single_precision() ? 4e-3 : 6e-6; }
  Real difference_limit() const {
    if (!network_.is_single_precision()) return 1e-7;
    return network_.has_kinks() ? 1e-2 : 1e-3;
  }
  // A few roundings of the type, with room for cancellation.
  Real rounding() const { return network_.is_single_precision() ? 1e-5 : 1e-12; }

 private:
  Matrix forward_at(VectorRef theta, BatchRef in, Workspace& w) const {
    Matrix x(network_.outputs(), in.cols());
    network_.forward(theta, in, x, w);
    return x;
  }
  Vector pull(BatchRef u, Workspace& w) const {
    Vector JTu(network_.parameters());
    network_.pullback(u, JTu, w);
    return JTu;
  }

  const Network& network_;
  RandomStream& stream_;
  Index samples_;
  Vector theta_;
  Matrix in_, x_;
  Workspace w_;  // of the forward pass at theta_
};

}  // namespace isoline::networks
