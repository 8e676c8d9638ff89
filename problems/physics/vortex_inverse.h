// The published inverse of the fluid experiment, an estimate by how the data are made: Holl,
// Koltun, Thuerey (2022), published scripts. The translation is known from the first marker alone,
// for it brings the marker to the middle, c₀ → M within T. The vortex, around the middle and of
// known width, has the strength that x₀ has, and Δω more: the prediction is simulated forward,
// c_f(n) the centre of its marker after n of S steps, and from its end back with the marker
// observed, c_r(n);
//
//   x = (M − c₀)/T + vortex(ω(x₀) + Δω),  Δω = 10⁻³ mean of
//   (c_f(S) − c_T) × (c_T − s(S)),  (c_f(S−1−i) − c_r(i+1)) × (c_r(i+1) − s(S−1−i)),  i < S
//
// with s(n) = M + (M − c₀) n/S along the way. The scripts have s(n) = M + (M − c₀) n/T for all but
// the first, a missing Δt: Track::published. Its fluctuations are not estimated.
#pragma once

#include "problems/physics/simulation.h"

namespace isoline::problems {

enum class Track { consistent, published };

class VortexInverse {
 public:
  VortexInverse(Index N, Index steps, Real time, Track track)
      : N_(N), steps_(steps), time_(time), track_(track) {}

  // x0 and x (2N²) at the centres. False, and x = x0, where a marker is empty or the flow blows up.
  bool invert(Simulation& flow, VectorRef x0, VectorRef first, VectorRef last, VectorOut x);

 private:
  Real missing_strength(const Eigen::Vector2d& c0, const Eigen::Vector2d& cT) const;  // Δω

  Index N_, steps_;
  Real time_;
  Track track_;
  FlowRun forward_, back_;
};

}  // namespace isoline::problems
