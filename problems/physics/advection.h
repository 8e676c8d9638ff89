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

  // All (N²). What follows is taken at this q and d.
  void prepare(VectorRef q, VectorRef dx, VectorRef dy);
  void value(VectorOut out) const;  // q'
  void pushforward(VectorRef vq, VectorRef vdx, VectorRef vdy, VectorOut out);
  // Adds to the cotangents of q, dx, dy those of a cotangent u of q'.
  void pullback(VectorRef u, VectorOut q, VectorOut dx, VectorOut dy);

 private:
  struct Trace {
    Eigen::VectorXi node;  // (N²) lower left of the four around a point, in a padded grid
    Vector a, b;           // (N²) how far it lies from there in x and in y, in [0, 1)
  };
  static Trace sized(Index N) { return {Eigen::VectorXi(N * N), Vector(N * N), Vector(N * N)}; }
  void trace(VectorRef dx, VectorRef dy, Real sign, Trace& out) const;
  void pad(VectorRef q, Vector& padded) const;
  void wrap(Vector& padded) const;                // fills the last two rows and columns
  void unpad(Vector& padded, VectorOut q) const;  // the transpose of pad, added to q
  void fold(Vector& padded) const;                // the transpose of wrap

  Index N_, stride_;                // N, N + 2
  Trace back_, ahead_;              // of p − d and p + d
  Vector q_, s_, tangent_, moved_;  // ((N + 2)²) padded: no neighbour needs a modulus
  Vector places_;                   // (N) 0 … N − 1
};

}  // namespace isoline::problems
