// Differences by cause and optimizer: one line says what became of all its cells.
#pragma once

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

}  // namespace isoline::reports
