// Explicit viscosity of one component, v' = v + r ∇²v by the five-point difference on the periodic
// grid, r = ν Δt / Δx² ≤ ¼ for stability. Symmetric: its own pushforward and pullback.
#pragma once

#include "problems/physics/neighbours.h"

namespace isoline::problems {

constexpr Real kMostViscous = 0.25;  // r

// In place, through `scratch` (N²).
inline void diffuse(Index N, Real r, VectorOut v, Vector& scratch) {
  scratch = v;
  v *= 1 - 4 * r;
  for (const Side side : {Side::left, Side::right, Side::below, Side::above})
    add_weighed(N, 0, r, side, scratch, v);
}

}  // namespace isoline::problems
