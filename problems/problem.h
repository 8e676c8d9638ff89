// The inverse problem: θ ──network──▶ x ──physics──▶ y ──loss──▶ L, with the target y*. A direct
// problem is one with the identity network. Const: what depends on θ lives in a Point.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>

#include "core/differences.h"
#include "core/field.h"
#include "core/frames.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/random.h"
#include "core/seeds.h"
#include "core/status.h"
#include "networks/network.h"
#include "problems/physics.h"
#include "problems/problem_entry.h"

namespace isoline::problems {

using networks::Block;
using networks::LayerFactor;
using networks::LayerMoments;
using networks::Network;
using networks::NetworkShape;

// The forward pass at θ and what its products need. Owned by the caller and reused.
struct Point {
  const Batch* batch = nullptr;  // the samples it was evaluated on; outlives the point
  Matrix y;                      // (m, B)
  Real loss = 0;
  Workspace physics, network;
  Matrix scratch_x;             // (k, B)
  Matrix dx, dy, dg, du, bent;  // of Hessian products: (k, B), (m, B), (m, B), (k, B), (k, B)
  Matrix dy_dx;                 // of Jacobians: (m, k·B)
  Matrix J, weighted;           // of dense Hessians: (m·B, n), and (∂²L/∂y²) J

  const Matrix& x() const { return physics.x; }  // (k, B)
};

// Named quantities of a problem at θ and the forward pass there over the samples that judge, traced
// at kept iterations.
struct Series {
  std::vector<std::string> names = {};
  std::function<void(const Problem& problem, VectorRef theta, Point& at, VectorOut values)>
      evaluate = {};
};

// The scale of the perturbation for sampled starts, a tenth of it: max(1, |θᵢ|), or |θᵢ| where each
// unknown has a scale of its own, such as 1e-4 beside thousands.
enum class StartScale { at_least_one, own };

// standard + 0.1 s N(0, 1), s the scale of each component.
Vector near(const Vector& standard, StartScale scale, RandomStream& noise);

// θ₀ of a run, and the standard start that it was sampled around; both are equal without sampling.
struct Start {
  Start() = default;
  template <std::convertible_to<Vector> Theta>
  Start(const Theta& theta) : drawn(theta), standard(drawn) {}
  Start(Vector theta, Vector around) : drawn(std::move(theta)), standard(std::move(around)) {}

  Vector drawn, standard;  // (n)
};

// lower ≤ θ ≤ upper, (n) each, infinite where a component has no bound.
struct Bounds {
  Vector lower, upper;
  // False where methods without bounds may run, too: the solution lies inside, and P has no value
  // outside or nothing else keeps θ there.
  bool are_needed = true;

  bool hold(VectorRef theta) const {
    return ((theta.array() >= lower.array()) && (theta.array() <= upper.array())).all();
  }
  Vector nearest(VectorRef theta) const {  // Π(θ); NaN is moved to the lower bound
    const Vector above = (theta.array() > lower.array()).select(theta, lower);
    return (above.array() < upper.array()).select(above, upper);
  }
  // Whether the i-th component of −g points out of the bounds at θ.
  bool is_active(VectorRef theta, VectorRef g, Index i) const {
    return (theta[i] <= lower[i] && g[i] > 0) || (theta[i] >= upper[i] && g[i] < 0);
  }
};

// Scales, (n), of the unknowns of a problem whose methods see x divided by them, and its bounds on
// x. Empty: θ = x.
struct OwnUnits {
  Vector scales;
  std::optional<Bounds> bounds;
};

// Noise of the calls: y ← y* + (1 + σz)(y − y*) for each residual, z ~ N(0, 1) by the number of
// the call. What is judged has none.
struct Jitter {
  Real sigma;
  RandomStream stream;

  void disturb(std::uint64_t call, BatchRef target, BatchOut y) const;
};

// The parts of a problem. A direct problem leaves network, input and samples empty. A learning
// problem leaves target, input, context and truth empty, which `samples` provides.
struct ProblemParts {
  std::unique_ptr<Physics> physics;
  Start start;  // θ₀, (n)
  StartScale start_scale = StartScale::at_least_one;
  Matrix target;                     // y*, (m, B)
  std::unique_ptr<Network> network;  // identity where empty
  Matrix input;                      // what the network sees, (i, B)
  Matrix context;                    // c, (p, B)
  std::unique_ptr<Loss> loss;        // ½‖y − y*‖² where empty
  Aim aim = Aim::loss;               // as its entry has it
  std::optional<Real> minimum;       // f_L, least loss attainable, where known
  Real minimum_error = 0;            // most that f_L may be off: of a published one, its last digit
  std::optional<Real> scale;         // of L, for targets; found by Problem::loss_scale where empty
  std::optional<Matrix> truth;       // the x* that made y*, (k, B), where there is one
  // Where the problem itself puts noise into y*, so that x* does not reproduce it: this x*, (k, 1).
  std::optional<Matrix> made_from;
  std::optional<Real> noise_level;    // δ, the expected ‖y* − P(x*)‖ of noise in y*
  std::optional<Jitter> jitter = {};  // of the calls
  Index penalties = 0;                // last rows of y that are no data, but a penalty
  std::optional<Bounds> bounds;       // on θ = x of a direct problem
  // Names and units of the unknowns of a direct problem, (n); empty: x1, x2, … without units.
  std::vector<std::string> names = {}, units = {};
  OwnUnits own_units = {};
  // Distance from x to the nearest solution, the mean over samples, where solutions are known.
  std::function<Real(BatchRef x, const Batch& batch)> x_error;
  std::optional<Real> x_scale;  // ‖x*‖, for targets in x; found by Problem::x_scale where empty
  // The error in x that the data of these samples cannot better; 0 where empty.
  std::function<Real(const Batch& batch)> x_floor;
  Samples samples = {};
  std::optional<Field> field = {};  // where x and y are numbers on one grid, for pictures
  History history = {};             // where the field is one: the states between x and y
  Series series = {};               // further quantities to be traced, at most Trace::kSeries
  // The plotted region of a two-dimensional problem: low and high corner in x.
  std::optional<std::array<Real, 4>> window;    // x1 low, x1 high, x2 low, x2 high
  std::optional<std::array<Real, 4>> y_window;  // of y; what the window maps into where empty
  std::string contour_spacing = "logarithm";    // or "fifth root", or "powers of two"
};

// The words of a model (problems/model.h), through which methods see other unknowns θ than x.
struct Model {
  std::vector<std::string> names, units;  // of x, (k); units may be empty
  Vector factors;                         // of the residuals of the data, (m); empty: 1
};

class Problem {
 public:
  explicit Problem(ProblemParts parts);
  ProblemParts parts() &&;  // to make another problem of

  Index unknowns() const { return parts_.start.drawn.size(); }  // n
  Index inputs() const { return parts_.physics->inputs(); }     // k
  Index outputs() const { return parts_.physics->outputs(); }   // m
  Index samples() const { return batch_.samples(); }            // B
  Index residuals() const { return batch_.target.size(); }      // m·B, rows of J
  const Vector& start() const { return parts_.start.drawn; }
  const Vector& standard_start() const { return parts_.start.standard; }
  StartScale start_scale() const { return parts_.start_scale; }
  const Batch& batch() const { return batch_; }  // the only one, or the first of a learning problem
  const Matrix& target() const { return batch_.target; }
  Aim aim() const { return parts_.aim; }
  std::optional<Real> minimum() const { return parts_.minimum; }
  void set_minimum(Real loss) { parts_.minimum = loss; }  // the best known, where none is declared
  void set_x_floor(Real error) {
    parts_.x_floor = [error](const Batch&) { return error; };
  }
  // The start and the target of the user, for a direct problem, of the sizes of its own. What is
  // known of the solution for its own target does not hold for another one.
  void set_start(Vector start);
  void set_target(const Matrix& target);
  Real minimum_error() const { return parts_.minimum_error; }
  const std::optional<Matrix>& truth() const { return parts_.truth; }  // of a direct problem
  // The x* from which the data were made, with noise or without.
  const std::optional<Matrix>& made_from() const {
    return parts_.made_from ? parts_.made_from : parts_.truth;
  }
  std::optional<Real> noise_level() const { return parts_.noise_level; }
  Index penalties() const { return parts_.penalties; }
  const Jitter* jitter() const { return parts_.jitter ? &*parts_.jitter : nullptr; }
  Real discrepancy(const Point& at) const {  // ‖y − y*‖ of the data
    return (at.y - at.batch->target).topRows(outputs() - parts_.penalties).norm();
  }
  const std::vector<std::string>& names() const { return parts_.names; }  // (n), or empty
  const std::vector<std::string>& units() const { return parts_.units; }  // (n), or empty
  const Bounds* bounds() const { return parts_.bounds ? &*parts_.bounds : nullptr; }
  const OwnUnits& own_units() const { return parts_.own_units; }
  Vector in_own_units(VectorRef theta) const;  // x
  const Model* model() const;                  // nothing without its words
  // By which each y of the simulator is multiplied: (residuals), without penalties and priors.
  Vector factors_of_data() const;
  Matrix model_slopes(VectorRef theta) const;  // ∂x/∂θ, (k, n), of a problem with a model
  // h of unknown j at θ by the steps that a user gave: one for each x, and absolute ones in units
  // of x; `otherwise` as GivenSteps has it.
  Real given_step(const GivenSteps& given, VectorRef theta, Index j, Real size,
                  Real otherwise) const;
  const Physics& physics() const { return *parts_.physics; }
  const auto& window() const { return parts_.window; }
  const auto& y_window() const { return parts_.y_window; }
  const std::string& contour_spacing() const { return parts_.contour_spacing; }
  std::vector<Block> layout() const { return parts_.network->layout(); }
  const Network& network() const { return *parts_.network; }
  bool has_identity_network() const { return parts_.network->is_identity(); }
  const std::optional<Field>& field() const { return parts_.field; }
  const History& history() const { return parts_.history; }
  const Series& series() const { return parts_.series; }
  bool is_learned() const { return parts_.samples.batch > 0; }
  bool has_fresh_batches() const { return is_learned() && parts_.samples.data == 0; }
  bool is_least_squares() const { return parts_.loss->is_least_squares(); }
  Inverse inverse_kind() const { return parts_.physics->inverse_kind(); }
  Products products() const { return parts_.physics->products(); }
  bool is_elsewhere() const { return parts_.physics->is_elsewhere(); }
  Real x_error(BatchRef x, const Batch& batch) const {  // nan where no solution is known
    return parts_.x_error ? parts_.x_error(x, batch) : std::nan("");
  }
  Real x_error(BatchRef x) const { return x_error(x, batch_); }

  // The scales for distances from f_L and from x*, on the validation samples. They do not depend on
  // the sampled start.
  Real loss_scale(const Batch& batch) const;  // of L; not finite where L is not at any reference
  Real x_scale(const Batch& batch) const;     // nan where no solution is known
  Real x_floor(const Batch& batch) const { return parts_.x_floor ? parts_.x_floor(batch) : 0; }

  // For a learning problem: the batch of a step, counted from 0, and the validation samples.
  void draw_batch(std::int64_t step, Batch& out) const;
  // Solves by iterations, else nothing; and as how many calls one solve of these samples counts.
  // The oracles that do not solve use the network alone, x*, or the inverse.
  const Refinement* refinement() const;
  Index solve_iterations(const Batch& batch) const;
  static constexpr bool is_solve(Oracle oracle) {
    return oracle != Oracle::network && oracle != Oracle::inverse && oracle != Oracle::truth;
  }
  void draw_validation(Batch& out) const { draw("validation", 0, parts_.samples.validation, out); }

  OracleSet offers() const;
  // Rows and columns of an oracle's dense matrix, and whether it takes at most 1 GiB.
  std::array<Index, 2> dense_shape(Oracle oracle) const;
  bool is_dense_feasible(Oracle oracle) const;
  // Where J is sparse: its pattern, else nothing.
  const SparsePattern* sparse_pattern() const {
    const bool is_of_theta = has_identity_network() && samples() == 1;
    return is_of_theta ? parts_.physics->sparse_pattern() : nullptr;
  }
  OracleCounts prices() const;  // declared, in forwards

  void forward(VectorRef theta, const Batch& batch, Point& at) const;
  void forward(VectorRef theta, Point& at) const { forward(theta, batch_, at); }
  // See Physics; of a direct problem of one sample, θ (n, count).
  void begin_forwards(const Matrix& thetas) const {
    if (thetas.cols() > 1 && has_identity_network() && samples() == 1)
      parts_.physics->begin_forwards(thetas);
  }
  // The physics again at a given x, network left out: for inverting the physics alone.
  void physics_forward(BatchRef x, const Batch& batch, Point& at) const;

  Real loss_of(BatchRef y) const {  // L at any y, (m, B)
    return parts_.loss->value(y, batch_.target);
  }
  void cotangent(const Point& at, BatchOut g) const {  // g = ∂L/∂y, (m, B)
    parts_.loss->cotangent(at.y, at.batch->target, g);
  }
  void loss_curvature(const Point& at, BatchRef dy, BatchOut dg) const {  // (∂²L/∂y²) dy
    parts_.loss->curvature(at.y, at.batch->target, dy, dg);
  }
  void residual(const Point& at, VectorOut r) const {  // r = (y − y*)/√B, (m·B)
    r = (at.y - at.batch->target).reshaped() / std::sqrt(static_cast<Real>(at.batch->samples()));
  }
  void pullback(BatchRef w, VectorOut out, Point& at) const;          // Jᵀ w, (m, B) -> (n)
  void pushforward(VectorRef v, BatchOut out, Point& at) const;       // J v, (n) -> (m, B)
  void physics_pullback(BatchRef w, BatchOut out, Point& at) const {  // (m, B) -> (k, B)
    parts_.physics->pullback(w, out, at.physics);
  }
  void network_pullback(BatchRef w, VectorOut out, Point& at) const {  // (k, B) -> (n)
    parts_.network->pullback(w, out, at.network);
  }
  void layer_factors(BatchRef w, std::vector<LayerFactor>& out, Point& at) const {  // w (m, B)
    parts_.network->layer_factors(pulled_to_x(w, at), out, at.network);
  }
  void layer_moments(BatchRef w, std::vector<LayerMoments>& out, VectorOut JTw, Point& at) const {
    parts_.network->layer_moments(pulled_to_x(w, at), out, JTw, at.network);
  }
  void jacobian(Matrix& J, Point& at) const;  // (m·B, n)
  void sparse_jacobian(Vector& values, Point& at) const {
    values.resize(parts_.physics->sparse_pattern()->values());
    parts_.physics->sparse_jacobian(values, at.physics);
  }
  void sensitivity(Matrix& dy_dx, Point& at) const {  // (m, k·B)
    dy_dx.resize(outputs(), at.x().size());
    parts_.physics->jacobian(dy_dx, at.physics);
  }
  void hessian_product(VectorRef v, VectorOut out, Point& at) const;  // ∇²L v, (n)
  void hessian(Matrix& H, Point& at) const;                    // ∇²L, (n, n), identity network
  void curvature(BatchRef w, BatchOut out, Point& at) const {  // (k, k·B)
    parts_.physics->curvature(w, out, at.physics);
  }
  Success local_inverse(BatchRef y, BatchOut x, Point& at) const {
    return parts_.physics->local_inverse(y, at.x(), at.batch->context, x);
  }

 private:
  void draw(std::string_view purpose, std::uint64_t first, Index count, Batch& out) const;
  void evaluate_physics(const Batch& batch, Point& at) const;  // y and L at at.x()
  const Matrix& pulled_to_x(BatchRef w, Point& at) const;      // (m, B) -> (k, B), in at.scratch_x

  ProblemParts parts_;
  Batch batch_;
};

// The random numbers of the instance and the start that a seed names (core/seeds.h).
class Draw {
 public:
  Draw(std::uint64_t seed, std::string problem)
      : instance_(instance_of(seed)), start_(start_of(seed)), problem_(std::move(problem)) {}
  bool is_published() const { return instance_ == 0; }       // the data
  std::uint64_t instance_seed() const { return instance_; }  // for streams of an entry's own
  std::uint64_t start_seed() const { return start_; }
  RandomStream stream(std::string_view purpose) const { return {instance_, problem_, purpose}; }
  RandomStream start_stream(std::string_view purpose) const { return {start_, problem_, purpose}; }
  // A start near the standard one; for start 0 that itself. The scale goes with
  // ProblemParts::start_scale.
  Start start(const Vector& standard, StartScale scale = StartScale::at_least_one) const;

 private:
  std::uint64_t instance_, start_;
  std::string problem_;  // without options: sweeps see the same samples
};

// An entry with `make` as a function of the options struct and the draw.
template <class Options>
ProblemEntry problem_entry(ProblemEntry entry, ProblemParts (*make)(const Options&, const Draw&)) {
  entry.options = option_table<Options>();
  entry.make = [make, aim = entry.aim](const OptionValues& options, const Draw& draw) {
    ProblemParts parts = make(read_options<Options>(options), draw);
    parts.aim = aim;
    return Problem(std::move(parts));
  };
  return entry;
}

}  // namespace isoline::problems
