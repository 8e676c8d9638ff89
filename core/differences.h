// The noise in the values of a function, and the steps of differences that follow from it.
#pragma once

#include <functional>

#include "core/array.h"

namespace isoline {

// The noise in values of f, by ECNoise: difference tables of kNoiseCalls values along a line, from
// which the values of a smooth function vanish; Moré, Wild (2011), SIAM J. Sci. Comput. 33, section
// 5. `f`: t -> (m). The standard deviation per component; 0 where none is found. Where the spacing
// is too small or too large for a result, it is changed, at most `kNoiseSpacings` times.
inline constexpr int kNoiseCalls = 7, kNoiseSpacings = 4;
Vector noise_of_values(const std::function<Vector(Real t)>& f);

// Steps relative to the size of an unknown, for a function whose derivatives are those of y over
// that size: h = 8^¼ √ε of forward, and (3ε)^⅓ of central differences, with the relative noise ε;
// Moré, Wild (2012), ACM TOMS 38.
Real forward_step(Real noise);
Real central_step(Real noise);

// The size of each unknown: |x₀|, or that of the largest, at most 1, where x₀ = 0.
Vector sizes_of_unknowns(const Vector& start);

}  // namespace isoline
