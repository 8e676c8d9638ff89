// Who leads, on what was asked of each, by how much, and how sure that is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/read/comparison.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {

// Counts for each optimizer, sorts all that is stored by optimizer, best first, and draws the
// profiles. Needs the cells aggregated.
void fill_standings(Comparison& comparison);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

struct Scored {
  std::size_t optimizer = 0;
  Real score = 0;  // area of its profile up to kProfileEnd, among those compared
  std::size_t solved = 0, wins = 0, problems = 0;
};

// By how much the first is ahead of the second: the first screen of the page.
struct Lead {
  std::vector<Scored> ranked;  // best first
  Real stays_first = 0;        // share of resamplings of the problems
  // The median over problems of the second's work over the first's, with 95 % of the bootstrap over
  // problems. A failure counts as infinite; problems that neither solves are left out.
  Real factor = kNever;
  Interval interval;
  std::size_t compared = 0;  // problems of the factor
};

// Among all, or among those without privileges alone; nothing where none of them solves anything.
std::optional<Lead> lead_of(const Comparison& comparison, bool is_open);

}  // namespace isoline::reports
