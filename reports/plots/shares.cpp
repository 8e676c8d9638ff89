// Plots of shares of problems: performance, data and accuracy profiles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reports/plots/plots.h"
#include "reports/readings.h"
#include "reports/statistics/orders.h"
#include "reports/statistics/runtimes.h"
#include "reports/tables/tables.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

using Measure = std::vector<std::optional<Real>>;

Measure column_of(const Costs& costs, std::size_t s) {
  Measure column;
  for (const auto& row : costs) column.push_back(row[s]);
  return column;
}

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

PlotSeries share_series(const Comparison& c, std::size_t s, const Measure& measure,
                        const std::vector<Real>& grid) {
  std::map<std::string, GroupSum> groups;
  for (std::size_t p = 0; p < measure.size(); ++p) {
    if (!measure[p]) continue;
    GroupSum& group = groups[c.problems[p].name()];
    group.sums.resize(grid.size(), 0);
    for (std::size_t i = 0; i < grid.size(); ++i) group.sums[i] += *measure[p] <= grid[i];
    group.n += 1;
  }
  std::vector<GroupSum> list;
  for (auto& [name, group] : groups) list.push_back(std::move(group));
  Band band = bootstrap_ratio(list, "problems");
  band.value.resize(grid.size(), 0);  // where nothing was asked
  band.low.resize(grid.size(), 0);
  band.high.resize(grid.size(), 0);
  return {s, optimizer_text(c, s), grid, band.value, band.low, band.high};
}

std::optional<Plot> profile_plot(const Comparison& c) {
  if (c.problems.size() < kFewProblems) return std::nullopt;
  Plot plot{.id = "plot-profile",
            .title = "Performance profile with its uncertainty",
            .reading = "",
            .caption = std::string(kBand) + "Declared work to 1e-6; " +
                       counted(c, shown_optimizers(c, kMostLines)) + ".",
            .x_label = "factor of the least declared work",
            .y_label = "share of problems",
            .is_log_x = true};
  Costs ratios;
  for (const auto& row : costs_of(c, &Cell::work)) ratios.push_back(cost_ratios(row));
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
  return plot;
}

std::optional<Plot> data_profile_plot(const Comparison& c) {
  const Costs costs = costs_of(c, &Cell::cost);
  Plot plot{.id = "plot-data-profile",
            .title = "Data profile",
            .reading = "",
            .caption = std::string(kBand) + "Cost to 1e-6 in " + cost_unit(c) + "; " +
                       counted(c, shown_optimizers(c, kMostLines)) + ".",
            .x_label = "equivalent forward solves",
            .y_label = "share of problems",
            .is_log_x = true};
  add_lines(c, plot, costs, cost_grid(largest(costs)));
  const Real end = plot.series[0].x.back();
  plot.reading = fmt::format("After 100 forward solves {} has solved most, in the end {}.",
                             highest_at(plot, 100), highest_at(plot, end));
  return plot;
}

std::optional<Plot> accuracy_plot(const Comparison& c) {
  Plot plot{.id = "plot-accuracy",
            .title = "Accuracy profile",
            .reading = "",
            .caption = std::string(kBand) + "Best point seen within the budget; " +
                       counted(c, shown_optimizers(c, kMostLines)) + ".",
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
  return plot;
}

}  // namespace isoline::reports
