// Differences by cause and optimizer, and the part of a build or the option that explains them.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "reports/compare/differences.h"

namespace isoline::reports {

// The cells of one optimizer, or of it on one problem, that changed in one direction for one
// reason.
struct DifferenceGroup {
  Change change = Change::changed;
  std::string cause, optimizer;
  std::map<std::string, std::set<std::string>> problems;  // keys of cells, by problem
  std::size_t cells = 0, of = 0;                          // so many of those that both sides have
  std::vector<std::string> what;                          // status, loss, …
  Difference worst;                                       // the first of them
};

// The differences come worst first, and so do the groups; what rounding explains is in none.
// `sizes`: cells in both, by optimizer. Where they are told by problem too, of how many is 0.
std::vector<DifferenceGroup> grouped(const std::vector<Difference>& differences,
                                     const std::map<std::string, std::size_t>& sizes);
std::vector<DifferenceGroup> grouped_by_problem(const std::vector<Difference>& differences);

// Cells that are on one side only, by optimizer; of how many that side has.
struct LackGroup {
  std::string optimizer;
  std::size_t cells = 0, of = 0;
  std::set<std::string> problems;
  std::string first;  // the title of one
};
std::vector<LackGroup> grouped(const std::vector<const Subject*>& lacking,
                               const std::vector<Subject>& side);

std::string share_text(std::size_t cells, std::size_t of);  // "all 26", "3 of 26"

// Why cells differ, in groups: what a reader of a comparison sees first.

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
std::string words_of(const CauseGroup& group);

// Cells that both sides have, each with a seed, budget or threads of its own.
struct OtherTerms {
  std::string what;  // "iterations 20 → 30"
  std::size_t cells = 0;
  std::set<std::string> optimizers;
  std::string first;  // the title of one
};

// Of what is left unpaired, by what differs; the subjects that are told so are taken out of both.
std::vector<OtherTerms> asked_otherwise(std::vector<const Subject*>& only_before,
                                        std::vector<const Subject*>& only_after);

}  // namespace isoline::reports
