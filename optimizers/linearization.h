// A point that was evaluated, and the products of its derivatives.
#pragma once

#include <vector>

#include "core/array.h"
#include "core/oracle.h"
#include "problems/problem.h"

namespace isoline::optimizers {

using networks::Block;
using networks::LayerFactor;
using networks::LayerMoments;
using problems::Batch;
using problems::Bounds;
using problems::Point;
using problems::Problem;

class Meter;

// One forward pass and its products, which never repeat it. Owned and reused by the method.
class Linearization {
 public:
  const Matrix& x() const { return point_.x(); }  // (k, B)
  const Matrix& y() const { return point_.y; }    // (m, B)
  Real loss() const { return point_.loss; }
  void set_jacobian(const Matrix& J) {  // the method's own approximation of it
    J_ = J;
    has_jacobian_ = true;
  }

  void cotangent(Matrix& g) const {  // g = ∂L/∂y, (m, B)
    g.resize(point_.y.rows(), point_.y.cols());
    problem_->cotangent(point_, g);
  }
  void residual(Vector& r) const {  // r = (y − y*)/√B, (m·B)
    r.resize(point_.y.size());
    problem_->residual(point_, r);
  }
  void loss_curvature(BatchRef dy, BatchOut dg) const {  // (∂²L/∂y²) dy, (m, B)
    problem_->loss_curvature(point_, dy, dg);
  }
  void gradient(Vector& out);  // Jᵀ g, (n)
  void pullback(BatchRef w, VectorOut out) { ask(Oracle::pullback).pullback(w, out, point_); }
  // Through the physics alone, (m, B) -> (k, B).
  void physics_pullback(BatchRef w, BatchOut out) {
    ask(Oracle::pullback).physics_pullback(w, out, point_);
  }
  void pushforward(VectorRef v, BatchOut out) {
    ask(Oracle::pushforward).pushforward(v, out, point_);
  }
  // (m·B, n) and ∇²L (n, n), each computed once a point.
  const Matrix& jacobian() { return once(Oracle::jacobian, has_jacobian_, J_); }
  const Matrix& hessian() { return once(Oracle::hessian, has_hessian_, H_); }
  const Vector& sparse_jacobian() {  // the values by Meter::sparse_pattern(), once a point
    if (!has_sparse_) ask(Oracle::sparse_jacobian).sparse_jacobian(sparse_, point_);
    has_sparse_ = true;
    return sparse_;
  }
  const Matrix& sensitivity() {  // ∂y/∂x of each sample side by side, (m, k·B)
    ask(Oracle::sensitivity).sensitivity(dy_dx_, point_);
    return dy_dx_;
  }
  void hessian_product(VectorRef v, VectorOut out) {  // ∇²L v, (n)
    ask(Oracle::hessian_product).hessian_product(v, out, point_);
  }
  void curvature(BatchRef w, BatchOut out) { ask(Oracle::curvature).curvature(w, out, point_); }
  Success local_inverse(BatchRef y, BatchOut x) {
    return ask(Oracle::inverse).local_inverse(y, x, point_);
  }
  void network_pullback(BatchRef w, VectorOut out) {
    ask(Oracle::network).network_pullback(w, out, point_);
  }
  // Under the cotangent w, (m, B).
  void layer_factors(BatchRef w, std::vector<LayerFactor>& out) {
    ask(Oracle::layer_factors).layer_factors(w, out, point_);
  }
  void layer_moments(BatchRef w, std::vector<LayerMoments>& out, VectorOut JTw) {
    ask(Oracle::layer_moments).layer_moments(w, out, JTw, point_);
  }

 private:
  friend class Meter;
  const Problem& ask(Oracle oracle);  // charges for it
  const Matrix& once(Oracle oracle, bool& is_there, Matrix& out);

  Meter* meter_ = nullptr;
  const Problem* problem_ = nullptr;
  Point point_;
  Matrix g_, J_, H_, dy_dx_;
  Vector sparse_;
  bool has_jacobian_ = false, has_hessian_ = false, has_sparse_ = false;
};

}  // namespace isoline::optimizers
