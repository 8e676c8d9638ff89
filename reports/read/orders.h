// Orders over problems: ranks, ratios, and how far they can be told from chance.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

// Ranks of the methods of the common order by name of problem, in the order of order.methods:
// settings of one problem are no two witnesses, so their ranks are averaged and ranked again.
std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& comparison, Measure by);

// Friedman's p over these ranks, of the methods that apply to most of the settings.
Real friedman_of(const Comparison& comparison);

// Minus the digits gained on each problem given to an optimizer, of a ranked one the common ones,
// at the best point seen or at the one returned: the median over seeds. A failed run gains none,
// which is infinitely few.
std::vector<Real> lacking_digits(const Comparison& comparison, std::size_t optimizer,
                                 Real Summary::*loss);
Real lacking_digits(const Comparison& comparison, const Cell& cell, Real Summary::*loss);

// Signed ranks on the log-ratios of work of all pairs of the first k, adjusted after Holm.
struct RankedPair {
  std::size_t a = 0, b = 0;
  Real p = 1, adjusted = 1;
  std::size_t wins = 0, n = 0;  // problems on which a needs less; problems given to both
};
struct SignedRanks {
  std::vector<RankedPair> pairs;  // a < b, in order
  std::size_t told = 0;           // apart at kSignificant
  Real least = kNever;            // adjusted p
};
SignedRanks signed_ranks(const Comparison& comparison, std::size_t k);

}  // namespace isoline::reports
