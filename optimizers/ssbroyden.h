// The self-scaled update of Broyden's family for H, an inverse Hessian.
#pragma once

#include "core/array.h"

namespace isoline::optimizers {

// H ← (H − H y yᵀ H/(yᵀ H y) + φ v vᵀ)/τ + s sᵀ/(yᵀ s), v = √(yᵀ H y) (s/(yᵀ s) − H y/(yᵀ H y)), so
// that H y = s; φ and τ by Al-Baali, Khalfan (2005) as Urbán, Stefanou, Pons (2025) have them.
// `bend` is sᵀ H⁻¹ s, which a search along −H g knows. (n, n); s, y (n); yᵀ s > 0. `Hy` and `v` are
// scratch arrays (n).
void update_self_scaled(Matrix& H, const Vector& s, const Vector& y, Real bend, Vector& Hy,
                        Vector& v);

}  // namespace isoline::optimizers
