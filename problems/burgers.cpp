// Viscous flow on a ring backwards: u(0) from u(T) under Burgers' equation. It is the first
// nonlinear inverse problem of Thuerey et al., Physics-based Deep Learning. The initial states and
// sizes are our own. The steps, their derivatives and the simulation backward of burgers_flow.h
// come first, then the problem.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/frames.h"
#include "problems/burgers_flow.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

// The N cells of a ring in a column of N + 2: each end repeats the cell at the other end, so that
// stencils need no special case at the ends.
void close(Real* cells, Index N) {
  cells[-1] = cells[N - 1];
  cells[N] = cells[0];
}

// Columns of rings, each by its first cell.
class Rings {
 public:
  Rings(Matrix& columns, Index N, Index count) : columns_(columns), N_(N) {
    columns_.resize(N + 2, count);
  }
  Real* operator[](Index i) const { return &columns_(1, i); }
  Real* closed(Index i, VectorRef cells) const {
    columns_.col(i).segment(1, N_) = cells;
    close((*this)[i], N_);
    return (*this)[i];
  }
  void copy(Index i, VectorOut cells) const { cells = columns_.col(i).segment(1, N_); }

 private:
  Matrix& columns_;
  Index N_;
};

// u and v of every step and sample, and two lines more.
struct Steps {
  const Rings stages, lines;
  const Index count;  // of steps

  Steps(Workspace& w, Index N, Index steps, Index samples)
      : stages(sized(w)[0], N, 2 * steps * samples), lines(w.saved[1], N, 2), count(steps) {}
  static std::vector<Matrix>& sized(Workspace& w) {
    w.saved.resize(2);
    return w.saved;
  }
  Real* u(Index sample, Index step) const { return stages[2 * (sample * count + step)]; }
  Real* v(Index sample, Index step) const { return stages[2 * (sample * count + step) + 1]; }
};

// At the cell that the arguments point to, in a step of these λ and μ.
struct Slope {
  Real lambda, mu;

  Real operator()(const Real* u) const {  // Δt r(u)
    return -lambda * (u[1] - u[-1]) * (u[-1] + u[0] + u[1]) + mu * (u[-1] - 2 * u[0] + u[1]);
  }
  Real tangent(const Real* u, const Real* du) const {  // Δt (∂r/∂u) du
    return -lambda *
               ((u[0] + 2 * u[1]) * du[1] - (2 * u[-1] + u[0]) * du[-1] + (u[1] - u[-1]) * du[0]) +
           mu * (du[-1] - 2 * du[0] + du[1]);
  }
  Real cotangent(const Real* u, const Real* g) const {  // Δt (∂r/∂u)ᵀ g
    return -lambda *
               ((u[-1] + 2 * u[0]) * g[-1] - (2 * u[0] + u[1]) * g[1] + (u[1] - u[-1]) * g[0]) +
           mu * (g[-1] - 2 * g[0] + g[1]);
  }
};

// From a closed u; v and the next are closed after it.
void heun(const Slope& slope, Index N, const Real* u, Real* v, Real* next) {
  for (Index j = 0; j < N; ++j) v[j] = u[j] + slope(u + j);
  close(v, N);
  for (Index j = 0; j < N; ++j) next[j] = 0.5 * (u[j] + v[j] + slope(v + j));
  close(next, N);
}

void simulate(const Slope& slope, Index steps, VectorRef from, VectorOut to) {
  Matrix columns;
  const Rings rings(columns, from.size(), 3);
  rings.closed(0, from);
  Index now = 0, next = 2;
  for (Index t = 0; t < steps; ++t) {
    heun(slope, from.size(), rings[now], rings[1], rings[next]);
    std::swap(now, next);
  }
  rings.copy(now, to);
}

Index checked_steps(Index N, Index steps, Real viscosity, Real time) {
  const Real cells = static_cast<Real>(N), courant = time * cells;  // of one step over all of T
  const Real diffusion = viscosity * courant * cells;
  const auto least = [&](Real most_courant, Real most_diffusion) {
    const Real needed = std::ceil(std::max(courant / most_courant, diffusion / most_diffusion));
    return std::max<Index>(1, static_cast<Index>(needed));
  };
  if (steps == 0) return least(0.5, 0.4);
  require(steps >= least(1, 0.5), [&] {
    return fmt::format(
        "burgers: in one time step, a speed of 1 may cross at most one cell, and νΔt/h² may be at "
        "most ½; with N={}, viscosity={:g} and time={:g}, steps must be at least {}, got {}",
        N, viscosity, time, least(1, 0.5), steps);
  });
  return steps;
}

}  // namespace

BurgersFlow::BurgersFlow(Index N, Index steps, Real viscosity, Real time)
    : N_(N), steps_(checked_steps(N, steps, viscosity, time)) {
  const Real dt = time / static_cast<Real>(steps_), cells = static_cast<Real>(N);
  lambda_ = dt * cells / 6;
  mu_ = viscosity * dt * cells * cells;
}

void BurgersFlow::forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const {
  const Steps at(w, N_, steps_, x.cols());
  for (Index b = 0; b < x.cols(); ++b) {
    at.stages.closed(2 * steps_ * b, x.col(b));
    for (Index t = 0; t < steps_; ++t)
      heun({lambda_, mu_}, N_, at.u(b, t), at.v(b, t),
           t + 1 < steps_ ? at.u(b, t + 1) : at.lines[0]);
    at.lines.copy(0, y.col(b));
  }
}

void BurgersFlow::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  const Steps at(w, N_, steps_, v.cols());
  const Slope slope{lambda_, mu_};
  for (Index b = 0; b < v.cols(); ++b) {
    Real* const du = at.lines.closed(0, v.col(b));
    Real* const dv = at.lines[1];
    for (Index t = 0; t < steps_; ++t) {
      const Real* const first = at.u(b, t);
      const Real* const second = at.v(b, t);
      for (Index j = 0; j < N_; ++j) dv[j] = du[j] + slope.tangent(first + j, du + j);
      close(dv, N_);
      for (Index j = 0; j < N_; ++j)
        du[j] = 0.5 * (du[j] + dv[j] + slope.tangent(second + j, dv + j));
      close(du, N_);
    }
    at.lines.copy(0, Jv.col(b));
  }
}

// Backward through the steps: g the cotangent of u' and then of u, p that of v.
void BurgersFlow::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  const Steps at(w, N_, steps_, u.cols());
  const Slope slope{lambda_, mu_};
  for (Index b = 0; b < u.cols(); ++b) {
    Real* const g = at.lines.closed(0, u.col(b));
    Real* const p = at.lines[1];
    for (Index t = steps_; t-- > 0;) {
      const Real* const first = at.u(b, t);
      const Real* const second = at.v(b, t);
      for (Index j = 0; j < N_; ++j) p[j] = 0.5 * (g[j] + slope.cotangent(second + j, g + j));
      close(p, N_);
      for (Index j = 0; j < N_; ++j) g[j] = 0.5 * g[j] + p[j] + slope.cotangent(first + j, p + j);
      close(g, N_);
    }
    at.lines.copy(0, JTu.col(b));
  }
}

Success BurgersFlow::local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const {
  Vector reached(N_), back(N_);
  Success success(y.cols());
  for (Index b = 0; b < y.cols(); ++b) {
    evolve(x0.col(b), reached);
    reverse(reached, back);
    reverse(y.col(b), x.col(b));
    x.col(b) += x0.col(b) - back;
    success[b] = is_finite(x.col(b));
  }
  return success;
}

void BurgersFlow::evolve(VectorRef x, VectorOut y) const { simulate({lambda_, mu_}, steps_, x, y); }

void BurgersFlow::history(VectorRef x, BatchOut states) const {
  Vector state = x;
  const Index last = states.rows() - 1;
  for (Index row = 0, now = 0; row <= last; ++row) {
    const Index then = (2 * steps_ * row + last) / (2 * last);
    simulate({lambda_, mu_}, then - now, state, state);
    now = then;
    states.row(row) = state.transpose();
  }
}

void BurgersFlow::reverse(VectorRef y, VectorOut x) const {
  simulate({.lambda = -lambda_, .mu = 0}, steps_, y, x);
}

namespace {

struct Options {
  Index N = 64, steps = 0;
  Real viscosity = 0.005, time = 0.1;
  Learning learning{.network = "mlp[layers=128-128]", .batch = 64};
};
void fields(Options& o, auto& field) {
  field("N", o.N, between(4, 4096), "cells of the ring");
  field("steps", o.steps, between(0, 1e6),
        "time steps; 0: the number that T N/steps ≤ ½ and ν T N²/steps ≤ 0.4 require");
  field("viscosity", o.viscosity, between(0, 10), "viscosity ν");
  field("time", o.time, between(1e-6, 10), "time T between the two states");
  fields(o.learning, field);
}

auto flow_of(const Options& o) {
  return std::make_unique<BurgersFlow>(o.N, o.steps, o.viscosity, o.time);
}

// x*: four waves of random phase, the n-th of the size 1/n, the largest speed 1. (N)
Vector random_state(Index N, RandomStream& stream) {
  constexpr int kWaves = 4;
  const Vector coefficients = stream.normal_vector(Index{2} * kWaves);
  Vector state = Vector::Zero(N);
  for (int n = 1; n <= kWaves; ++n)
    for (Index j = 0; j < N; ++j) {
      const Real angle = 2 * std::numbers::pi * n * static_cast<Real>(j) / static_cast<Real>(N);
      state[j] +=
          (coefficients[2 * n - 2] * std::cos(angle) + coefficients[2 * n - 1] * std::sin(angle)) /
          n;
    }
  return state / state.cwiseAbs().maxCoeff();
}

// All steps if they are few, otherwise as many as can be distinguished and stored.
Field field_of(const BurgersFlow& flow, Real time) {
  constexpr Index kMostTimes = 65;
  const Index room = Frames::kCells / flow.inputs();
  return {.rows = std::min({flow.steps() + 1, kMostTimes, room}),
          .columns = flow.inputs(),
          .x = {"initial speed"},
          .y = {"final velocity"},
          .time = time};
}

History history_of(const std::shared_ptr<const BurgersFlow>& flow) {
  return [flow](VectorRef x, BatchOut states) { flow->history(x, states); };
}

ProblemParts learn_burgers(const Options& o, const Draw& draw) {
  const auto physics = std::shared_ptr<const BurgersFlow>(flow_of(o));
  const auto sample = [physics](RandomStream& stream, Index b, Batch& batch) {
    batch.truth.col(b) = random_state(physics->inputs(), stream);
    physics->evolve(batch.truth.col(b), batch.target.col(b));
    batch.input.col(b) = batch.target.col(b);
  };
  const auto mean_distance = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).colwise().norm().mean();
  };
  return learn(o.learning, {.inputs = o.N, .outputs = o.N}, draw,
               {.physics = flow_of(o),
                .x_error = mean_distance,
                .samples = {.draw = sample},
                .field = field_of(*physics, o.time),
                .history = history_of(physics)});
}

ProblemParts make_burgers(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_burgers(o, draw);
  RandomStream stream = draw.stream("target");
  const auto shown = std::shared_ptr<const BurgersFlow>(flow_of(o));
  ProblemParts parts = from_exact_data(flow_of(o), random_state(o.N, stream), draw);
  parts.field = field_of(*shown, o.time);
  parts.history = history_of(shown);
  return parts;
}

}  // namespace

void register_burgers(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "burgers",
       .title = "Burgers’ equation backwards",
       .group = Group::physics,
       .formula = "u̇ = −u ∂u + ν ∂²u,  x = u(0),  P(x) = u(T),  L = ½‖P(x) − y*‖²",
       .source = "Thuerey et al., Physics-based Deep Learning, chapters on Burgers’ equation",
       .note =
           "x* is a sum of four waves with a largest speed of 1, from our own random streams for "
           "seed 0, too. By the time T its slopes have steepened, and viscosity has smoothed "
           "them. P is one-to-one, but less than a thousandth of the finest waves remains. The "
           "starts of seeds from 1 on contain noise of 0.1 per cell, which the data hardly "
           "determine. The local inverse simulates backward without viscosity.",
       .aim = Aim::x,
       .panels = {{.title = "Learning curves", .kind = "curve"}}},
      make_burgers));
}

}  // namespace isoline::problems
