// Random fields on an N×N grid of unit cells: the truths x* of the grid problems.
#pragma once

#include "core/random.h"

namespace isoline::problems {

// White noise on the periodic grid, its mode n multiplied by |κ|^(−2·smoothness), κ = n·scale/N,
// and by 0 where |κ|² ≤ 0.1; then of mean 0 and standard deviation 1. (N²)
Vector smooth_noise(Index N, Real scale, Real smoothness, RandomStream& stream);

}  // namespace isoline::problems
