// Common parts of the problems of Moré, Garbow and Hillstrom (1981): y* = 0, P(x) = f(x) as in the
// paper, L = ½ Σ fᵢ², half of the published Σ fᵢ². They are minimization problems: the success
// criterion is a small loss, the default of an entry.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

// `minimizers` (k, count), one per column; the first counts as the truth.
ProblemParts classical(std::unique_ptr<Physics> f, const Vector& start, const Draw& draw,
                       Real minimum, const Matrix& minimizers);

Real distance_to_nearest(BatchRef x, const Matrix& minimizers);

}  // namespace isoline::problems
