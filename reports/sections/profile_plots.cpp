// Plots of shares of problems: performance, data and accuracy profiles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

Real largest(const Costs& costs) {
  Real most = 1;
  for (const auto& row : costs)
    for (const auto& cost : row)
      if (cost && *cost < kNever) most = std::max(most, *cost);
  return most;
}

void add_lines(const Comparison& c, Plot& plot, const Costs& measures,
               const std::vector<Real>& grid) {
  for (std::size_t s = 0; s < shown_optimizers(c, kMostLines); ++s)
    plot.series.push_back(share_series(c, s, column_of(measures, s), grid));
}

constexpr const char* kBand =
    "Shaded: 95 % of 1,000 bootstrap draws of the problems, those of one name together. ";

}  // namespace

Plots profile_plot(const Comparison& c) {
  if (!has_order(c)) return {};
  Plot plot{.id = "plot-profile",
            .title = "Performance profile with its uncertainty",
            .reading = "",
            .caption = fmt::format("{}By {} to {}; {}.", kBand, counted_name(c), tau_name(c),
                                   denominators(c, shown_optimizers(c, kMostLines))),
            .x_label = fmt::format("factor of the least {}", counted_name(c)),
            .y_label = fmt::format("share of {}s", setting_noun(c)),
            .is_log_x = true};
  Costs ratios;
  for (const auto& row : common_costs(c, kTightest)) ratios.push_back(cost_ratios(row));
  std::vector<Real> grid;
  for (int i = 0; i <= 48; ++i) grid.push_back(std::pow(2.0, i / 8.0));
  add_lines(c, plot, ratios, grid);
  const PlotSeries& last = plot.series.back();
  plot.reading = fmt::format("The least most often: {}; most within 64 times the least: {}.",
                             highest_at(plot, 1), highest_at(plot, last.x.back()));
  return {std::move(plot)};
}

Plots data_profile_plot(const Comparison& c) {
  if (c.order.settings.empty()) return {};
  const Measure by = cost_measure(c);
  Costs costs = common_costs(c, kTightest, by);
  for (std::size_t p = 0; p < costs.size(); ++p)
    for (std::size_t s = 0; s < costs[p].size(); ++s)
      if (costs[p][s]) costs[p][s] = in_units(by, c.cell(p, s).taken[by][kTightest].median);
  Plot plot{.id = "plot-data-profile",
            .title = "Data profile",
            .reading = "",
            .caption = fmt::format("{}To {} in {}; {}.", kBand, tau_name(c), cost_unit(c),
                                   denominators(c, shown_optimizers(c, kMostLines))),
            .x_label = std::string(unit_name(by)),
            .y_label = fmt::format("share of {}s", setting_noun(c)),
            .is_log_x = true};
  add_lines(c, plot, costs, cost_grid(by, largest(costs)));
  const Real end = plot.series[0].x.back();
  plot.reading = fmt::format("Most within 100 {}: {}; in the end: {}.", unit_name(by),
                             highest_at(plot, 100), highest_at(plot, end));
  return {std::move(plot)};
}

}  // namespace isoline::reports
