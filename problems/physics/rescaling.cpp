// The energy kept, and what that does to derivatives: with φ the factor, ∂φ/∂v = −φ v / Σ v² and
// ∂φ/∂v₀ = φ v₀ / Σ v₀².
#include "problems/physics/rescaling.h"

#include <cmath>

namespace isoline::problems {

Rescaling::Rescaling(VectorRef v0, VectorRef v)
    : before(v0.squaredNorm()), after(v.squaredNorm()), factor(0) {
  if (after != 0) factor = std::sqrt(before / after);  // nan stays nan
}

void Rescaling::pushforward(VectorRef v0, VectorRef v, VectorRef t0, VectorOut t) const {
  if (factor == 0) {
    t.setZero();
    return;
  }
  const Real change = factor * (v0.dot(t0) / before - v.dot(t) / after);
  t = factor * t + change * v;
}

void Rescaling::pullback(VectorRef v0, VectorRef v, VectorOut u, VectorOut u0) const {
  if (factor == 0) {
    u.setZero();
    return;
  }
  const Real change = factor * u.dot(v);
  u0 += (change / before) * v0;
  u = factor * u - (change / after) * v;
}

}  // namespace isoline::problems
