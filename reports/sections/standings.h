// Scores of the common order, and how far problems drawn anew would move them.
#pragma once

#include <vector>

#include "reports/read/comparison.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {

// 95 % of the bootstrap over problems of each optimizer's score at the tightest tolerance by what
// the yardstick counts, settings of one name drawn together; infinite where it is not ranked.
std::vector<Interval> score_intervals(const Comparison& comparison);

}  // namespace isoline::reports
