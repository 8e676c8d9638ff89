// Which methods rank where and what that is worth: sentences, tables and plots, all of them derived
// from one decision.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/results/ranking.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

// Two methods over the families of problems that both were run on and one of them solves.
struct Pairing {
  // log2(cost of a / cost of b) a family, the median over its settings: within ±log2 kProfileEnd,
  // which is also what solving against not solving counts; 0 on a setting that neither solves.
  std::vector<Real> doublings;
  std::size_t wins = 0, losses = 0, ties = 0;  // of a, over families
  std::size_t neither = 0;                     // families that neither solves

  Real typical() const;  // what b costs as a multiple of what a costs: 2^(−median); 1 of nothing
  std::array<Real, 2> interval() const;  // of it: 95 % of that median
};
using Families = std::vector<std::vector<std::size_t>>;  // rows of costs
Pairing pairing_of(const Costs& costs, const Families& families, std::size_t a, std::size_t b);

struct MethodPair {
  std::size_t a = 0, b = 0;  // optimizers, a < b
  Pairing pairing;
};
// At the tightest tolerance by what the yardstick counts, over the problems that are not learned.
std::vector<MethodPair> all_pairs(const Comparison& comparison);

// "with profile end 256", "to accuracy 1e-3", "by wall time", "without heat", "with seed 2".
std::string choice_text(const Choice& choice);

// A sentence: which methods were run on some of the common settings only; empty where none was.
std::string unranked_sentence(const Comparison& comparison);

// 95 % over families of each optimizer's score, or its range over few; infinite where not ranked.
std::vector<Interval> score_intervals(const Comparison& comparison);

}  // namespace isoline::reports
