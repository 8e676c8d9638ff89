// Bootstraps the scores over names of problems.
#include "reports/sections/scores.h"

#include "reports/read/grounds.h"
#include "reports/sections/evidence.h"

namespace isoline::reports {

std::vector<Interval> score_intervals(const Comparison& c) {
  const Costs costs = common_costs(c, kTightest);
  Costs ratios;
  for (const auto& row : costs) ratios.push_back(cost_ratios(row));
  std::vector<Interval> all(c.optimizers.size());
  for (const std::size_t s : c.order.methods) {
    const Band band = band_over_names(c, column_of(ratios, s), "problems", [](Real ratio) {
      return std::vector<Real>{score_of(ratio, kProfileEnd)};
    });
    if (!band.value.empty()) all[s] = {band.low[0], band.high[0]};
  }
  return all;
}

}  // namespace isoline::reports
