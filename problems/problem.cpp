// The inverse problem: network, physics and loss chained, forward and back.
#include "problems/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/product.h"
#include "networks/network.h"
#include "problems/model.h"

namespace isoline::problems {

using networks::Identity;

void Jitter::disturb(std::uint64_t call, BatchRef target, BatchOut y) const {
  RandomStream z = stream.of_sample(call);
  for (Index b = 0; b < y.cols(); ++b)
    y.col(b).array() +=
        sigma * z.normal_vector(y.rows()).array() * (y.col(b) - target.col(b)).array();
}

void Refinement::see(Real validation_loss, State& state) const {
  constexpr Real kFading = 2. / 9, kPlateau = 0.98, kHelped = 0.9;
  constexpr int kFewest = 4;  // epochs
  Real(&means)[3] = state.means;
  means[2] = means[1];
  means[1] = means[0];
  means[0] += (state.epochs == 0 ? 1 : kFading) * (validation_loss - means[0]);
  if (++state.epochs < kFewest || !(means[0] > kPlateau * means[2])) return;
  if (kHelped * state.level <= means[0] && means[0] <= state.level) return;
  state.level = means[0];
  state.iterations = std::min(state.iterations + step, most);
}

Problem::Problem(ProblemParts parts) : parts_(std::move(parts)) {
  if (const auto& bounds = parts_.bounds) {
    require(!parts_.network && bounds->lower.size() == parts_.start.drawn.size() &&
                bounds->upper.size() == parts_.start.drawn.size(),
            "bounds must be those of all unknowns of a direct problem");
    for (Index i = 0; i < bounds->lower.size(); ++i)
      require(bounds->lower[i] <= bounds->upper[i], [&] {
        return fmt::format("the lower bound {} of x{} is above its upper bound {}",
                           bounds->lower[i], i + 1, bounds->upper[i]);
      });
    for (Vector* start : {&parts_.start.drawn, &parts_.start.standard})
      *start = bounds->nearest(*start);
  }
  if (parts_.truth && !parts_.x_error)  // the solution is the x* that made y*, and no other
    parts_.x_error = [truth = Vector(parts_.truth->reshaped())](BatchRef x, const Batch&) {
      return (x - truth).norm();
    };
  if (!parts_.network) parts_.network = std::make_unique<Identity>(parts_.start.drawn);
  if (!parts_.loss) parts_.loss = std::make_unique<HalfSquared>();
  if (is_learned())
    draw_batch(0, batch_);
  else
    batch_ = {std::move(parts_.input), std::move(parts_.context), std::move(parts_.target),
              parts_.truth.value_or(Matrix())};
  require(batch_.target.rows() == outputs(), "the target does not fit the physics' outputs");
  require(parts_.network->outputs() == inputs(), "the network does not fit the physics' inputs");
  require(parts_.network->parameters() == unknowns(), "the start does not fit the network");
  if (const SparsePattern* pattern = sparse_pattern())
    require(pattern->defect(outputs(), inputs()).empty(), [&] {
      return "the pattern of the sparse Jacobian is wrong: " + pattern->defect(outputs(), inputs());
    });
  if (!parts_.field) return;
  const Field& field = *parts_.field;
  const Index cells = field.is_history() ? field.columns : field.rows * field.columns;
  // A field of two numbers per cell, a velocity, is shown by its curl.
  const bool has_curl = !field.is_history() && inputs() == 2 * cells;
  require((inputs() == cells || has_curl) && outputs() == cells,
          "x and y do not fit the grid of the field");
  require(field.is_history() == bool(parts_.history) && (!field.is_history() || field.rows > 1),
          "a field over time needs its history, of two rows at least, and no other field has one");
}

ProblemParts Problem::parts() && {
  if (has_identity_network()) parts_.network.reset();  // it knows the start
  if (!is_learned()) {
    parts_.input = std::move(batch_.input);
    parts_.context = std::move(batch_.context);
    parts_.target = std::move(batch_.target);
  }
  return std::move(parts_);
}

void Problem::set_start(Vector start) {
  require(!bounds() || bounds()->hold(start), "the start lies outside the bounds of the problem");
  parts_.start.drawn = std::move(start);
}

void Problem::set_target(const Matrix& target) {
  batch_.target = target;
  batch_.truth.resize(0, 0);
  parts_.aim = Aim::loss;
  parts_.minimum = parts_.scale = parts_.x_scale = std::nullopt;
  parts_.minimum_error = 0;
  parts_.truth.reset();
  parts_.made_from.reset();
  parts_.noise_level.reset();
  parts_.x_error = nullptr;
  parts_.x_floor = nullptr;
}

// L at y = 0 if there is a signal y*, otherwise at the standard start; f_L itself if it is more
// than rounding compared with that.
Real Problem::loss_scale(const Batch& batch) const {
  constexpr Real kRounding = std::numeric_limits<Real>::epsilon();
  if (parts_.scale) return *parts_.scale;
  // The best known loss of a learning problem is not a residual of its data, and changes when
  // renewed.
  const Real least = is_learned() ? 0 : parts_.minimum.value_or(0);
  const bool has_signal = !batch.target.isZero(0);
  if (has_signal) {
    const Real silent = parts_.loss->value(Matrix::Zero(outputs(), batch.samples()), batch.target);
    return least > kRounding * silent ? least : silent;
  }
  Point at;
  forward(standard_start(), batch, at);
  return least > kRounding * at.loss ? least : at.loss - least;
}

// ‖x*‖, as the distance of x = 0 from the nearest solution; where 0 is one, that of the standard
// start.
Vector Problem::in_own_units(VectorRef theta) const {
  const OwnUnits& own = parts_.own_units;
  if (model() != nullptr) return point_of_model(physics(), theta);
  if (own.scales.size() == 0) return theta;
  const Vector x = theta.cwiseProduct(own.scales);
  return own.bounds ? own.bounds->nearest(x) : x;
}

Real Problem::x_scale(const Batch& batch) const {
  if (parts_.x_scale) return *parts_.x_scale;
  const Real of_nothing = x_error(Matrix::Zero(inputs(), batch.samples()), batch);
  if (of_nothing != 0) return of_nothing;
  Point at;
  forward(standard_start(), batch, at);
  return x_error(at.x(), batch);
}

void Problem::draw_batch(std::int64_t step, Batch& out) const {
  const Samples& samples = parts_.samples;
  const Index count = samples.data > 0 ? samples.data : samples.batch;
  std::int64_t first = samples.data > 0 ? 0 : step * count;
  if (samples.epoch > 0) first %= samples.epoch;
  draw("training", static_cast<std::uint64_t>(first), count, out);
  if (const Refinement* refined = refinement())
    out.context.setConstant(static_cast<Real>(refined->first));
}

const Refinement* Problem::refinement() const {
  const auto* refined = dynamic_cast<const RefinedPhysics*>(parts_.physics.get());
  return refined ? &refined->refinement() : nullptr;
}

Index Problem::solve_iterations(const Batch& batch) const {
  return refinement() ? std::max<Index>(1, std::lround(batch.context(0, 0))) : 1;
}

void Problem::draw(std::string_view purpose, std::uint64_t first, Index count, Batch& out) const {
  const Samples& samples = parts_.samples;
  out.resize(parts_.network->inputs(), samples.contexts, outputs(),
             samples.has_truth ? inputs() : 0, count);
  const RandomStream streams = samples.stream(purpose);
  for (Index b = 0; b < count; ++b) {
    RandomStream stream = streams.of_sample(first + static_cast<std::uint64_t>(b));
    samples.draw(stream, b, out);
  }
}

OracleSet Problem::offers() const {
  OracleSet offered{Oracle::forward, Oracle::network};
  const Products has = products();
  if (has.has_pullback) offered.add(Oracle::pullback);
  if (has.has_pushforward) offered.add(Oracle::pushforward);
  // A dense matrix must need at most a few products per sample: the Jacobian of a grid costs as
  // many solves as the grid has cells.
  constexpr Index kMostProducts = 64;
  const bool is_small = has_identity_network() || std::min(inputs(), outputs()) <= kMostProducts;
  if (is_small && is_dense_feasible(Oracle::jacobian) &&
      (has.has_pullback || has.has_pushforward)) {
    offered.add(Oracle::jacobian);
    offered.add(Oracle::sensitivity);
  }
  if (sparse_pattern()) offered.add(Oracle::sparse_jacobian);
  if (parts_.physics->has_curvature()) {
    if ((has_identity_network() || inputs() <= kMostProducts) &&
        is_dense_feasible(Oracle::curvature))
      offered.add(Oracle::curvature);
    if (has_identity_network() && is_dense_feasible(Oracle::hessian)) offered.add(Oracle::hessian);
    if (parts_.network->has_curvature()) offered.add(Oracle::hessian_product);
  }
  if (parts_.network->has_layer_factors()) offered.add(Oracle::layer_factors);
  if (parts_.network->has_layer_moments()) offered.add(Oracle::layer_moments);
  if (inverse_kind() != Inverse::none) offered.add(Oracle::inverse);
  if (batch_.truth.size() > 0) offered.add(Oracle::truth);
  return offered;
}

std::array<Index, 2> Problem::dense_shape(Oracle oracle) const {
  switch (oracle) {
    case Oracle::jacobian:
      return {residuals(), unknowns()};
    case Oracle::sensitivity:
      return {outputs(), inputs() * samples()};
    case Oracle::hessian:
      return {unknowns(), unknowns()};
    case Oracle::curvature:
      return {inputs(), inputs() * samples()};
    default:
      return {0, 0};
  }
}

bool Problem::is_dense_feasible(Oracle oracle) const {
  constexpr Real kMostEntries = 1 << 27;
  const auto [rows, columns] = dense_shape(oracle);
  return static_cast<Real>(rows) * static_cast<Real>(columns) <= kMostEntries;
}

OracleCounts Problem::prices() const {
  const OracleSizes sizes{.unknowns = unknowns(),
                          .residuals = residuals(),
                          .inputs = inputs(),
                          .outputs = outputs(),
                          .pushforward_price = products().pushforward_price,
                          .pullback_price = products().pullback_price,
                          .has_pushforward = products().has_pushforward,
                          .has_pullback = products().has_pullback,
                          .widest_row = sparse_pattern() ? sparse_pattern()->widest_row() : 0,
                          .inverse_price = parts_.physics->inverse_price(),
                          .has_network = !has_identity_network()};
  OracleCounts prices{};
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    prices[kind] = kOracleTable[kind].price(sizes);
  return prices;
}

void Problem::forward(VectorRef theta, const Batch& batch, Point& at) const {
  at.physics.x.resize(inputs(), batch.samples());
  at.network.saved_is_current = false;
  parts_.network->forward(theta, batch.input, at.physics.x, at.network);
  evaluate_physics(batch, at);
}

void Problem::physics_forward(BatchRef x, const Batch& batch, Point& at) const {
  at.physics.x = x;
  evaluate_physics(batch, at);
}

void Problem::evaluate_physics(const Batch& batch, Point& at) const {
  at.batch = &batch;
  at.y.resize(outputs(), batch.samples());
  at.physics.context = batch.context;
  at.physics.saved_is_current = false;
  parts_.physics->forward(at.x(), batch.context, at.y, at.physics);
  at.loss = parts_.loss->value(at.y, batch.target);
}

// Where the network is the identity nothing lies between x and θ, not even a copy: on large grids
// each costs a twentieth of a transform.
void Problem::pullback(BatchRef w, VectorOut out, Point& at) const {
  if (has_identity_network())
    return parts_.physics->pullback(w, Eigen::Map<Matrix>(out.data(), out.size(), 1), at.physics);
  parts_.network->pullback(pulled_to_x(w, at), out, at.network);
}

const Matrix& Problem::pulled_to_x(BatchRef w, Point& at) const {
  at.scratch_x.resize(inputs(), w.cols());
  parts_.physics->pullback(w, at.scratch_x, at.physics);
  return at.scratch_x;
}

void Problem::pushforward(VectorRef v, BatchOut out, Point& at) const {
  if (has_identity_network())
    return parts_.physics->pushforward(Eigen::Map<const Matrix>(v.data(), v.size(), 1), out,
                                       at.physics);
  at.scratch_x.resize(inputs(), out.cols());
  parts_.network->pushforward(v, at.scratch_x, at.network);
  parts_.physics->pushforward(at.scratch_x, out, at.physics);
}

void Problem::jacobian(Matrix& J, Point& at) const {
  J.resize(at.y.size(), unknowns());
  if (has_identity_network()) return parts_.physics->jacobian(J, at.physics);
  sensitivity(at.dy_dx, at);
  parts_.network->jacobian(at.dy_dx, J, at.network);
}

// With x' = N'v and y' = P'x':  ∇²L v = (d/dε) N'ᵀ u,  u = P'ᵀ g,  u' = P'ᵀ L''y' + Σ gᵢ ∇²Pᵢ x'.
void Problem::hessian_product(VectorRef v, VectorOut out, Point& at) const {
  const Index samples = at.y.cols();
  for (Matrix* x : {&at.dx, &at.du, &at.bent, &at.scratch_x}) x->resize(inputs(), samples);
  for (Matrix* y : {&at.dy, &at.dg}) y->resize(outputs(), samples);
  parts_.network->pushforward(v, at.dx, at.network);
  parts_.physics->pushforward(at.dx, at.dy, at.physics);
  loss_curvature(at, at.dy, at.dg);
  parts_.physics->pullback(at.dg, at.du, at.physics);
  cotangent(at, at.dg);
  parts_.physics->pullback(at.dg, at.scratch_x, at.physics);
  parts_.physics->curvature_product(at.dg, at.dx, at.bent, at.physics);
  at.du += at.bent;
  parts_.network->curvature(v, at.scratch_x, at.du, out, at.network);
}

// ∇²L = Jᵀ (∂²L/∂y²) J + Σᵢ gᵢ ∇²Pᵢ
void Problem::hessian(Matrix& H, Point& at) const {
  require(has_identity_network(), "the dense Hessian of a network is not available");
  const Index n = unknowns();
  jacobian(at.J, at);
  at.dg.resize(outputs(), samples());
  cotangent(at, at.dg);
  H.resize(n, n);
  parts_.physics->curvature(at.dg, H, at.physics);
  at.weighted.resize(residuals(), n);
  for (Index j = 0; j < n; ++j)
    parts_.loss->curvature(at.y, at.batch->target, at.J.col(j), at.weighted.col(j));
  product(Form::AH_B, at.J, at.weighted, H, 1);
}

Vector near(const Vector& standard, StartScale scale, RandomStream& noise) {
  const Real least = scale == StartScale::at_least_one ? 1 : 0;
  return standard.array() +
         0.1 * standard.array().abs().max(least) * noise.normal_vector(standard.size()).array();
}

Start Draw::start(const Vector& standard, StartScale scale) const {
  if (start_ == 0) return standard;
  RandomStream noise = start_stream("start");
  return {near(standard, scale, noise), standard};
}

}  // namespace isoline::problems
