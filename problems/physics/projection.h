// The projection of a periodic velocity onto those without divergence, v − ∇ (∇·∇)⁻¹ ∇·v, exact for
// the differences of its arrangement: one spectral solve of the discrete Poisson equation, with
//
//   staggered    ∇·v between faces,   symbol −4 (sin² ½kₓ + sin² ½k_y)
//   collocated   central differences, symbol −(sin² kₓ + sin² k_y), which has four null modes
//
// in units of a cell. Null modes are left as they are. The gradient is minus the transpose of the
// divergence, so that the projection is symmetric: it is its own pushforward and pullback.
#pragma once

#include "core/fourier.h"

namespace isoline::problems {

enum class Arrangement { staggered, collocated };

// Owns its work space: one a thread.
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

}  // namespace isoline::problems
