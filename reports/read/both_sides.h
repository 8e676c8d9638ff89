// Two results as one study: every method stands in it twice, "adam, BASE" and "adam, NEW".
#pragma once

#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

inline constexpr const char* kSides[] = {"BASE", "NEW"};

// Runs and sheets of both; of a problem's sheets NEW's. What was planned and has not run is told by
// neither.
Study study_of_both(Study before, Study after);

// Of such a study, which must outlive it: each method knows its side, and goes by the name that it
// has in both.
Comparison compare_sides(const Study& both);

// A method that both have, by its places in the comparison.
struct InBoth {
  std::string label;  // "adam"
  std::size_t before = 0, after = 0;
};
std::vector<InBoth> methods_in_both(const Comparison& comparison);

}  // namespace isoline::reports
