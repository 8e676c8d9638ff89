// The log coefficient m of a Poisson equation, from the solution at 300 points:
//
//   −∇·(e^m ∇u) = 0 on (0, 1)²,  u = x₂ at x₂ = 0 and 1,  no flux at x₁ = 0 and 1,  y = u(points).
//
// Kim, Villa, Parno, Marzouk, Ghattas, Petra (2021), arXiv 2112.00713, section 5.1.2, the benchmark
// `poisson` of hIPPYlib and UM-Bridge: m at the 33² nodes of 32² squares, each two linear
// triangles. Deviations: u is linear on the same triangles, not quadratic; e^m is taken at the mean
// of a triangle's corners; the prior of x* is isotropic, (−γΔ + δ)⁻² with γ = 0.1 and δ = 0.5, as
// its cosine series up to the 16th wave. The noise of 0.5 % is the option noise of every problem
// here.
//
// With one right angle per triangle, its stiffness couples along its two legs alone: energy
// ½ Σ_T ½κ_T ((u_a − u_r)² + (u_b − u_r)²), κ_T = e^(mean of m), r the corner of the right angle.
// The sensitivity and its adjoint use the factors of the forward solve. A constant added to m
// changes nothing, so errors in m are those of m without its mean.
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "core/decompose.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct PoissonField {
  Index N = 32, points = 300;
};
void fields(PoissonField& o, auto& field) {
  field("N", o.N, between(2, 128), "squares along each side");
  field("points", o.points, between(1, 10000), "points at which u is observed");
}

class CoefficientToPoints final : public Physics {
 public:
  CoefficientToPoints(Index N, const Matrix& points) : N_(N) {
    for (Index j = 0; j < N; ++j)
      for (Index i = 0; i < N; ++i) {
        triangles_.push_back({node(i, j), node(i + 1, j), node(i, j + 1)});
        triangles_.push_back({node(i + 1, j + 1), node(i, j + 1), node(i + 1, j)});
      }
    boundary_.setZero(inputs());
    for (Index i = 0; i <= N; ++i) boundary_[node(i, N)] = 1;
    for (Index p = 0; p < points.cols(); ++p) observe(points(0, p), points(1, p));
  }

  Index inputs() const override { return (N_ + 1) * (N_ + 1); }
  Index outputs() const override { return static_cast<Index>(observed_.size()); }

  void forward(BatchRef m, BatchRef, BatchOut y, Workspace& w) const override {
    auto& states = w.as<States>().all;
    states.resize(static_cast<std::size_t>(m.cols()));
    for (Index b = 0; b < m.cols(); ++b) {
      solve(m.col(b), states[static_cast<std::size_t>(b)]);
      sample(states[static_cast<std::size_t>(b)].u, y.col(b));
    }
  }

  // A δu = −(∂A/∂m δm) u
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < v.cols(); ++b) {
      State& at = state_of(w, b);
      at.field.setZero(inputs());
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto& [r, a, c] = triangles_[t];
        const Real change = at.kappa[index(t)] * (v(r, b) + v(a, b) + v(c, b)) / 6;
        const Real along = change * (at.u[a] - at.u[r]), across = change * (at.u[c] - at.u[r]);
        at.field[a] -= along;
        at.field[c] -= across;
        at.field[r] += along + across;
      }
      solve_inside(at, at.field);
      sample(at.field, Jv.col(b));
    }
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b) {
      State& at = state_of(w, b);
      at.field.setZero(inputs());
      for (std::size_t p = 0; p < observed_.size(); ++p)
        for (const auto& [corner, weight] : observed_[p])
          at.field[corner] += weight * u(index(p), b);
      solve_inside(at, at.field);
      JTu.col(b).setZero();
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto& [r, a, c] = triangles_[t];
        const Real product = (at.u[a] - at.u[r]) * (at.field[a] - at.field[r]) +
                             (at.u[c] - at.u[r]) * (at.field[c] - at.field[r]);
        const Real share = -at.kappa[index(t)] * product / 6;
        for (const Index corner : {r, a, c}) JTu(corner, b) += share;
      }
    }
  }

 private:
  // At one m: κ (triangles), u (nodes), the factor L of A = L Lᵀ by diagonals, (N + 2, unknowns),
  // and a field over the nodes.
  struct State {
    Vector kappa, u, field;
    Matrix L;
    bool is_factored = false;
  };
  struct States final : Scratch {
    std::vector<State> all;
  };
  struct Corner {
    Index node;
    Real weight;
  };

  Index node(Index i, Index j) const { return i + (N_ + 1) * j; }
  static Index index(std::size_t i) { return static_cast<Index>(i); }
  static State& state_of(Workspace& w, Index b) {
    return w.as<States>().all[static_cast<std::size_t>(b)];
  }
  Index unknowns() const { return (N_ + 1) * (N_ - 1); }  // u inside, without the rows j = 0 and N
  bool is_inside(Index at) const { return at > N_ && at < inputs() - N_ - 1; }
  Index place(Index at) const { return at - N_ - 1; }  // of a node inside

  // The observation of u at a point: linear on its triangle.
  void observe(Real x1, Real x2) {
    const auto n = static_cast<Real>(N_);
    const Index i = std::min(static_cast<Index>(x1 * n), N_ - 1);
    const Index j = std::min(static_cast<Index>(x2 * n), N_ - 1);
    const Real a = x1 * n - static_cast<Real>(i), b = x2 * n - static_cast<Real>(j);
    if (a + b <= 1)
      observed_.push_back({{{node(i, j), 1 - a - b}, {node(i + 1, j), a}, {node(i, j + 1), b}}});
    else
      observed_.push_back(
          {{{node(i + 1, j + 1), a + b - 1}, {node(i, j + 1), 1 - a}, {node(i + 1, j), 1 - b}}});
  }

  void solve(VectorRef m, State& at) const {
    at.kappa.resize(index(triangles_.size()));
    at.L.setZero(N_ + 2, unknowns());
    at.field.setZero(inputs());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& [r, a, c] = triangles_[t];
      at.kappa[index(t)] = std::exp((m[r] + m[a] + m[c]) / 3);
      couple(r, a, at.kappa[index(t)] / 2, at);
      couple(r, c, at.kappa[index(t)] / 2, at);
    }
    at.is_factored = cholesky_of_band(at.L);
    solve_inside(at, at.field);
    at.u = boundary_ + at.field;
  }
  // An edge of the weight w adds w (u_p − u_q) to the equations of p and q.
  void couple(Index p, Index q, Real w, State& at) const {
    const Index low = std::min(p, q), high = std::max(p, q);
    for (const Index here : {low, high}) {
      if (!is_inside(here)) continue;
      const Index there = low + high - here;
      at.L(0, place(here)) += w;
      if (!is_inside(there))
        at.field[here] += w * boundary_[there];
      else if (here == low)
        at.L(high - low, place(low)) -= w;
    }
  }
  // field ← A⁻¹ field inside, 0 where u is given; nan where e^m is not finite.
  void solve_inside(const State& at, Vector& field) const {
    field.head(N_ + 1).setZero();
    field.tail(N_ + 1).setZero();
    auto inside = field.segment(N_ + 1, unknowns());
    if (!at.is_factored || !solve_by_cholesky_of_band(at.L, inside))
      inside.setConstant(std::numeric_limits<Real>::quiet_NaN());
  }
  void sample(const Vector& u, VectorOut y) const {
    for (std::size_t p = 0; p < observed_.size(); ++p) {
      y[index(p)] = 0;
      for (const auto& [corner, weight] : observed_[p]) y[index(p)] += weight * u[corner];
    }
  }

  Index N_;
  std::vector<std::array<Index, 3>> triangles_;  // the corner of the right angle first
  Vector boundary_;                              // u where it is given, (nodes)
  std::vector<std::array<Corner, 3>> observed_;
};

// x*, without a mean: waves of the prior.
Vector truth_of(Index N, RandomStream stream) {
  constexpr int kWaves = 16;
  constexpr Real kGamma = 0.1, kDelta = 0.5, kPi = std::numbers::pi;
  Vector truth = Vector::Zero((N + 1) * (N + 1));
  for (int p = 0; p <= kWaves; ++p)
    for (int q = 0; q <= kWaves; ++q) {
      if (p == 0 && q == 0) continue;
      const Real norm = (p > 0 ? std::numbers::sqrt2 : 1) * (q > 0 ? std::numbers::sqrt2 : 1);
      const Real size =
          stream.normal() * norm / (kDelta + kGamma * kPi * kPi * static_cast<Real>(p * p + q * q));
      for (Index j = 0; j <= N; ++j)
        for (Index i = 0; i <= N; ++i)
          truth[i + (N + 1) * j] +=
              size * std::cos(kPi * p * static_cast<Real>(i) / static_cast<Real>(N)) *
              std::cos(kPi * q * static_cast<Real>(j) / static_cast<Real>(N));
    }
  return truth.array() - truth.mean();
}

// The part of x* that no data at these points determine, by J at x*.
Real part_without_data(const Physics& physics, const Vector& truth) {
  constexpr Real kRounding = 1e-10;  // of the largest singular value
  Workspace w;
  w.x = truth;
  Matrix y(physics.outputs(), 1), J(physics.outputs(), physics.inputs());
  physics.forward(truth, Matrix(0, 1), y, w);
  physics.jacobian(J, w);
  Svd svd;
  require(thin_svd(J, svd), "the Jacobian at x* has no singular value decomposition");
  Real squared = truth.squaredNorm();
  for (Index i = 0; i < svd.sigma.size() && svd.sigma[i] > kRounding * svd.sigma[0]; ++i)
    squared -= std::pow(svd.Vt.row(i).dot(truth), 2);
  return std::sqrt(std::max<Real>(squared, 0));
}

ProblemParts make_poisson_field(const PoissonField& o, const Draw& draw) {
  constexpr Real kMargin = 0.05;  // from the boundary to the points
  RandomStream stream = draw.stream("points");
  const Matrix points =
      stream.uniform_vector(2 * o.points, kMargin, 1 - kMargin).reshaped(2, o.points);
  std::shared_ptr<const CoefficientToPoints> shared =
      std::make_shared<CoefficientToPoints>(o.N, points);
  const Vector truth = truth_of(o.N, draw.stream("target"));
  Matrix target(o.points, 1);
  Workspace w;
  shared->forward(truth, Matrix(0, 1), target, w);
  return {.physics = std::make_unique<CoefficientToPoints>(o.N, points),
          .start = draw.start(Vector::Zero(truth.size()), StartScale::own),
          .start_scale = StartScale::own,
          .target = target,
          .minimum = 0,
          .truth = truth,
          .x_error =
              [truth](BatchRef x, const Batch&) {
                return (x.col(0).array() - x.mean() - truth.array()).matrix().norm();
              },
          .x_floor = [shared, truth](const Batch&) { return part_without_data(*shared, truth); }};
}

}  // namespace

void register_poisson_field(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "poisson-field",
       .title = "Coefficient field of a Poisson equation",
       .group = Group::physics,
       .formula = "P(m) = u(300 points),  −∇·(e^m ∇u) = 0,  u = x₂ below and above,  "
                  "L = ½‖P(m) − y*‖²",
       .source = "Kim, Villa, Parno, Marzouk, Ghattas, Petra (2021), arXiv 2112.00713, 5.1.2",
       .note = "The published data have noise of 0.5 %: run it with noise=0.005. The state is "
               "linear on the triangles of m, not quadratic, and the prior of x* is isotropic. A "
               "constant added to m changes no data, and errors ignore it. Every start is 0.",
       .aim = Aim::x,
       .family = "diffusion",
       .in_all = false},
      make_poisson_field));
}

}  // namespace isoline::problems
