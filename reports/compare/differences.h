// Differences of two cells in status and figures, and of results that hang on the last bit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/compare/cells.h"

namespace isoline::reports {

enum class Change { worse, better, changed };

struct Difference {
  Change change = Change::changed;
  std::string key, title, problem, optimizer, what;
  std::string before, after;  // as shown
  Real relative = 0;          // (after − before) / |before|; infinite where that says nothing
  std::string note, cause;    // why the two may differ
  bool is_rounding = false;   // so small that another order of summation explains it
};
Difference difference_in(const ComparedCell& cell, Change change, const std::string& what,
                         const std::string& before, const std::string& after);

Difference status_difference(const ComparedCell& before, const ComparedCell& after);

// The least tolerance within which the figures of the two agree; infinite where one is finite and
// the other is not, or where their status differs.
Real movement(const ComparedCell& before, const ComparedCell& after);

// The largest difference of each quantity and direction, the parts of BASE that NEW lacks, and
// extra information that only one of them has. Without a tolerance, values agree if they are the
// same number; with one if they differ by no more than rounding, 1e-16 of the problem's scale, and
// that share of the first, or of 1e-6 of the scale where that is more: what is smaller solves the
// problem to the strictest target of the tables.
std::vector<Difference> figure_differences(const ComparedCell& before, const ComparedCell& after,
                                           const std::optional<Real>& tolerance);

// "f_L 0 → 1e-3, aim x → loss": what of the criteria differs, by more than the tolerance where
// there is one; empty where nothing does, or where one side does not hold it.
std::string criterion_change_text(const ComparedCell& before, const ComparedCell& after,
                                  const std::optional<Real>& tolerance);

// Results that hang on the last bit of their start: rounding, and so another processor or library,
// moves them as it likes. What of them can still be judged is how they end and what they reach.

// The results of the runs from perturbed starts, compared with one from the given start.
Perturbed perturbed_of(const ComparedCell& unperturbed, const std::vector<ComparedCell>& perturbed);

// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const ComparedCell& cell, const std::optional<Real>& tolerance);

// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
std::vector<Difference> coarse_differences(const ComparedCell& before, const ComparedCell& after);

}  // namespace isoline::reports
