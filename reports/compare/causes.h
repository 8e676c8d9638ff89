// Differences in groups by cause: what a reader of a comparison sees first.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "reports/compare/differences.h"

namespace isoline::reports {

// A pair whose figures say nothing of each other.
struct Incomparable {
  std::string title, reason;
  std::string key, problem, optimizer;
};

// The cells that differ for one reason: what they were given, or the parts of the build that
// computed them; of those that cannot be compared why not. Cells count, not figures.
struct CauseGroup {
  std::string cause;
  std::set<std::string> cells, problems, optimizers;
  std::set<std::string> worse, better, changed;  // keys of cells, rounding apart
  std::size_t incomparable = 0;
  Real most_rounding = 0;  // the largest of the differences that rounding explains, relative

  std::size_t rounded() const;  // cells that differ by rounding alone
};

// Those with something worse first, then those that cannot be compared, then by their cells.
std::vector<CauseGroup> caused(const std::vector<Difference>& differences,
                               const std::vector<Incomparable>& incomparable);

// "51 cells of adam and gd on 12 problems: 3 worse, 48 by rounding alone (3e-15 at most)".
std::string cause_group_text(const CauseGroup& group);

// Cells that both sides have, each with a seed, budget or threads of its own.
struct OtherTerms {
  std::string what;  // "iterations 20 → 30"
  std::size_t cells = 0;
  std::set<std::string> optimizers;
};

// Groups unpaired subjects of one title by what differs in their terms, and takes them out of both.
std::vector<OtherTerms> take_other_terms(std::vector<const Subject*>& only_before,
                                         std::vector<const Subject*>& only_after);

}  // namespace isoline::reports
