// Gathers the statistics, and what their tables and plots share.
#include "reports/sections/evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/threads.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::size_t shown_optimizers(const Comparison& c, std::size_t most) {
  return std::min(c.order.methods.size(), most);
}
std::size_t listed_optimizers(const Comparison& c, std::size_t most) {
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

TableCell share_cell(std::size_t part, std::size_t whole) {
  if (whole == 0) return "";
  const Real share = Real(part) / Real(whole);
  return {percent(share), {{"share", share}, {"count", Real(part)}}};
}

Measure cost_measure(const Comparison& c) {
  return c.yardstick.by == Measure::work ? Measure::cost : c.yardstick.by;
}

Real spent_by(const Run& run, Measure by) {
  const Summary& summary = run.record->summary;
  switch (by) {
    case Measure::work:
      return Real(summary.work);
    case Measure::cost:
      return run.spent;
    case Measure::iterations:
      return Real(summary.iterations);
    case Measure::time:
      return summary.wall_seconds;
  }
  return kNever;
}

Real in_units(Measure by, Real value) { return by == Measure::time ? 1e3 * value : value; }

std::string cost_unit(const Comparison& c) {
  const Measure by = cost_measure(c);
  if (by == Measure::iterations) return "iterations";
  if (by == Measure::time)
    return c.is_any_timed_together ? "ms of wall time (≈: some runs shared the machine)"
                                   : "ms of wall time";
  return priced_unit(c);
}

std::string priced_unit(const Comparison& c) {
  const auto measured = static_cast<std::size_t>(std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.prices.are_measured(); }));
  const std::size_t all = c.problems.size();
  if (measured == all) return "equivalent forward solves at measured prices";
  if (measured == 0) return "forward solves at declared prices (no measured ones are used)";
  return fmt::format(
      "equivalent forward solves, at declared prices on the {} of {} where none was measured or a "
      "call is too short to be",
      all - measured, counted_settings(c, all));
}

std::string denominators(const Comparison& c, std::size_t shown) {
  std::size_t runs = 0, failed = 0;
  for (std::size_t s = 0; s < shown; ++s) {
    runs += c.optimizers[s].runs;
    failed += c.optimizers[s].failed;
  }
  return fmt::format(
      "the first {} of {} ranked methods; n = {}, given to all of them; {} of {} of "
      "their runs failed",
      shown, c.order.methods.size(), counted_settings(c, c.order.settings.size()), failed, runs);
}

std::vector<Real> cost_grid(Measure by, Real most) {
  constexpr int kPerDecade = 8;
  const int first = by == Measure::time ? -3 * kPerDecade : 0;
  std::vector<Real> grid;
  const Real last = std::ceil(kPerDecade * std::log10(std::max(most, 10.0)));
  for (int i = first; i <= last; ++i) grid.push_back(std::pow(10.0, Real(i) / kPerDecade));
  return grid;
}

std::vector<Real> costs_over_seeds(const Comparison& c, const Cell& cell) {
  const Measure by = cost_measure(c);
  std::vector<Real> costs;
  for (const std::size_t run : cell.runs)
    costs.push_back(in_units(by, c.runs[run].taken[by][kTightest]));
  costs.resize(std::max(cell.planned, costs.size()), kNever);
  return costs;
}

Interval interval_over_seeds(const std::vector<Real>& values, const std::string& key) {
  if (values.size() >= kFewestForInterval) return bootstrap_median(values, key);
  const Spread spread = spread_of(values);
  return {spread.low, spread.high};
}

std::string interval_words(const Comparison& c) {
  if (c.seeds.size() < kFewestForInterval)
    return fmt::format("the range of {}, which is no interval", c.seeds.size());
  return "the 95 % bootstrap interval over seeds (1,000 draws), of fewer than 6 their range";
}

void Leading::offer(Real mine, const std::string& label) {
  if (mine > value) {
    value = mine;
    count = 0;
    name = label;
  }
  count += mine == value && mine > 0;
}

std::string Leading::names() const {
  if (count == 0) return "nobody";
  return count == 1 ? name : fmt::format("{} and {} more", name, count - 1);
}

std::string highest_at(const Plot& plot, Real x) {
  Real best = 0;
  std::vector<std::string> names;
  for (const PlotSeries& line : plot.series) {
    Real y = 0;
    for (std::size_t i = 0; i < line.x.size() && line.x[i] <= x * (1 + 1e-9); ++i) y = line.y[i];
    if (y > best) {
      best = y;
      names.clear();
    }
    if (y == best && y > 0) names.push_back(line.name);
  }
  if (names.empty()) return "nobody";
  return fmt::format("{}{} ({})", names[0],
                     names.size() > 1 ? fmt::format(" and {} more", names.size() - 1) : "",
                     percent(best));
}

Column column_of(const Costs& costs, std::size_t s) {
  Column column;
  for (const auto& row : costs) column.push_back(row[s]);
  return column;
}

PlotSeries share_series(const Comparison& c, std::size_t s, const Column& measure,
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
      "Orders of methods, ranks and tests among them are by {}{}. What runs cost is in {}; the raw "
      "counts stand under Oracle calls and Prices.",
      counted_name(c), c.yardstick.by == Measure::work ? ", which any machine repeats" : "",
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
