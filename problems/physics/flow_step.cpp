// The step, its pushforward and its pullback.
#include "problems/physics/flow_step.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "problems/physics/rescaling.h"
#include "problems/physics/viscosity.h"

namespace isoline::problems {
namespace {

enum Quantity : Index { kU, kV, kMarker };

// One of the quantities of a state, or one component of a velocity.
Eigen::Ref<const Vector> part(VectorRef all, Index which, Index cells) {
  return all.segment(which * cells, cells);
}
VectorOut part_of(VectorOut all, Index which, Index cells) {
  return all.segment(which * cells, cells);
}

}  // namespace

void check(const FlowOptions& o) {
  require(o.N >= 4 && o.N % 2 == 0, [&] {
    return fmt::format("the flow needs an even number of cells a side, at least 4, got {}", o.N);
  });
  require(o.dt > 0, [&] { return fmt::format("the time step must be above 0, got {}", o.dt); });
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
  const Real unit = options_.dt / options_.dx(), half = unit / 2;  // cells a step
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
  if (options_.arrangement == Arrangement::collocated) {
    u += unit * dx;
    v += unit * dy;
  } else if (which == kU) {
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
    advection_.value(part(state, which, cells_), part_of(projected, which, cells_));
  }
  projection_.apply(projected.head(cells_), projected.tail(cells_));
  for (const Index which : {kU, kV}) {
    const VectorRef before = part(state, which, cells_), after = part(projected, which, cells_);
    VectorOut component = part_of(next, which, cells_);
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
                           part_of(out, which, cells_));
  }
  projection_.apply(out.head(cells_), out.segment(cells_, cells_));
  for (const Index which : {kU, kV}) {
    const auto own = [&](VectorRef all) { return part(all, which, cells_); };
    VectorOut component = part_of(out, which, cells_);
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
                        part_of(before_, which, cells_), vdx_, vdy_);
    add_displaced(which, vdx_, vdy_, of_velocity);
  };
  add_pulled(kMarker, next.head(2 * cells_), cotangent.head(2 * cells_));
  for (const Index which : {kU, kV}) {
    const auto own = [&](VectorRef all) { return part(all, which, cells_); };
    VectorOut component = part_of(cotangent, which, cells_);
    if (viscous > 0) diffuse(options_.N, viscous, component, scratch_);
    if (options_.rescales)
      Rescaling(own(state), own(projected))
          .pullback(own(state), own(projected), component, part_of(before_, which, cells_));
  }
  projection_.apply(cotangent.head(cells_), cotangent.segment(cells_, cells_));
  for (const Index which : {kU, kV})
    add_pulled(which, state.head(2 * cells_), before_.head(2 * cells_));
  cotangent = before_;
}

}  // namespace isoline::problems
