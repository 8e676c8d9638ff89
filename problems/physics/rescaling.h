// One component of the velocity brought back to the energy it had before advection and projection,
// v' = v √(Σ v₀² / Σ v²): by this the published solver keeps the energy of each component. The
// velocity is then free of divergence no longer, for the components have factors of their own.
#pragma once

#include "core/array.h"

namespace isoline::problems {

// 0 where there is no energy to scale, with derivatives 0.
struct Rescaling {
  Real before, after, factor;  // Σ v₀², Σ v², √(Σ v₀² / Σ v²)

  Rescaling(VectorRef v0, VectorRef v);
  // v' along (t₀, t), t in place.
  void pushforward(VectorRef v0, VectorRef v, VectorRef t0, VectorOut t) const;
  // The cotangent u of v' becomes that of v in place; that of v₀ is added to u0.
  void pullback(VectorRef v0, VectorRef v, VectorOut u, VectorOut u0) const;
};

}  // namespace isoline::problems
