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

 private:
  // Where the points of one row of the lattice come from, or go to. Row by row all that is needed
  // at once stays in the first cache.
  struct Row {
    Eigen::VectorXi node;  // (N) lower left of the four around a point, in a padded grid
    Vector a, b;           // (N) how far it lies from there in x and in y, in [0, 1)
  };
  void trace(Index j, VectorRef dx, VectorRef dy, Real sign, Row& out) const;
  void interpolate(VectorRef q, VectorRef dx, VectorRef dy);  // s
  void pad(VectorRef q, VectorOut padded) const;
  void wrap(VectorOut padded) const;                // fills the last two rows and columns
  void unpad(VectorOut padded, VectorOut q) const;  // the transpose of pad, added to q
  void fold(VectorOut padded) const;                // the transpose of wrap

  Index N_, stride_;                // N, N + 2
  Row back_, ahead_;                // of p − d and p + d
  Eigen::VectorXi cell_;            // (N²) the nodes of p − d, all rows
  Vector q_, s_, tangent_, moved_;  // ((N + 2)²) padded: no neighbour needs a modulus
};

}  // namespace isoline::problems
