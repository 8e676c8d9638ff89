// MacCormack advection of a quantity q on a periodic N×N lattice by displacements d, in cells a
// step, given at the lattice's own points; Selle, Fedkiw, Kim, Liu, Rossignac (2008), and PhiFlow:
//
//   s(p) = q(p − d(p)),  r(p) = s(p) + ½ (q(p) − s(p + d(p))),  q' = clamp(r, min, max),
//
// values between points bilinear, min and max of q over the four nodes around p − d(p).
//
// Derivatives are those of the pieces: where the clamp holds, q' is the value of one node, and of
// two equal nodes the earlier, in the order of x; r on its limit counts as free. q' is continuous
// in d except where the clamp holds and p − d crosses from one cell of the lattice to another.
#pragma once

#include "core/array.h"
#include "core/workspace.h"
#include "problems/physics/lattice.h"

namespace isoline::problems {

// Owns its work space: use one object per thread. trace() sets the displacements of the points,
// (N²) each; all other functions refer to the last trace.
class Advection {
 public:
  explicit Advection(Index N);

  void trace(VectorRef dx, VectorRef dy);
  // rows(j)(i): of four points, from the i-th of row j on.
  template <class Rows>
  void trace(const Rows& rows) {
    if (!trace_near(rows)) trace_far(rows);
  }

  // All (N²).
  void value(VectorRef q, VectorOut out);  // q'
  void pushforward(VectorRef q, VectorRef vq, VectorRef vdx, VectorRef vdy, VectorOut out);
  // Adds to the cotangents of q, dx, dy those of a cotangent u of q'.
  void pullback(VectorRef q, VectorRef u, VectorOut of_q, VectorOut of_dx, VectorOut of_dy);

  // Between which nodes each point lies, and which limit holds.
  void add_choices(VectorRef q, PieceDigest& digest);

 private:
  // Where the points of the lattice come from, or go to.
  struct Points {
    Eigen::VectorXi
        way;      // (N²) on the padded lattice, to the lower left of the four around a place
    Vector a, b;  // (N²) how far the place lies from there in x and in y, in [0, 1]
  };
  class Places;
  template <class Rows>
  bool trace_near(const Rows& rows);  // back_ and ahead_; false: some lie beyond the margin
  template <class Rows>
  void trace_far(const Rows& rows);
  void keep_far(Index i, Index j, Real x, Real y, Points& out) const;
  void interpolate(VectorRef q);  // s, and the limits of r
  void pull_correction(VectorRef u, Vector& into_q, Vector& into_s, VectorOut of_dx,
                       VectorOut of_dy);
  void pull_interpolation(const Vector& into_s, VectorOut of_dx, VectorOut of_dy);

  Index N_;
  LatticeMargin margin_;
  Index stride_;                    // N and both margins
  Points back_, ahead_;             // p − d and p + d
  Vector least_, most_;             // (N²) of q over the four nodes around p − d
  Vector q_, s_, tangent_, moved_;  // (stride²) padded
  Vector pairs_;                    // (2 stride²) of LatticeMargin::settle
};

// Points for inner loops: pointers that stores in the loop cannot change.
class Advection::Places {
 public:
  explicit Places(Points& points)
      : way_(points.way.data()), a_(points.a.data()), b_(points.b.data()) {}

  void keep(Index p, const Four& ways, const Four& a, const Four& b) const {
    put_ways(ways, way_ + p);
    put(a, a_ + p);
    put(b, b_ + p);
  }
  const int* way(Index p) const { return way_ + p; }
  Four a(Index p) const { return four_at(a_ + p); }
  Four b(Index p) const { return four_at(b_ + p); }

 private:
  int* way_;
  Real *a_, *b_;
};

// The way back is measured from where it ends: −d lies between −⌈d⌉ and 1 − ⌈d⌉.
template <class Rows>
bool Advection::trace_near(const Rows& rows) {
  const Real stride = static_cast<Real>(stride_), reach = static_cast<Real>(LatticeMargin::kReach);
  auto are_near = Four{} == 0;  // a mask
  const Places back(back_), ahead(ahead_);
  for (Index j = 0; j < N_; ++j) {
    const auto row = rows(j);
    margin_.by_fours_of_row(j, [=, &are_near](Index i, Index p) {
      const auto [x, y] = row(i);
      are_near &= (size_of(x) <= reach) & (size_of(y) <= reach);
      const Four left = floor_of(x), lower = floor_of(y);
      const Four right = ceiling_of(x), upper = ceiling_of(y);
      ahead.keep(p, left + stride * lower, x - left, y - lower);
      back.keep(p, -right - stride * upper, right - x, upper - y);
    });
  }
  return are_near[0] && are_near[1] && are_near[2] && are_near[3];
}

template <class Rows>
void Advection::trace_far(const Rows& rows) {
  for (Index j = 0; j < N_; ++j) {
    const auto row = rows(j);
    margin_.by_fours_of_row(j, [&](Index i, Index) {
      const auto [x, y] = row(i);
      for (Index k = 0; k < 4; ++k) {
        keep_far(i + k, j, -x[k], -y[k], back_);
        keep_far(i + k, j, x[k], y[k], ahead_);
      }
    });
  }
}

}  // namespace isoline::problems
