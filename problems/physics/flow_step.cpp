// The projection, by a spectral solve.
#include "problems/physics/flow_step.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/errors.h"

namespace isoline::problems {
namespace {

// The divergence between faces, in one pass.
void diverge(Index N, const Real* __restrict u, const Real* __restrict v, Real* __restrict out) {
  for (Index j = 0; j < N; ++j, u += N, out += N) {
    const Real *below = v + N * j, *above = v + (j + 1 < N ? N * (j + 1) : 0);
    for (Index i = 0; i + 1 < N; ++i) out[i] = (u[i + 1] - u[i]) + (above[i] - below[i]);
    out[N - 1] = (u[0] - u[N - 1]) + (above[N - 1] - below[N - 1]);
  }
}

}  // namespace

Projection::Projection(Index N, Arrangement arrangement)
    : N_(N),
      arrangement_(arrangement),
      fourier_(N, N),
      inverse_(Matrix::Zero(N / 2 + 1, N)),
      pressure_(N * N) {
  const bool is_staggered = arrangement == Arrangement::staggered;
  // Where i is a multiple of half the period the sine of the wide difference is 0, to the bit.
  const auto square = [&](Index i) {
    if (!is_staggered && 2 * i % N == 0) return 0.0;
    const Real angle = std::numbers::pi * static_cast<Real>(i) / static_cast<Real>(N);
    const Real sine = std::sin(is_staggered ? angle : 2 * angle);
    return (is_staggered ? 4 : 1) * sine * sine;
  };
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i <= N / 2; ++i) {
      const Real symbol = square(i) + square(j);
      if (symbol > 0) inverse_(i, j) = -1 / (symbol * fourier_.round_trip());
    }
}

void Projection::divergence(VectorRef u, VectorRef v, VectorOut out) const {
  if (arrangement_ == Arrangement::staggered) {
    diverge(N_, u.data(), v.data(), out.data());
  } else {
    weigh(N_, 0, 0.5, Side::right, u, out);
    add_weighed(N_, 0, -0.5, Side::left, u, out);
    add_weighed(N_, 0, 0.5, Side::above, v, out);
    add_weighed(N_, 0, -0.5, Side::below, v, out);
  }
}

void Projection::apply(VectorOut u, VectorOut v) {
  divergence(u, v, pressure_);
  fourier_.forward(pressure_);
  fourier_.spectrum().array() *= inverse_.array();
  fourier_.inverse(pressure_);
  if (arrangement_ == Arrangement::staggered) {
    add_weighed(N_, -1, 1, Side::left, pressure_, u);
    add_weighed(N_, -1, 1, Side::below, pressure_, v);
  } else {
    add_weighed(N_, 0, -0.5, Side::right, pressure_, u);
    add_weighed(N_, 0, 0.5, Side::left, pressure_, u);
    add_weighed(N_, 0, -0.5, Side::above, pressure_, v);
    add_weighed(N_, 0, 0.5, Side::below, pressure_, v);
  }
}

// The energy kept, and what that does to derivatives: with φ the factor, ∂φ/∂v = −φ v / Σ v² and
// ∂φ/∂v₀ = φ v₀ / Σ v₀².

namespace {

// Σ x² and Σ y² side by side, for alone each would wait for its own sums; in the order of Eigen's.
// Whole fours, as the squares of even numbers are.
std::pair<Real, Real> squared_norms(Index size, const Real* x, const Real* y) {
  Four even_x{}, odd_x{}, even_y{}, odd_y{};
  const auto add_square = [](const Real* from, Four& sum) {
    const Four values = four_at(from);
    sum += values * values;
  };
  Index i = 0;
  for (; i + 8 <= size; i += 8) {
    add_square(x + i, even_x);
    add_square(x + i + 4, odd_x);
    add_square(y + i, even_y);
    add_square(y + i + 4, odd_y);
  }
  even_x += odd_x;
  even_y += odd_y;
  if (i < size) {
    add_square(x + i, even_x);
    add_square(y + i, even_y);
  }
  const auto total = [](const Four& sum) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); };
  return {total(even_x), total(even_y)};
}

}  // namespace

Rescaling::Rescaling(VectorRef v0, VectorRef v) : factor(0) {
  std::tie(before, after) = squared_norms(v.size(), v0.data(), v.data());
  if (after != 0) factor = std::sqrt(before / after);  // nan stays nan
}

void Rescaling::pushforward(VectorRef v0, VectorRef v, VectorRef t0, VectorOut t) const {
  if (factor == 0) {
    t.setZero();
    return;
  }
  const Real change = factor * (v0.dot(t0) / before - v.dot(t) / after);
  t = factor * t + change * v;
}

void Rescaling::pullback(VectorRef v0, VectorRef v, VectorOut u, VectorOut u0) const {
  if (factor == 0) {
    u.setZero();
    return;
  }
  const Real change = factor * u.dot(v);
  u0 += (change / before) * v0;
  u = factor * u - (change / after) * v;
}

// The step, its pushforward and its pullback.

namespace {

enum Quantity : Index { kU, kV, kMarker };

// One of the quantities of a state, or one component of a velocity.
Eigen::Ref<const Vector> part(VectorRef all, Index which, Index cells) {
  return all.segment(which * cells, cells);
}
VectorOut component_part(VectorOut all, Index which, Index cells) {
  return all.segment(which * cells, cells);
}

}  // namespace

void check(const FlowOptions& o) {
  require(o.N >= 4 && o.N % 2 == 0, [&] {
    return fmt::format("N, the number of grid points per side, must be even and at least 4, got {}",
                       o.N);
  });
  require(o.dt > 0, [&] { return fmt::format("the time step dt must be above 0, got {}", o.dt); });
  require(o.viscosity >= 0,
          [&] { return fmt::format("the viscosity must be at least 0, got {}", o.viscosity); });
  const Real most = kMostViscous * o.dx() * o.dx() / o.dt;
  require(o.viscosity <= most, [&] {
    return fmt::format(
        "a viscosity of {} is too large for its explicit step: with a time step of {} and cells of "
        "{} it is stable up to Δx²/(4Δt) = {:.4g}",
        o.viscosity, o.dt, o.dx(), most);
  });
}

FlowStep::FlowStep(const FlowOptions& options)
    : options_(options),
      cells_(options.cells()),
      advection_(options.N),
      projection_(options.N, options.arrangement),
      before_(3 * cells_) {
  check(options);
  vdx_ = vdy_ = scratch_ = Vector::Zero(cells_);
}

// Calls visit(rows): rows(j)(i) is of four points, from the i-th of row j on.
template <class Visit>
void FlowStep::displaced(Index which, VectorRef velocity, const Visit& visit) const {
  const Index N = options_.N;
  const Real unit = options_.dt / options_.dx(), half = unit / 2;  // cells per step
  const Real *u = velocity.data(), *v = u + cells_;
  const auto above = [N](Index j) { return N * (j + 1 < N ? j + 1 : 0); };
  const auto below = [N](Index j) { return N * (j > 0 ? j - 1 : N - 1); };
  if (options_.arrangement == Arrangement::collocated)
    visit([=](Index j) {
      return [=, x = u + N * j, y = v + N * j](Index i) {
        return Displacement{unit * four_at(x + i), unit * four_at(y + i)};
      };
    });
  else if (which == kU)
    visit([=](Index j) {
      return [=, x = u + N * j, y = v + N * j, y2 = v + above(j)](Index i) {
        const Four own = four_at(y + i) + four_at(y2 + i);
        const Four beside = left_of(y, i, N) + left_of(y2, i, N);
        return Displacement{unit * four_at(x + i), unit / 4 * (own + beside)};
      };
    });
  else if (which == kV)
    visit([=](Index j) {
      return [=, x = u + N * j, x2 = u + below(j), y = v + N * j](Index i) {
        const Four own = four_at(x + i) + four_at(x2 + i);
        const Four beside = right_of(x, i, N) + right_of(x2, i, N);
        return Displacement{unit / 4 * (own + beside), unit * four_at(y + i)};
      };
    });
  else
    visit([=](Index j) {
      return [=, x = u + N * j, y = v + N * j, y2 = v + above(j)](Index i) {
        const Four beside = right_of(x, i, N);
        return Displacement{half * four_at(x + i) + half * beside,
                            half * four_at(y + i) + half * four_at(y2 + i)};
      };
    });
}

void FlowStep::trace(Index which, VectorRef velocity) {
  displaced(which, velocity, [this](const auto& rows) { advection_.trace(rows); });
}

void FlowStep::displace(Index which, VectorRef velocity, Vector& dx, Vector& dy) const {
  const LatticeMargin lattice(options_.N);
  displaced(which, velocity, [&](const auto& rows) {
    for (Index j = 0; j < options_.N; ++j)
      lattice.by_fours_of_row(j, [&, row = rows(j)](Index i, Index p) {
        const auto [x, y] = row(i);
        put(x, dx.data() + p);
        put(y, dy.data() + p);
      });
  });
}

void FlowStep::add_displaced(Index which, VectorRef dx, VectorRef dy, VectorOut velocity) {
  VectorOut u = velocity.head(cells_), v = velocity.tail(cells_);
  const Index N = options_.N;
  const Real unit = options_.dt / options_.dx(), half = unit / 2;
  if (which == kU) {
    u += unit * dx;
    add_square(N, unit / 4, Side::right, Side::below, dy, v);
  } else if (which == kV) {
    add_square(N, unit / 4, Side::left, Side::above, dx, u);
    v += unit * dy;
  } else {
    add_weighed(N, half, half, Side::left, dx, u);
    add_weighed(N, half, half, Side::below, dy, v);
  }
}

void FlowStep::forward(VectorRef state, VectorOut next, VectorOut projected) {
  const Real viscous = options_.viscosity * options_.dt / (options_.dx() * options_.dx());
  for (const Index which : {kU, kV}) {
    trace(which, state.head(2 * cells_));
    advection_.value(part(state, which, cells_), component_part(projected, which, cells_));
  }
  projection_.apply(projected.head(cells_), projected.tail(cells_));
  for (const Index which : {kU, kV}) {
    const VectorRef before = part(state, which, cells_), after = part(projected, which, cells_);
    VectorOut component = component_part(next, which, cells_);
    component = (options_.rescales ? Rescaling(before, after).factor : 1) * after;
    if (viscous > 0) diffuse(options_.N, viscous, component, scratch_);
  }
  trace(kMarker, next.head(2 * cells_));
  advection_.value(state.tail(cells_), next.tail(cells_));
}

void FlowStep::pushforward(VectorRef state, VectorRef next, VectorRef projected, VectorRef tangent,
                           VectorOut out) {
  const Real viscous = options_.viscosity * options_.dt / (options_.dx() * options_.dx());
  for (const Index which : {kU, kV}) {
    trace(which, state.head(2 * cells_));
    displace(which, tangent.head(2 * cells_), vdx_, vdy_);
    advection_.pushforward(part(state, which, cells_), part(tangent, which, cells_), vdx_, vdy_,
                           component_part(out, which, cells_));
  }
  projection_.apply(out.head(cells_), out.segment(cells_, cells_));
  for (const Index which : {kU, kV}) {
    const auto own = [&](VectorRef all) { return part(all, which, cells_); };
    VectorOut component = component_part(out, which, cells_);
    if (options_.rescales)
      Rescaling(own(state), own(projected))
          .pushforward(own(state), own(projected), own(tangent), component);
    if (viscous > 0) diffuse(options_.N, viscous, component, scratch_);
  }
  trace(kMarker, next.head(2 * cells_));
  displace(kMarker, out.head(2 * cells_), vdx_, vdy_);
  advection_.pushforward(state.tail(cells_), tangent.tail(cells_), vdx_, vdy_, out.tail(cells_));
}

void FlowStep::add_choices(VectorRef state, VectorRef next, PieceDigest& digest) {
  for (const Index which : {kU, kV, kMarker}) {
    trace(which, (which == kMarker ? next : state).head(2 * cells_));
    advection_.add_choices(part(state, which, cells_), digest);
  }
}

void FlowStep::pullback(VectorRef state, VectorRef next, VectorRef projected, VectorOut cotangent) {
  const Real viscous = options_.viscosity * options_.dt / (options_.dx() * options_.dx());
  before_.setZero();
  const auto add_pulled = [&](Index which, VectorRef velocity, VectorOut of_velocity) {
    trace(which, velocity);
    vdx_.setZero();
    vdy_.setZero();
    advection_.pullback(part(state, which, cells_), part(cotangent, which, cells_),
                        component_part(before_, which, cells_), vdx_, vdy_);
    add_displaced(which, vdx_, vdy_, of_velocity);
  };
  add_pulled(kMarker, next.head(2 * cells_), cotangent.head(2 * cells_));
  for (const Index which : {kU, kV}) {
    const auto own = [&](VectorRef all) { return part(all, which, cells_); };
    VectorOut component = component_part(cotangent, which, cells_);
    if (viscous > 0) diffuse(options_.N, viscous, component, scratch_);
    if (options_.rescales)
      Rescaling(own(state), own(projected))
          .pullback(own(state), own(projected), component, component_part(before_, which, cells_));
  }
  projection_.apply(cotangent.head(cells_), cotangent.segment(cells_, cells_));
  for (const Index which : {kU, kV})
    add_pulled(which, state.head(2 * cells_), before_.head(2 * cells_));
  cotangent = before_;
}

// Steps in order, their tangents in the same order, their cotangents from the last to the first.

Simulation::Simulation(const FlowOptions& options, Index steps)
    : options_(options),
      cells_(options.cells()),
      steps_(steps),
      step_(options),
      moved_(3 * cells_) {
  require(steps > 0, "a simulation needs at least one step");
}

void Simulation::size(FlowRun& run) const {
  run.states.resize(3 * cells_, steps_ + 1);
  run.projected.resize(2 * cells_, steps_);
}

void Simulation::begin(VectorRef centred, VectorRef marker, FlowRun& run) {
  size(run);
  begin_pushforward(centred, run.states.col(0).head(2 * cells_));  // it is linear
  run.states.col(0).tail(cells_) = marker;
}

void Simulation::begin_pushforward(VectorRef centred, VectorOut velocity) {
  if (options_.arrangement == Arrangement::collocated) {
    velocity = centred;
    return;
  }
  weigh(options_.N, 0.5, 0.5, Side::left, centred.head(cells_), velocity.head(cells_));
  weigh(options_.N, 0.5, 0.5, Side::below, centred.tail(cells_), velocity.tail(cells_));
  step_.projection().apply(velocity.head(cells_), velocity.tail(cells_));
}

void Simulation::begin_pullback(VectorOut velocity, VectorOut centred) {
  step_.projection().apply(velocity.head(cells_), velocity.tail(cells_));
  centre(velocity, centred);
}

void Simulation::centre(VectorRef velocity, VectorOut centred) const {
  weigh(options_.N, 0.5, 0.5, Side::right, velocity.head(cells_), centred.head(cells_));
  weigh(options_.N, 0.5, 0.5, Side::above, velocity.tail(cells_), centred.tail(cells_));
}

void Simulation::forward(FlowRun& run) {
  for (Index n = 0; n < steps_; ++n)
    step_.forward(run.states.col(n), run.states.col(n + 1), run.projected.col(n));
}

void Simulation::pushforward(const FlowRun& run, VectorOut tangent) {
  for (Index n = 0; n < steps_; ++n) {
    step_.pushforward(run.states.col(n), run.states.col(n + 1), run.projected.col(n), tangent,
                      moved_);
    tangent = moved_;
  }
}

void Simulation::pullback(const FlowRun& run, VectorOut cotangent) {
  for (Index n = steps_; n-- > 0;)
    step_.pullback(run.states.col(n), run.states.col(n + 1), run.projected.col(n), cotangent);
}

void Simulation::add_choices(const FlowRun& run, PieceDigest& digest) {
  for (Index n = 0; n < steps_; ++n)
    step_.add_choices(run.states.col(n), run.states.col(n + 1), digest);
}

void Simulation::reverse(const FlowRun& run, VectorRef marker, FlowRun& back) {
  size(back);
  back.states.col(0).head(2 * cells_) = -run.velocity(steps_);
  back.states.col(0).tail(cells_) = marker;
  forward(back);
}

}  // namespace isoline::problems
