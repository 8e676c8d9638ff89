// Differences of two subjects in status and figures, and of results that hang on the last bit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/compare/subject.h"

namespace isoline::reports {

enum class Change { worse, better, changed };

struct Difference {
  Change change = Change::changed;
  std::string key, title, problem, optimizer, what;
  std::string before, after;  // as shown
  Real relative = 0;          // (after − before) / |before|; infinite where that says nothing
  std::string note;
  std::string cause;         // why the two may differ
  bool is_rounding = false;  // so small that another order of summation explains it
};

Difference state_difference(const Subject& before, const Subject& after);

// The least tolerance within which the figures of the two agree; infinite where one is finite and
// the other is not, or where their status differs.
Real movement(const Subject& before, const Subject& after);

// The largest difference of each group of quantities and direction. Without a tolerance figures
// agree if they are the same number; with one if they differ by no more than rounding, 1e-16 of
// the problem's scale, and that share of the first, or of 1e-6 of the scale where that is more:
// what is smaller solves the problem to the strictest target of the tables.
std::vector<Difference> quantity_differences(const Subject& before, const Subject& after,
                                             const std::optional<Real>& tolerance);

// Results that hang on the last bit of their start: rounding, and so another processor or library,
// moves them as it likes. What of them can still be judged is how they end and what they reach.

// What the runs from perturbed starts did that are held to one from the given start.
Perturbed perturbed_of(const Subject& unperturbed, const std::vector<Subject>& perturbed);

// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const Subject& subject, const std::optional<Real>& tolerance);

// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
std::vector<Difference> coarse_differences(const Subject& before, const Subject& after);

}  // namespace isoline::reports
