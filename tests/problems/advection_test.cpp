// Advection where displacements leave the lattice, and where they are no numbers.
#include "problems/physics/advection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

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
    advection.value(q, dx, dy, near);
    advection.value(q, far_dx, far_dy, far);
    EXPECT_LE((far - near).norm(), 1e-12 * near.norm()) << N;
    Matrix pulled = Matrix::Zero(N * N, 3), far_pulled = pulled;
    advection.pullback(q, dx, dy, u, pulled.col(0), pulled.col(1), pulled.col(2));
    advection.pullback(q, far_dx, far_dy, u, far_pulled.col(0), far_pulled.col(1),
                       far_pulled.col(2));
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
    advection.value(q, dx, still, out);
    EXPECT_EQ(out[40], 1) << "far from there nothing is lost";
  }
  Vector dx = still;
  dx[9] = std::nan("");
  advection.value(q, dx, still, out);
  EXPECT_TRUE(std::isnan(out[9]));
}

}  // namespace
}  // namespace isoline::problems
