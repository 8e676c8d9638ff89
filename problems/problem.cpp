// The inverse problem: network, physics and loss chained, forward and back.
#include "problems/problem.h"

#include <algorithm>
#include <cmath>

#include "networks/identity.h"

namespace isoline {

Problem::Problem(ProblemParts parts) : parts_(std::move(parts)) {
  if (!parts_.network) parts_.network = std::make_unique<Identity>(parts_.start);
  if (!parts_.loss) parts_.loss = std::make_unique<HalfSquared>();
  require(parts_.target.rows() == outputs(), "the target does not fit the physics' outputs");
  require(parts_.network->outputs() == inputs(), "the network does not fit the physics' inputs");
  require(parts_.network->parameters() == unknowns(), "the start does not fit the network");
}

Real Problem::x_error(BatchRef x) const {
  return parts_.x_error ? parts_.x_error(x) : std::nan("");
}

OracleSet Problem::offers() const {
  OracleSet offered{Oracle::forward, Oracle::pullback, Oracle::pushforward, Oracle::jacobian,
                    Oracle::network};
  if (parts_.physics->has_curvature()) {
    offered.add(Oracle::curvature);
    if (has_identity_network()) offered.add(Oracle::hessian);
  }
  if (inverse_kind() != Inverse::none) offered.add(Oracle::inverse);
  if (parts_.truth) offered.add(Oracle::truth);
  return offered;
}

std::array<std::int64_t, kOracles> Problem::prices() const {
  std::array<std::int64_t, kOracles> price{};
  const auto set = [&](Oracle oracle, std::int64_t value) {
    price[static_cast<std::size_t>(oracle)] = value;
  };
  set(Oracle::forward, 1);
  set(Oracle::pullback, 1);
  set(Oracle::pushforward, 1);
  set(Oracle::jacobian, std::min(unknowns(), residuals()));
  set(Oracle::hessian, unknowns());
  set(Oracle::curvature, inputs());
  set(Oracle::inverse, parts_.physics->inverse_price());
  set(Oracle::network, has_identity_network() ? 0 : 1);
  return price;
}

void Problem::forward(VectorRef theta, Point& at) const {
  at.theta = theta;
  at.physics.x.resize(inputs(), samples());
  at.y.resize(outputs(), samples());
  at.physics.context = parts_.context;
  at.physics.saved_is_current = at.network.saved_is_current = false;
  parts_.network->forward(theta, parts_.input, at.physics.x, at.network);
  parts_.physics->forward(at.x(), parts_.context, at.y, at.physics);
  at.loss = parts_.loss->value(at.y, parts_.target);
}

Real Problem::physics_misfit(BatchRef y, BatchRef x, Point& scratch, BatchOut gradient) const {
  scratch.physics.x = x;
  scratch.physics.context = parts_.context;
  scratch.physics.saved_is_current = false;
  scratch.y.resize(y.rows(), y.cols());
  parts_.physics->forward(scratch.physics.x, parts_.context, scratch.y, scratch.physics);
  scratch.y -= y;
  parts_.physics->pullback(scratch.y, gradient, scratch.physics);
  return 0.5 * scratch.y.squaredNorm();
}

Real Problem::loss_of(BatchRef y) const { return parts_.loss->value(y, parts_.target); }

void Problem::cotangent(const Point& at, BatchOut g) const {
  parts_.loss->cotangent(at.y, parts_.target, g);
}

void Problem::loss_curvature(const Point& at, BatchRef dy, BatchOut dg) const {
  parts_.loss->curvature(at.y, parts_.target, dy, dg);
}

void Problem::residual(const Point& at, VectorOut r) const {
  r = (at.y - parts_.target).reshaped() / std::sqrt(static_cast<Real>(samples()));
}

void Problem::pullback(BatchRef w, VectorOut out, Point& at) const {
  at.scratch_x.resize(inputs(), samples());
  parts_.physics->pullback(w, at.scratch_x, at.physics);
  parts_.network->pullback(at.scratch_x, out, at.network);
}

void Problem::pushforward(VectorRef v, BatchOut out, Point& at) const {
  at.scratch_x.resize(inputs(), samples());
  parts_.network->pushforward(v, at.scratch_x, at.network);
  parts_.physics->pushforward(at.scratch_x, out, at.physics);
}

void Problem::network_pullback(BatchRef w, VectorOut out, Point& at) const {
  parts_.network->pullback(w, out, at.network);
}

void Problem::jacobian(Matrix& J, Point& at) const {
  require(has_identity_network(), "the dense Jacobian of a network is not available");
  J.resize(residuals(), unknowns());
  parts_.physics->jacobian(J, at.physics);
}

// ∇²L = Jᵀ (∂²L/∂y²) J + Σᵢ gᵢ ∇²Pᵢ
void Problem::hessian(Matrix& H, Point& at) const {
  require(has_identity_network(), "the dense Hessian of a network is not available");
  const Index n = unknowns();
  Matrix J, g(outputs(), samples());
  jacobian(J, at);
  cotangent(at, g);
  H.resize(n, n);
  parts_.physics->curvature(g, H, at.physics);
  Matrix weighted(residuals(), n);  // (∂²L/∂y²) J
  for (Index j = 0; j < n; ++j)
    parts_.loss->curvature(at.y, parts_.target, J.col(j), weighted.col(j));
  H.noalias() += J.transpose() * weighted;
}

void Problem::curvature(BatchRef w, BatchOut out, Point& at) const {
  parts_.physics->curvature(w, out, at.physics);
}

Success Problem::local_inverse(BatchRef y, BatchOut x, Point& at) const {
  return parts_.physics->local_inverse(y, at.x(), parts_.context, x);
}

Vector Draw::start(const Vector& standard) const {
  if (is_published()) return standard;
  RandomStream noise = stream("start");
  return standard.array() +
         0.1 * standard.array().abs().max(1) * noise.normal_vector(standard.size()).array();
}

}  // namespace isoline
