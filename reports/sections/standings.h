// The lead of an order in words, the same on every screen: the deeds of the first, how it stands to
// the next, whether that is settled, and what these data could have shown.
#pragma once

#include <string>
#include <vector>

#include "core/results/statistics.h"
#include "reports/read/comparison.h"

namespace isoline::reports {

struct MethodPair {
  std::size_t a = 0, b = 0;  // optimizers
  Pairing pairing;
};

// At the tightest tolerance by what the yardstick counts, over the problems given to both that are
// not learned; a < b.
std::vector<MethodPair> all_pairs(const Comparison& comparison);

// The lead of an order in words, the same on every screen: the deeds of the first, how it stands to
// the next, whether that is settled, and what these data could have shown.

// "36 methods on the 17 settings of 15 problems that all of them were given"
std::string field_text(const Comparison& comparison, const Lead& lead);
// "solves 14 of 17 settings to 1e-6, 5 of them with the least declared work"
std::string deeds_text(const Comparison& comparison, const Scored& scored);
// "adam and gd", who share the first place.
std::string first_text(const Comparison& comparison, const Lead& lead);
// Of the other: "typically takes 1.1× the declared work of adam, which needs less on 7 of 15
// problems and more on 6". The pairing is of the first.
std::string pairing_text(const Comparison& comparison, const Pairing& pairing, std::size_t first);
// A sentence: whether the lead is settled, and if not against whom first.
std::string settled_text(const Comparison& comparison, const Lead& lead);
// A sentence: how many others can be told from the first, and which factor would have been found.
std::string power_text(const Comparison& comparison, const Lead& lead);
// "1st of 38 on the 9 settings where it is given P⁻¹"
std::string placed_text(const Comparison& comparison, const Placed& placed);
// "not ranked: asked 4 of 24 settings", or how its two meanings differ.
std::string apart_text(const Comparison& comparison, const Placed& placed);
// Sentences: where those stand that are not in the common order; empty where all are.
std::string apart_sentence(const Comparison& comparison);

// A sentence: whether the first three are the same at declared and at measured prices; empty where
// calls are not what is counted; of times whether they were taken alone.
std::string prices_text(const Comparison& comparison);

// Scores of the common order, and how far problems drawn anew would move them.

// 95 % of the bootstrap over problems of each optimizer's score at the tightest tolerance by what
// the yardstick counts, settings of one name drawn together; infinite where it is not ranked.
std::vector<Interval> score_intervals(const Comparison& comparison);

}  // namespace isoline::reports
