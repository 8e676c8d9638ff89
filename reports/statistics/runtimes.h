// Statistics of runs to a target: expected running time, simulated restarts, areas, digits.
#pragma once

#include <string>
#include <vector>

#include "reports/statistics/statistics.h"

namespace isoline::reports {

// What one run spent: up to the target if it got there, else all it had.
struct Attempt {
  Real cost = 0;
  bool is_success = false;
};

// All that was spent over the successes; infinite without one. Hansen et al. (2016), COCO.
Real expected_running_time(const std::vector<Attempt>& attempts);

// Costs of kDraws simulated runs that restart until a success: attempts drawn with replacement,
// their costs summed. Ascending; all infinite without a success.
std::vector<Real> simulated_restarts(const std::vector<Attempt>& attempts, const std::string& key);

// The share of the area over a convergence curve: (1/B) Σ_b (1 − clip(1 + log10(gap_b) / digits)),
// with gap_b the best so far after b, 1 at the start. As IOHinspector has it.
// It is the area under the ECDF of infinitely many log-spaced targets down to 10^−digits. Exact for
// steps: gap[i] holds from work[i] on.
Real area_over_curve(const std::vector<Real>& work, const std::vector<Real>& gap, Real budget,
                     Real digits);

}  // namespace isoline::reports
