// In what two subjects differ: status and figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/compare/subject.h"

namespace isoline::reports {

enum class Change { worse, better, changed };

struct Difference {
  Change change = Change::changed;
  std::string key, title, what;
  std::string before, after;  // as shown
  Real relative = 0;          // (after − before) / |before|; infinite where that says nothing
  std::string note;
};

Difference state_difference(const Subject& before, const Subject& after);

// The least tolerance within which the figures of the two agree; infinite where one is finite and
// the other is not, or where their status differs.
Real movement(const Subject& before, const Subject& after);

// The largest difference of each group of quantities and direction. Without a tolerance figures
// agree if they are the same number; with one if they differ by no more than that share of the
// first, or by rounding, 1e-16 of the value at the start.
std::vector<Difference> quantity_differences(const Subject& before, const Subject& after,
                                             const std::optional<Real>& tolerance);

}  // namespace isoline::reports
