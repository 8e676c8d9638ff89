// Plots of shares of problems: performance, data and accuracy profiles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/runtimes.h"

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
  if (c.problems.size() < kFewProblems) return {};
  Plot plot{.id = "plot-profile",
            .title = "Performance profile with its uncertainty",
            .reading = "",
            .caption = std::string(kBand) + "Declared work to 1e-6; " +
                       denominators(c, shown_optimizers(c, kMostLines)) + ".",
            .x_label = "factor of the least declared work",
            .y_label = "share of problems",
            .is_log_x = true};
  Costs ratios;
  for (const auto& row : median_costs(c, kTightest)) ratios.push_back(cost_ratios(row));
  std::vector<Real> grid;
  for (Real i = 0; i <= 48; ++i) grid.push_back(std::pow(2.0, i / 8));
  add_lines(c, plot, ratios, grid);
  const PlotSeries &first = plot.series[0], &last = plot.series.back();
  const bool overlaps = plot.series.size() > 1 && plot.series[1].high[24] >= first.low[24];
  plot.reading = fmt::format(
      "Least work most often: {}; most within 64 times the least: {}. At 8 times the bands of the "
      "first two {}, so their order is {}.",
      highest_at(plot, 1), highest_at(plot, last.x.back()), overlaps ? "overlap" : "are apart",
      overlaps ? "not settled by these problems" : "more than chance");
  return {std::move(plot)};
}

Plots data_profile_plot(const Comparison& c) {
  const Costs costs = median_costs(c, kTightest, Measure::cost);
  Plot plot{.id = "plot-data-profile",
            .title = "Data profile",
            .reading = "",
            .caption = std::string(kBand) + "Cost to 1e-6 in " + cost_unit(c) + "; " +
                       denominators(c, shown_optimizers(c, kMostLines)) + ".",
            .x_label = "equivalent forward solves",
            .y_label = "share of problems",
            .is_log_x = true};
  add_lines(c, plot, costs, cost_grid(largest(costs)));
  const Real end = plot.series[0].x.back();
  plot.reading = fmt::format("After 100 forward solves {} has solved most, in the end {}.",
                             highest_at(plot, 100), highest_at(plot, end));
  return {std::move(plot)};
}

Plots accuracy_plot(const Comparison& c) {
  Plot plot{.id = "plot-accuracy",
            .title = "Accuracy profile",
            .reading = "",
            .caption = std::string(kBand) + "Best point seen within the budget; " +
                       denominators(c, shown_optimizers(c, kMostLines)) + ".",
            .x_label = "digits gained",
            .y_label = "share of problems"};
  Costs lacking(c.problems.size());
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (const Cell& cell : c.cells[p])
      lacking[p].push_back(cell.planned == 0
                               ? std::nullopt
                               : std::optional(lacking_digits(c, cell, &Summary::best_loss)));
  std::vector<Real> grid;
  for (Real i = -64; i <= 0; ++i) grid.push_back(i / 4);
  add_lines(c, plot, lacking, grid);
  for (PlotSeries& line : plot.series) {  // at least so many digits, from none to 16
    for (auto* column : {&line.x, &line.y, &line.low, &line.high}) std::ranges::reverse(*column);
    for (Real& digits : line.x) digits = 0 - digits;
  }
  plot.reading = fmt::format("Three digits on most problems: {}; ten: {}.", highest_at(plot, 3),
                             highest_at(plot, 10));
  return {std::move(plot)};
}

}  // namespace isoline::reports
