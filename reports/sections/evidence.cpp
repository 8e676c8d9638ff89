// Gathers the statistics, and what their tables and plots share.
#include "reports/sections/evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/threads.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::size_t shown_optimizers(const Comparison& c, std::size_t most) {
  return std::min(c.optimizers.size(), most);
}

void rows_are_optimizers(Table& table) {
  for (std::size_t s = 0; s < table.rows.size(); ++s) table.row_topics.push_back({.optimizer = s});
}

void columns_are_optimizers(Table& table, std::size_t count) {
  table.column_topics.emplace_back();
  for (std::size_t s = 0; s < count; ++s) table.column_topics.push_back({.optimizer = s});
}

void columns_are_problems(Table& table, std::size_t count) {
  table.column_topics.emplace_back();
  for (std::size_t p = 0; p < count; ++p) table.column_topics.push_back({.problem = p});
}

TableCell failed_cell(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return {fmt::format("{}/{}", optimizer.failed, optimizer.runs),
          {{"failed", Real(optimizer.failed)}, {"runs", Real(optimizer.runs)}}};
}

TableCell count_cell(std::size_t count) {
  return {std::to_string(count), {{"count", Real(count)}}};
}

TableCell digits_cell(Real digits) {
  return {digits == -kNever ? "✗" : fmt::format("{:.3g}", digits + 0.0), {{"digits", digits}}};
}

TableCell share_cell(std::size_t part, std::size_t whole) {
  if (whole == 0) return "";
  const Real share = Real(part) / Real(whole);
  return {percent(share), {{"share", share}, {"count", Real(part)}}};
}

std::string cost_unit(const Comparison& c) {
  const auto measured = std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.prices.are_measured(); });
  const auto all = static_cast<std::ptrdiff_t>(c.problems.size());
  if (measured == all) return "equivalent forward solves at measured prices";
  if (measured == 0) return "forward solves at declared prices (no measured ones are here)";
  return fmt::format(
      "equivalent forward solves, at declared prices on {} of {} problems that have "
      "no measured ones",
      all - measured, all);
}

std::string denominators(const Comparison& c, std::size_t shown) {
  std::size_t least = c.problems.size(), most = 0, runs = 0, failed = 0;
  for (std::size_t s = 0; s < shown; ++s) {
    least = std::min(least, c.optimizers[s].planned);
    most = std::max(most, c.optimizers[s].planned);
    runs += c.optimizers[s].runs;
    failed += c.optimizers[s].failed;
  }
  return fmt::format("the first {} of {} optimizers; n = {} problems; {} of {} runs failed", shown,
                     c.optimizers.size(),
                     least == most ? std::to_string(most) : fmt::format("{} to {}", least, most),
                     failed, runs);
}

std::vector<Real> cost_grid(Real most) {
  constexpr Real kPerDecade = 8;
  std::vector<Real> grid;
  const Real last = std::ceil(kPerDecade * std::log10(std::max(most, 10.0)));
  for (Real i = 0; i <= last; ++i) grid.push_back(std::pow(10.0, i / kPerDecade));
  return grid;
}

std::string highest_at(const Plot& plot, Real x) {
  Real best = -1;
  std::vector<std::string> names;
  for (const PlotSeries& line : plot.series) {
    Real y = 0;
    for (std::size_t i = 0; i < line.x.size() && line.x[i] <= x * (1 + 1e-9); ++i) y = line.y[i];
    if (y > best) {
      best = y;
      names.clear();
    }
    if (y == best) names.push_back(line.name);
  }
  if (names.empty()) return "nobody";
  return fmt::format("{}{} ({})", names[0],
                     names.size() > 1 ? fmt::format(" and {} more", names.size() - 1) : "",
                     percent(best));
}

Measure column_of(const Costs& costs, std::size_t s) {
  Measure column;
  for (const auto& row : costs) column.push_back(row[s]);
  return column;
}

PlotSeries share_series(const Comparison& c, std::size_t s, const Measure& measure,
                        const std::vector<Real>& grid) {
  Band band = band_over_names(c, measure, "problems", [&](Real value) {
    std::vector<Real> within;
    for (const Real most : grid) within.push_back(value <= most);
    return within;
  });
  band.value.resize(grid.size(), 0);  // where nothing was asked
  band.low.resize(grid.size(), 0);
  band.high.resize(grid.size(), 0);
  return {s, optimizer_text(c, s), grid, band.value, band.low, band.high};
}

Section statistics_section(const Comparison& c) {
  Section section{.id = "statistics", .title = "Statistics"};
  for (std::string& sentence : limits_of_evidence(c))
    section.readings.push_back({"What cannot be concluded", std::move(sentence)});
  if (c.runs.empty()) return section;
  section.lead = fmt::format(
      "Orders of methods, ranks and tests among them are by work at declared prices, which any "
      "machine repeats. What runs cost is in {}; the raw counts stand under Oracle calls and "
      "Prices.",
      cost_unit(c));
  constexpr std::size_t kTables = std::size(kStatisticTables), kPlots = std::size(kStatisticPlots);
  section.tables.resize(kTables);
  std::array<Plots, kPlots> plots;
  share(kTables + kPlots, [&](std::size_t i) {
    if (i < kPlots)
      plots[i] = kStatisticPlots[i](c);
    else
      section.tables[i - kPlots] = kStatisticTables[i - kPlots](c);
  });
  for (Table& table : section.tables) table.is_folded = true;
  for (Plots& some : plots)
    for (Plot& plot : some) section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace isoline::reports
