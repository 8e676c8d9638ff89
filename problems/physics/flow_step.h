// Explicit viscosity of one component, v' = v + r ∇²v by the five-point difference on the periodic
// grid, r = ν Δt / Δx² ≤ ¼ for stability. Symmetric: its own pushforward and pullback.
#pragma once

#include "core/array.h"
#include "core/fourier.h"
#include "problems/physics/advection.h"

namespace isoline::problems {

constexpr Real kMostViscous = 0.25;  // r

// In place, through `scratch` (N²).
inline void diffuse(Index N, Real r, VectorOut v, Vector& scratch) {
  scratch = v;
  v *= 1 - 4 * r;
  for (const Side side : {Side::left, Side::right, Side::below, Side::above})
    add_weighed(N, 0, r, side, scratch, v);
}

// The projection of a periodic velocity onto those without divergence, v − ∇ (∇·∇)⁻¹ ∇·v, exact for
// the differences of its arrangement: one spectral solve of the discrete Poisson equation, with
//
//   staggered    ∇·v between faces,   symbol −4 (sin² ½kₓ + sin² ½k_y)
//   collocated   central differences, symbol −(sin² kₓ + sin² k_y), which has four null modes
//
// in units of a cell. Null modes are left as they are. The gradient is minus the transpose of the
// divergence, so that the projection is symmetric: it is its own pushforward and pullback.

enum class Arrangement { staggered, collocated };

// Owns its work space: use one object per thread.
class Projection {
 public:
  Projection(Index N, Arrangement arrangement);

  void divergence(VectorRef u, VectorRef v, VectorOut out) const;  // (N²), per cell width
  void apply(VectorOut u, VectorOut v);                            // in place

 private:
  Index N_;
  Arrangement arrangement_;
  RealFourier2d fourier_;
  Matrix inverse_;   // one over the symbol and a round trip, (N/2 + 1, N); 0 for null modes
  Vector pressure_;  // (N²)
};

// One component of the velocity brought back to the energy it had before advection and projection,
// v' = v √(Σ v₀² / Σ v²): by this the published solver keeps the energy of each component. The
// velocity is then free of divergence no longer, for the components have factors of their own.

// 0 where there is no energy to scale, with derivatives 0.
struct Rescaling {
  Real before, after, factor;  // Σ v₀², Σ v², √(Σ v₀² / Σ v²)

  Rescaling(VectorRef v0, VectorRef v);
  // v' along (t₀, t), t in place.
  void pushforward(VectorRef v0, VectorRef v, VectorRef t0, VectorOut t) const;
  // The cotangent u of v' becomes that of v in place; that of v₀ is added to u0.
  void pullback(VectorRef v0, VectorRef v, VectorOut u, VectorOut u0) const;
};

// One step of the incompressible flow and its passive marker, as published by Holl, Koltun, Thuerey
// (2022), scripts of the fluid experiment:
//
//   v ← advection of v by v;  v ← projection of v;  each component back to its energy;
//   v ← v + νΔt ∇²v (ν = 0 as published);  m ← advection of m by the new v.
//
// Staggered, u lies on the left faces of the cells and v on the lower ones: each is advected on its
// own lattice with the mean of the four faces around of the other, the marker with means of two.
// Collocated, all lie at the centres. Viscosity follows the rescaling, which would undo it.

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

// A state is u, v and m one after the other, (3N²). Owns its work space: use one object per thread.
class FlowStep {
 public:
  explicit FlowStep(const FlowOptions& options);

  // `projected` is what the derivatives need besides: u and v before the rescaling, (2N²).
  void forward(VectorRef state, VectorOut next, VectorOut projected);
  void pushforward(VectorRef state, VectorRef next, VectorRef projected, VectorRef tangent,
                   VectorOut out);
  // From the cotangent of `next` to that of `state`, in place.
  void pullback(VectorRef state, VectorRef next, VectorRef projected, VectorOut cotangent);

  // The differentiable pieces of the advections from `state` to `next`; all other parts are smooth.
  void add_choices(VectorRef state, VectorRef next, PieceDigest& digest);

  Projection& projection() { return projection_; }

 private:
  // The displacements of one of the three quantities, from the velocity (2N²): set in the advection
  // when needed, or stored; and the transpose.
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

// The flow of one sample over several steps, forward, with all derivatives, and backward in time.
// Checkpoints are the states between steps: what lies within a step its derivatives compute again,
// so that 8 steps of 64 samples on 64×64 cells keep 90 MB.

// The states of a run that its derivatives need, allocated by the first run.
struct FlowRun {
  Matrix states;     // (3N², steps + 1) u, v, m
  Matrix projected;  // (2N², steps)

  Eigen::Ref<const Vector> velocity(Index step) const {
    return states.col(step).head(states.rows() / 3 * 2);
  }
  Eigen::Ref<const Vector> marker(Index step) const {
    return states.col(step).tail(states.rows() / 3);
  }
};

// Owns its work space: use one object per thread. Derivatives and means are of the staggered
// arrangement; a collocated run makes data only.
class Simulation {
 public:
  Simulation(const FlowOptions& options, Index steps);

  // The first state from a velocity at the centres, x and then y, (2N²): staggered, its means on
  // the faces, projected; collocated, itself, as published.
  void begin(VectorRef centred, VectorRef marker, FlowRun& run);
  void begin_pushforward(VectorRef centred, VectorOut velocity);  // (2N²) -> (2N²)
  void begin_pullback(VectorOut velocity, VectorOut centred);     // `velocity` is spent

  void forward(FlowRun& run);  // from the first state
  // From a tangent of the first state to that of the last, in place, (3N²).
  void pushforward(const FlowRun& run, VectorOut tangent);
  void pullback(const FlowRun& run, VectorOut cotangent);  // from the last to the first, in place

  void add_choices(const FlowRun& run, PieceDigest& digest);

  // The same steps with the velocity of the last state turned round, and this marker at their
  // beginning: what was, if nothing was lost.
  void reverse(const FlowRun& run, VectorRef marker, FlowRun& back);

  // Means on the centres of a velocity on the faces, (2N²) -> (2N²).
  void centre(VectorRef velocity, VectorOut centred) const;

 private:
  void size(FlowRun& run) const;

  FlowOptions options_;
  Index cells_, steps_;
  FlowStep step_;
  Vector moved_;  // (3N²)
};

}  // namespace isoline::problems
