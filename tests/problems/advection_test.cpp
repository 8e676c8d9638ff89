// Advection where displacements leave the lattice, where they are no numbers, and its transpose;
// the sums of neighbours that displacements are.
#include "problems/physics/advection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "problems/physics/lattice.h"

namespace isoline::problems {
namespace {

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
