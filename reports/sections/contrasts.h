// The contrasts that a suite names beforehand.
#pragma once

#include "core/results/ranking.h"
#include "reports/sections/section.h"

namespace isoline::reports {

// A row per contrast of the suites that these results are of, in the order in which they are
// tested; no rows where no suite names any. The reading has the sentences below.
Table contrast_table(const results::Comparison& comparison);
// The decisions of the sequence with exact data, or that runs are missing; then its power.
std::vector<std::string> contrast_sentences(const results::Comparison& comparison);
// Whether a suite of these results names contrasts.
bool has_contrasts(const results::Study& study);

}  // namespace isoline::reports
