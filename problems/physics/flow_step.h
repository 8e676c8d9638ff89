// One step of the incompressible flow and its passive marker, as published by Holl, Koltun, Thuerey
// (2022), scripts of the fluid experiment:
//
//   v ← advection of v by v;  v ← projection of v;  each component back to its energy;
//   v ← v + νΔt ∇²v (ν = 0 as published);  m ← advection of m by the new v.
//
// Staggered, u lies on the left faces of the cells and v on the lower ones: each is advected on its
// own lattice with the mean of the four faces around of the other, the marker with means of two.
// Collocated, all lie at the centres. Viscosity follows the rescaling, which would undo it.
#pragma once

#include "problems/physics/advection.h"
#include "problems/physics/projection.h"

namespace isoline::problems {

struct FlowOptions {
  Index N = 64;
  Real length = 128;  // of the domain's side
  Real dt = 0.25, viscosity = 0;
  Arrangement arrangement = Arrangement::staggered;
  bool rescales = true;  // each component to its energy

  Index cells() const { return N * N; }
  Real dx() const { return length / static_cast<Real>(N); }
};

// UsageError for an odd or small grid, a step or viscosity below 0, or a viscosity that is too
// large for its explicit step.
void check(const FlowOptions& options);

// A state is u, v and m one after the other, (3N²). Owns its work space: one a thread.
class FlowStep {
 public:
  explicit FlowStep(const FlowOptions& options);

  // `projected` is what the derivatives need besides: u and v before the rescaling, (2N²).
  void forward(VectorRef state, VectorOut next, VectorOut projected);
  void pushforward(VectorRef state, VectorRef next, VectorRef projected, VectorRef tangent,
                   VectorOut out);
  // From the cotangent of `next` to that of `state`, in place.
  void pullback(VectorRef state, VectorRef next, VectorRef projected, VectorOut cotangent);

  // Of the advections on the way from `state` to `next`, which alone have kinks.
  void add_choices(VectorRef state, VectorRef next, PieceDigest& digest);

  Projection& projection() { return projection_; }

 private:
  // The displacements of one of the three quantities, from the velocity (2N²): as they are needed,
  // told to the advection, or stored; and the transpose.
  template <class Visit>
  void displaced(Index which, VectorRef velocity, const Visit& visit) const;
  void trace(Index which, VectorRef velocity);
  void displace(Index which, VectorRef velocity, Vector& dx, Vector& dy) const;
  void add_displaced(Index which, VectorRef dx, VectorRef dy, VectorOut velocity);

  FlowOptions options_;
  Index cells_;  // N²
  Advection advection_;
  Projection projection_;
  Vector vdx_, vdy_, scratch_;  // (N²)
  Vector before_;               // (3N²) the cotangent of the state, as it is gathered
};

}  // namespace isoline::problems
