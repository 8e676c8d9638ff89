// Gathers the tables of statistics and what they share.
#include "reports/tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/text.h"

namespace isoline {

std::size_t shown_optimizers(const Comparison& c, std::size_t most) {
  return std::min(c.optimizers.size(), most);
}

std::string optimizer_text(const Comparison& c, std::size_t s) {
  return shown_spec(c.optimizers[s].label) + (c.optimizers[s].privileges.empty() ? "" : " †");
}

std::string failed_text(const Comparison& c, std::size_t s) {
  return fmt::format("{}/{}", c.optimizers[s].failed, c.optimizers[s].runs);
}

Costs tightest_costs(const Comparison& c) {
  Costs costs;
  for (const auto& row : c.cells) {
    costs.emplace_back();
    for (const Cell& cell : row)
      costs.back().push_back(cell.planned == 0 ? std::nullopt
                                               : std::optional<Real>(cell.work[kTightest].median));
  }
  return costs;
}

std::vector<StatisticTable> statistic_tables(const Comparison& c) {
  if (c.runs.empty()) return {};
  return {rank_table(c),    signed_rank_table(c),  pairwise_table(c),
          flip_table(c),    data_profile_table(c), accuracy_table(c),
          anytime_table(c), interval_table(c),     restart_table(c)};
}

}  // namespace isoline
