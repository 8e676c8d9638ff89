// Which subject of NEW answers which of BASE.
#pragma once

#include <utility>
#include <vector>

#include "reports/compare/subject.h"

namespace isoline::reports {

struct Pairs {
  std::vector<std::pair<const Subject*, const Subject*>> both;  // in the order of BASE
  std::vector<const Subject*> only_before, only_after;
};

// By their keys; then by what was asked, as typed, with its seed and budget, since a changed
// default or rate changes the key; then by the options given; then by title, where an older side
// tells no more. What two of a side have in common pairs neither. The subjects must outlive the
// pairs.
Pairs paired(const std::vector<Subject>& before, const std::vector<Subject>& after);

}  // namespace isoline::reports
