// The first against the second method, problem by problem.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {}  // namespace

// One bar a problem: the doublings by which the leader is told from the next.
Plots log_ratio_plot(const Comparison& c) {
  if (c.order.methods.size() < 2) return {};
  const Costs costs = common_costs(c, kTightest);
  std::vector<std::pair<Real, std::string>> bars;
  std::size_t given = 0;
  for (const auto& [name, problems] : problems_by_name(c)) {
    const Pairing pairing = pairing_of(costs, {problems}, 0, 1);
    given += !pairing.doublings.empty() || pairing.neither > 0;
    if (!pairing.doublings.empty()) bars.emplace_back(pairing.doublings[0], name);
  }
  if (bars.empty()) return {};
  std::ranges::sort(bars);
  const std::string first = optimizer_text(c, 0), second = optimizer_text(c, 1);
  Plot plot{
      .kind = Plot::Kind::bars,
      .id = "plot-log-ratio",
      .title = fmt::format("{} against {}, problem by problem", first, second),
      .reading =
          fmt::format("{} {}.", second, pairing_text(c, pairing_of(costs, groups_of(c), 0, 1), 0)),
      .caption = fmt::format(
          "log2 of the ratio of median {} to {}, sorted, of several settings the median: "
          "below 0 {} needs less, above 0 {}; at ±{:.0f} at least {:.0f} times, or the other never reaches it (Morales 2002). n = {} problems given to both, of which neither "
          "solves {}; failed: {} and {}.",
          counted_name(c), tau_name(c), first, second, std::log2(kProfileEnd), kProfileEnd, given,
          given - bars.size(), failed_cell(c, 0).text, failed_cell(c, 1).text),
      .x_label = "problems",
      .y_label = fmt::format("log2 of the ratio of {}", counted_name(c))};
  PlotSeries series{0, first + " / " + second, {}, {}, {}, {}};
  for (const auto& [ratio, name] : bars) {
    series.x.push_back(Real(plot.rows.size()));
    series.y.push_back(ratio);
    plot.rows.push_back({name, {.problem = problems_by_name(c).at(name)[0]}});
  }
  plot.series.push_back(std::move(series));
  return {std::move(plot)};
}

}  // namespace isoline::reports
