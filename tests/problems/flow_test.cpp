// The incompressible flow: against values of another implementation, the laws of its operators and
// exact solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "flow_cases.h"

namespace isoline::problems {
namespace {

struct Values {
  Real energy, mean_u, mean_v, total, x, y;
};
Values values_of(const FlowOptions& o, VectorRef state) {
  const Index n = o.cells();
  const Vector m = state.tail(n);
  const auto along = [](bool is_x) { return [is_x](Real x, Real y) { return is_x ? x : y; }; };
  return {state.head(2 * n).squaredNorm(),
          state.head(n).mean(),
          state.segment(n, n).mean(),
          m.sum(),
          m.dot(sampled(o.N, 0.5, 0.5, along(true))) / m.sum(),
          m.dot(sampled(o.N, 0.5, 0.5, along(false))) / m.sum()};
}

void project(const FlowOptions& o, Vector& state) {
  const Index n = o.cells();
  Projection(o.N, o.arrangement).apply(state.head(n), state.segment(n, n));
}

Vector divergence_of(const FlowOptions& o, VectorRef state) {
  const Index n = o.cells();
  Vector divergence(n);
  Projection(o.N, o.arrangement).divergence(state.head(n), state.segment(n, n), divergence);
  return divergence;
}

Vector stepped(const FlowOptions& o, VectorRef state) {
  FlowStep step(o);
  Vector next(state.size()), projected(2 * o.cells());
  step.forward(state, next, projected);
  return next;
}

// --- values of an independent implementation, which agrees with PhiFlow 2.2.7 to 1e-11; as many
// digits as are printed

TEST(Flow, TakesTheStepOfThePublishedSolverStaggered) {
  const FlowOptions o;
  Vector state = Golden::state(o);
  EXPECT_NEAR(state.tail(o.cells()).sum(), 98.960167, 5e-7);
  project(o, state);
  EXPECT_NEAR(values_of(o, state).energy, 265639.6315, 5e-5);
  EXPECT_NEAR(values_of(o, state).mean_u, 3, 1e-12);
  EXPECT_NEAR(values_of(o, state).mean_v, -2, 1e-12);
  const Vector next = stepped(o, state);
  const Values after = values_of(o, next);
  EXPECT_NEAR(after.energy, 265639.6315, 5e-5);
  EXPECT_NEAR(after.mean_u, 3.028486, 5e-7);
  EXPECT_NEAR(after.mean_v, -2.021882, 5e-7);
  EXPECT_NEAR(after.total, 98.782477, 5e-7);
  EXPECT_NEAR(after.x, 49.866632, 5e-7);
  EXPECT_NEAR(after.y, 66.944220, 5e-7);
  EXPECT_NEAR(divergence_of(o, next).cwiseAbs().maxCoeff() / o.dx(), 1.13e-3, 5e-6);
}

TEST(Flow, TakesTheStepOfThePublishedSolverCollocated) {
  const FlowOptions o{.arrangement = Arrangement::collocated};
  const Vector state = Golden::state(o);
  EXPECT_NEAR(values_of(o, state).energy, 266109.4741, 5e-5);
  const Values after = values_of(o, stepped(o, state));
  EXPECT_NEAR(after.energy, 266109.4741, 5e-5);
  EXPECT_NEAR(after.mean_u, 3.027336, 5e-7);
  EXPECT_NEAR(after.mean_v, -2.021998, 5e-7);
  EXPECT_NEAR(after.total, 98.785785, 5e-7);
  EXPECT_NEAR(after.x, 49.865150, 5e-7);
  EXPECT_NEAR(after.y, 66.940255, 5e-7);
}

// u advected by means of the four faces around, as a definition has it.
TEST(Flow, AdvectsLikeThePublishedSolver) {
  const FlowOptions staggered, collocated{.arrangement = Arrangement::collocated};
  const Index N = staggered.N, n = staggered.cells();
  const Real unit = staggered.dt / staggered.dx();
  Advection advection(N);
  Vector out(n), dx(n), dy(n);
  Vector state = Golden::state(collocated);
  advection.trace(unit * state.head(n), unit * state.segment(n, n));
  advection.value(state.head(n), out);
  Real energy = out.squaredNorm();
  advection.value(state.segment(n, n), out);
  EXPECT_NEAR(energy + out.squaredNorm(), 266528.7528, 5e-5);

  state = Golden::state(staggered);
  const Vector u = state.head(n), v = state.segment(n, n);
  const auto at = [N](const Vector& q, Index i, Index j) {
    return q[(i + N) % N + N * ((j + N) % N)];
  };
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      dy[i + N * j] =
          unit / 4 * (at(v, i - 1, j) + at(v, i, j) + at(v, i - 1, j + 1) + at(v, i, j + 1));
  advection.trace(unit * u, dy);
  advection.value(u, out);
  energy = out.squaredNorm();
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      dx[i + N * j] =
          unit / 4 * (at(u, i, j - 1) + at(u, i, j) + at(u, i + 1, j - 1) + at(u, i + 1, j));
  advection.trace(dx, unit * v);
  advection.value(v, out);
  EXPECT_NEAR(energy + out.squaredNorm(), 266289.2914, 5e-5);
}

// --- laws

constexpr Arrangement kArrangements[] = {Arrangement::staggered, Arrangement::collocated};

TEST(Flow, IsFreeOfDivergenceAfterProjection) {
  for (const Arrangement arrangement : kArrangements) {
    const FlowOptions o{.arrangement = arrangement};
    Vector state = noise_of(o, "divergence");
    const Real before = divergence_of(o, state).norm();
    project(o, state);
    EXPECT_LT(divergence_of(o, state).norm(), 1e-10 * before);
    const Vector once = state;
    project(o, state);
    EXPECT_LT((state - once).norm(), 1e-13 * once.norm());
  }
}

TEST(Flow, KeepsTheMeanAndTheNullModesInProjection) {
  const FlowOptions o{.N = 8, .arrangement = Arrangement::collocated};
  Vector state = Vector::Zero(3 * o.cells());
  for (Index p = 0; p < o.cells(); ++p) {
    state[p] = 2 + (p % 2 == 0 ? 1 : -1);  // the checkerboard in x
    state[o.cells() + p] = -1;
  }
  const Vector before = state;
  project(o, state);
  EXPECT_LT((state - before).norm(), 1e-14);
}

TEST(Flow, KeepsTheEnergyOfEachComponent) {
  for (const Arrangement arrangement : kArrangements) {
    const FlowOptions o{.arrangement = arrangement};
    Vector state = Golden::state(o);
    if (arrangement == Arrangement::staggered) project(o, state);
    const Vector first = state;
    for (int step = 0; step < 8; ++step) state = stepped(o, state);
    for (const Index begin : {Index{0}, o.cells()}) {
      const Real energy = first.segment(begin, o.cells()).squaredNorm();
      EXPECT_NEAR(state.segment(begin, o.cells()).squaredNorm(), energy, 1e-12 * energy);
    }
  }
}

TEST(Flow, LosesEnergyWhereItIsNotRescaled) {
  const FlowOptions o{.rescales = false};
  Vector state = Golden::state(o);
  project(o, state);
  const Vector next = stepped(o, state);
  EXPECT_LT(next.head(2 * o.cells()).squaredNorm(), state.head(2 * o.cells()).squaredNorm());
  EXPECT_LT(divergence_of(o, next).norm(), 1e-12 * state.norm());
}

TEST(Flow, CarriesAMarkerByWholeCellsExactly) {
  FlowOptions o{.N = 8};
  o.dt = o.dx() / 2;
  const auto constant = [](Real value) { return [value](Real, Real) { return value; }; };
  Vector state = state_of(o, constant(4), constant(-2), constant(0));  // 2 and −1 cells a step
  const Vector marker = noise_of(o, "marker").head(o.cells());
  state.tail(o.cells()) = marker;
  const Vector next = stepped(o, state);
  for (Index j = 0; j < o.N; ++j)
    for (Index i = 0; i < o.N; ++i)
      EXPECT_EQ(next[2 * o.cells() + (i + 2) % o.N + o.N * ((j + o.N - 1) % o.N)],
                marker[i + o.N * j]);
}

// u = sin kx cos ky, v = −cos kx sin ky, of which ∂ₜv = ν∇²v is all that is left. Δt ~ Δx².
Real taylor_green_error(Index N) {
  constexpr Real kTime = 4, kViscosity = 40, k = 2 * std::numbers::pi / kLength;
  const Index steps = 10 * N * N / 256;
  const FlowOptions o{
      .N = N, .dt = kTime / static_cast<Real>(steps), .viscosity = kViscosity, .rescales = false};
  const auto u = [](Real x, Real y) { return std::sin(k * x) * std::cos(k * y); };
  const auto v = [](Real x, Real y) { return -std::cos(k * x) * std::sin(k * y); };
  Vector state = state_of(o, u, v, [](Real, Real) { return 0.0; });
  const Vector first = state;
  for (Index n = 0; n < steps; ++n) state = stepped(o, state);
  const Real decay = std::exp(-2 * kViscosity * k * k * kTime);
  return (state - decay * first).head(2 * o.cells()).cwiseAbs().maxCoeff();
}

TEST(Flow, LetsATaylorGreenVortexDecayAtItsRateToSecondOrder) {
  const Real coarse = taylor_green_error(16), fine = taylor_green_error(32),
             finest = taylor_green_error(64);
  EXPECT_LT(finest, 2e-3);  // of 0.46
  EXPECT_GT(std::log2(coarse / fine), 1.8);
  EXPECT_GT(std::log2(fine / finest), 1.8);
}

// --- forward and back

// What reversal leaves of a smooth flow after T = 2, relative to the flow.
Real reversal_error(Index N, Index steps) {
  const FlowOptions o{.N = N, .dt = 2 / static_cast<Real>(steps)};
  Simulation flow(o, steps);
  FlowRun run, back;
  const Vector state = Golden::state({.N = N, .arrangement = Arrangement::collocated});
  flow.begin(state.head(2 * o.cells()), state.tail(o.cells()), run);
  flow.forward(run);
  flow.reverse(run, run.marker(steps), back);
  return (back.velocity(steps) + run.velocity(0)).norm() / run.velocity(0).norm();
}

TEST(Flow, IsRecoveredByItsReversalTheBetterTheShorterTheSteps) {
  const Real coarse = reversal_error(64, 8), fine = reversal_error(64, 16),
             finest = reversal_error(64, 32);
  EXPECT_LT(finest, 0.05);
  EXPECT_GT(coarse / fine, 1.6);  // the splitting of a step is of first order
  EXPECT_GT(fine / finest, 1.6);
}

TEST(Flow, RefusesWhatCannotBeSimulated) {
  const auto law_of = [](const FlowOptions& o) -> std::string {
    try {
      check(o);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(law_of({}), "");
  EXPECT_EQ(law_of({.N = 63}), "the flow needs an even number of cells a side, at least 4, got 63");
  EXPECT_EQ(law_of({.dt = -1}), "the time step must be above 0, got -1");
  EXPECT_EQ(law_of({.viscosity = -2}), "the viscosity must be at least 0, got -2");
  EXPECT_EQ(law_of({.viscosity = 5}),
            "a viscosity of 5 is too large for its explicit step: with a time step of 0.25 and "
            "cells of 2 it is stable up to Δx²/(4Δt) = 4");
}

}  // namespace
}  // namespace isoline::problems
