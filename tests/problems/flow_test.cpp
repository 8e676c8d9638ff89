// The incompressible flow: against values of another implementation, the laws of its operators and
// exact solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/random.h"
#include "problems/physics/flow_step.h"
#include "tests/refusal.h"

namespace isoline::problems {
namespace {

constexpr Real kLength = 128;

using Function = std::function<Real(Real x, Real y)>;

// At (Δx (i + along_x), Δx (j + along_y)), (N²).
Vector sampled(Index N, Real along_x, Real along_y, const Function& f) {
  const Real dx = kLength / static_cast<Real>(N);
  Vector values(N * N);
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      values[i + N * j] =
          f(dx * (static_cast<Real>(i) + along_x), dx * (static_cast<Real>(j) + along_y));
  return values;
}

// u, v and m where this arrangement has them, (3N²).
Vector state_of(const FlowOptions& o, const Function& u, const Function& v, const Function& m) {
  const Real face = o.arrangement == Arrangement::staggered ? 0 : 0.5;
  Vector state(3 * o.cells());
  state << sampled(o.N, face, 0.5, u), sampled(o.N, 0.5, face, v), sampled(o.N, 0.5, 0.5, m);
  return state;
}

// The flow of the golden values, which has no random numbers in it.
struct Golden {
  static constexpr Real k = 2 * std::numbers::pi / kLength;
  static Real vortex(Real x, Real y) {
    const Real rx = x - 64, ry = y - 64;
    return 1.3 * std::exp(-(rx * rx + ry * ry) / 800);
  }
  static Real u(Real x, Real y) {
    return 3 - vortex(x, y) * (y - 64) +
           0.3 * (std::sin(k * (2 * x + 3 * y)) + 0.5 * std::cos(k * (5 * x - y)));
  }
  static Real v(Real x, Real y) {
    return -2 + vortex(x, y) * (x - 64) +
           0.3 * (std::cos(k * (3 * x - 2 * y)) + 0.5 * std::sin(k * (x + 4 * y)));
  }
  static Real marker(Real x, Real y) {
    return std::exp(-(x - 50) * (x - 50) / 162 - (y - 70) * (y - 70) / 98);
  }
  // Staggered, sampled as the published scripts do: the means on the faces of what the centres
  // have.
  static Vector state(const FlowOptions& o) {
    FlowOptions centres = o;
    centres.arrangement = Arrangement::collocated;
    const Vector sampled = state_of(centres, u, v, marker);
    if (o.arrangement == Arrangement::collocated) return sampled;
    Vector state = sampled;
    const Index n = o.cells();
    weigh(o.N, 0.5, 0.5, Side::left, sampled.head(n), state.head(n));
    weigh(o.N, 0.5, 0.5, Side::below, sampled.segment(n, n), state.segment(n, n));
    return state;
  }
};

// Of every quantity, (3N²).
Vector noise_of(const FlowOptions& o, std::string_view purpose) {
  RandomStream stream(0, "flow", purpose);
  return stream.normal_vector(3 * o.cells());
}

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
  const auto law_of = [](const FlowOptions& o) { return refusal([&] { check(o); }); };
  EXPECT_EQ(law_of({}), "");
  EXPECT_TRUE(law_of({.N = 63}).ends_with("at least 4, got 63"));
  EXPECT_TRUE(law_of({.dt = -1}).ends_with("must be above 0, got -1"));
  EXPECT_TRUE(law_of({.viscosity = -2}).ends_with("at least 0, got -2"));
  EXPECT_TRUE(law_of({.viscosity = 5}).ends_with("Δx²/(4Δt) = 4"));
}

// --- advection where displacements leave the lattice, where they are no numbers, and its
// transpose; the sums of neighbours that displacements are

// A point that moves by whole periods more comes from the same place; of 12 cells a margin is wider
// than half, of 16 four go into a row.
TEST(Advection, GoesByPeriods) {
  for (const Index N : {6, 12, 16}) {
    Advection advection(N);
    RandomStream stream(0, "test", "periods");
    const Vector q = stream.normal_vector(N * N), dx = 2 * stream.normal_vector(N * N);
    const Vector dy = 2 * stream.normal_vector(N * N), u = stream.normal_vector(N * N);
    const auto turns = static_cast<Real>(3 * N);
    const Vector far_dx = dx.array() + turns, far_dy = dy.array() - turns;
    Vector near(N * N), far(N * N);
    Matrix pulled = Matrix::Zero(N * N, 3), far_pulled = pulled;
    advection.trace(dx, dy);
    advection.value(q, near);
    advection.pullback(q, u, pulled.col(0), pulled.col(1), pulled.col(2));
    advection.trace(far_dx, far_dy);
    advection.value(q, far);
    advection.pullback(q, u, far_pulled.col(0), far_pulled.col(1), far_pulled.col(2));
    EXPECT_LE((far - near).norm(), 1e-12 * near.norm()) << N;
    EXPECT_LE((far_pulled - pulled).norm(), 1e-12 * pulled.norm()) << N;
  }
}

TEST(Advection, ByWhatIsNoNumberIsNone) {
  constexpr Index N = 8;
  Advection advection(N);
  Vector still = Vector::Zero(N * N), q = Vector::Ones(N * N), out(N * N);
  for (const Real lost : {std::nan(""), 1e300}) {
    Vector dx = still;
    dx[9] = lost;
    advection.trace(dx, still);
    advection.value(q, out);
    EXPECT_EQ(out[40], 1) << "far from there nothing is lost";
  }
  Vector dx = still;
  dx[9] = std::nan("");
  advection.trace(dx, still);
  advection.value(q, out);
  EXPECT_TRUE(std::isnan(out[9]));
}

// By sums to rounding, of rows that four go into and of others, and where the clamp holds: q is
// noise.
TEST(Advection, PullsBackTheTransposeOfWhatItPushes) {
  for (const Index N : {4, 6, 7, 9, 16}) {
    Advection advection(N);
    RandomStream stream(0, "test", "transpose", static_cast<std::uint64_t>(N));
    const auto draw = [&] { return stream.normal_vector(N * N); };
    const Vector q = draw(), dx = draw(), dy = draw(), u = draw();
    const Vector vq = draw(), vdx = draw(), vdy = draw();
    Vector pushed(N * N);
    advection.trace(dx, dy);
    advection.pushforward(q, vq, vdx, vdy, pushed);
    Matrix pulled = Matrix::Ones(N * N, 3);  // to which it is added
    advection.pullback(q, u, pulled.col(0), pulled.col(1), pulled.col(2));
    pulled.array() -= 1;
    const Real there = u.dot(pushed);
    const Real back = pulled.col(0).dot(vq) + pulled.col(1).dot(vdx) + pulled.col(2).dot(vdy);
    EXPECT_NEAR(there, back, 1e-13 * u.norm() * pushed.norm() * static_cast<Real>(N)) << N;
    const Matrix first = pulled;
    pulled.setZero();
    advection.pullback(q, u, pulled.col(0), pulled.col(1), pulled.col(2));
    EXPECT_LE((pulled - first).norm(), 1e-13 * first.norm()) << "the call before left something";
  }
}

TEST(SquaresOfNeighbours, AreSumsOfSums) {
  constexpr Index N = 6;
  RandomStream stream(0, "test", "squares");
  const Vector q = stream.normal_vector(N * N);
  Vector row(N * N), twice(N * N);
  for (const Side across : {Side::left, Side::right})
    for (const Side along : {Side::below, Side::above}) {
      weigh(N, 1, 1, along, q, row);
      weigh(N, 0.3, 0.3, across, row, twice);
      Vector once = q;
      add_square(N, 0.3, across, along, q, once);
      EXPECT_LE((once - q - twice).norm(), 1e-15 * (q.norm() + twice.norm()));
    }
}

}  // namespace
}  // namespace isoline::problems
