// The contrasts that a suite names beforehand.
#pragma once

#include "core/results/ranking.h"
#include "reports/sections/section.h"

namespace isoline::reports {

// A row per contrast of the suites that these results are of, in the order in which they are
// tested; no rows where no suite names any. The reading states each decision, or that runs are
// missing.
Table contrast_table(const results::Comparison& comparison);

}  // namespace isoline::reports
