// Results that hang on the last bit of their start: rounding, and so another processor or library,
// moves them as it likes. What of them can still be judged is how they end and what they reach.
#pragma once

#include <optional>
#include <vector>

#include "reports/compare/differences.h"

namespace isoline::reports {

// What the runs from perturbed starts did that are held to one from the given start.
Perturbed perturbed_of(const Subject& unperturbed, const std::vector<Subject>& perturbed);

// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const Subject& subject, const std::optional<Real>& tolerance);

// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
std::vector<Difference> coarse_differences(const Subject& before, const Subject& after);

}  // namespace isoline::reports
