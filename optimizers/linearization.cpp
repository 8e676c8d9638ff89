// One forward pass and what is asked of it, each question charged to the meter.
#include "optimizers/meter.h"

namespace isoline::optimizers {

void Linearization::cotangent(Matrix& g) const {
  g.resize(point_.y.rows(), point_.y.cols());
  meter_->problem_.cotangent(point_, g);
}

void Linearization::residual(Vector& r) const {
  r.resize(point_.y.size());
  meter_->problem_.residual(point_, r);
}

void Linearization::gradient(Vector& out) {
  cotangent(g_);
  out.resize(meter_->unknowns());
  pullback(g_, out);
}

void Linearization::pullback(BatchRef w, VectorOut out) {
  meter_->charge(Oracle::pullback);
  meter_->problem_.pullback(w, out, point_);
}

void Linearization::physics_pullback(BatchRef w, BatchOut out) {
  meter_->charge(Oracle::pullback);
  meter_->problem_.physics_pullback(w, out, point_);
}

void Linearization::pushforward(VectorRef v, BatchOut out) {
  meter_->charge(Oracle::pushforward);
  meter_->problem_.pushforward(v, out, point_);
}

const Matrix& Linearization::jacobian() {
  if (has_jacobian_) return J_;
  meter_->charge(Oracle::jacobian);
  meter_->problem_.jacobian(J_, point_);
  has_jacobian_ = true;
  return J_;
}

const Matrix& Linearization::sensitivity() {
  meter_->charge(Oracle::sensitivity);
  meter_->problem_.sensitivity(dy_dx_, point_);
  return dy_dx_;
}

void Linearization::hessian_product(VectorRef v, VectorOut out) {
  meter_->charge(Oracle::hessian_product);
  meter_->problem_.hessian_product(v, out, point_);
}

void Linearization::loss_curvature(BatchRef dy, BatchOut dg) const {
  meter_->problem_.loss_curvature(point_, dy, dg);
}

const Matrix& Linearization::hessian() {
  if (has_hessian_) return H_;
  meter_->charge(Oracle::hessian);
  meter_->problem_.hessian(H_, point_);
  has_hessian_ = true;
  return H_;
}

void Linearization::curvature(BatchRef w, BatchOut out) {
  meter_->charge(Oracle::curvature);
  meter_->problem_.curvature(w, out, point_);
}

Success Linearization::local_inverse(BatchRef y, BatchOut x) {
  meter_->charge(Oracle::inverse);
  return meter_->problem_.local_inverse(y, x, point_);
}

void Linearization::layer_factors(BatchRef w, std::vector<LayerFactor>& out) {
  meter_->charge(Oracle::layer_factors);
  meter_->problem_.layer_factors(w, out, point_);
}

void Linearization::layer_moments(BatchRef w, std::vector<LayerMoments>& out, VectorOut JTw) {
  meter_->charge(Oracle::layer_moments);
  meter_->problem_.layer_moments(w, out, JTw, point_);
}

void Linearization::network_pullback(BatchRef w, VectorOut out) {
  meter_->charge(Oracle::network);
  meter_->problem_.network_pullback(w, out, point_);
}

}  // namespace isoline::optimizers
