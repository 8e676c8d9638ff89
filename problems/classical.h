// What the problems of Moré, Garbow and Hillstrom (1981) share: y* = 0, P(x) = f(x) as they define
// it, L = ½ Σ fᵢ², so half the figures that are published for Σ fᵢ². They are posed as
// minimization: what their user wants is a small loss, which is an entry's standard aim.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

// `minimizers` (k, count), one a column; the first counts as the truth.
ProblemParts classical(std::unique_ptr<Physics> f, const Vector& start, const Draw& draw,
                       Real minimum, const Matrix& minimizers);

Real distance_to_nearest(BatchRef x, const Matrix& minimizers);

}  // namespace isoline::problems
