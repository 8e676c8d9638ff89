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
#include "core/pieces.h"
#include "problems/physics/lattice_margin.h"

namespace isoline::problems {

// Owns its work space: one a thread.
class Advection {
 public:
  explicit Advection(Index N);

  // All (N²).
  void value(VectorRef q, VectorRef dx, VectorRef dy, VectorOut out);  // q'
  void pushforward(VectorRef q, VectorRef dx, VectorRef dy, VectorRef vq, VectorRef vdx,
                   VectorRef vdy, VectorOut out);
  // Adds to the cotangents of q, dx, dy those of a cotangent u of q'.
  void pullback(VectorRef q, VectorRef dx, VectorRef dy, VectorRef u, VectorOut of_q,
                VectorOut of_dx, VectorOut of_dy);

  // Between which nodes each point lies, and which limit holds.
  void add_choices(VectorRef q, VectorRef dx, VectorRef dy, PieceDigest& digest);

 private:
  // Where the points of the lattice come from, or go to.
  struct Points {
    Eigen::VectorXi node;  // (N²) lower left of the four around a point, in the padded lattice
    Vector a, b;           // (N²) how far it lies from there in x and in y, in [0, 1]
  };
  class Places;
  bool trace(VectorRef dx, VectorRef dy);  // back_ and ahead_; false: some lie beyond the margin
  void trace_far(VectorRef dx, VectorRef dy, Real sign, Points& out) const;
  void interpolate(VectorRef q, VectorRef dx, VectorRef dy);  // s, and the limits of r
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

}  // namespace isoline::problems
