// The section on statistics: functions that its tables share, and the performance, data and runtime
// profiles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "core/draws.h"
#include "core/files.h"
#include "core/results/study.h"
#include "core/threads.h"
#include "reports/sections/drawings.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// In the order of a report: what sections.h declares stands in it once it is named here.
constexpr Table (*kTables[])(const Comparison&) = {
    profile_table,        leader_table,   choices_table,      variation_table,
    loss_without_x_table, features_table, fixed_budget_table, discrepancy_table,
    l_curve_table,        size_table,     data_profile_table, simplex_profile_table,
    restart_table,        calls_table,    rounds_table,       prices_table,
    certified_table};
constexpr Plots (*kPlots[])(const Comparison&) = {profile_plot, data_profile_plot, runtime_plot,
                                                  noise_plot,   l_curve_plot,      size_plots};

}  // namespace

Section statistics_section(const Comparison& c) {
  Section section = worded_section(
      "statistics", counted_name(c),
      c.yardstick.by == Measure::work ? ", which is equal on every machine" : "", cost_unit(c));
  for (std::string& sentence : limits_of_evidence(c))
    section.readings.push_back({words("statistics.limits"), std::move(sentence)});
  if (c.runs.empty()) {
    section.lead.clear();
    return section;
  }
  section.tables.resize(std::size(kTables));
  std::array<Plots, std::size(kPlots)> plots;
  share(std::size(kTables) + std::size(kPlots), [&](std::size_t i) {
    if (i < std::size(kPlots))
      plots[i] = kPlots[i](c);
    else
      section.tables[i - std::size(kPlots)] = kTables[i - std::size(kPlots)](c);
  });
  std::erase_if(section.tables, [](const Table& table) { return table.id.empty(); });
  for (Table& table : section.tables) table.is_folded = true;
  for (Plots& some : plots)
    for (Plot& plot : some)
      if (!plot.series.empty()) section.plots.push_back(std::move(plot));  // else none is ranked
  return section;
}

void add_row(Table& table, const Comparison& c, std::size_t s, std::vector<TableCell> cells) {
  cells.insert(cells.begin(), optimizer_text(c, s));
  table.rows.push_back(std::move(cells));
  table.row_topics.push_back({.optimizer = s});
}

TableCell failed_cell(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return {fmt::format("{}/{}", optimizer.failed, optimizer.runs),
          {{"failed", Real(optimizer.failed)}, {"runs", Real(optimizer.runs)}}};
}

void Leading::offer(Real mine, const std::string& name) {
  if (mine > value) names.clear();
  value = std::max(value, mine);
  if (mine == value && mine > 0) names.push_back(name);
}

std::string Leading::text() const { return names.empty() ? "no method" : first_of(names, 1); }

TableCell count_cell(std::size_t count) { return number_cell("count", Real(count)); }

TableCell number_cell(const char* name, Real value) { return {figure(value), {{name, value}}}; }

Measure cost_measure(const Comparison& c) {
  return c.yardstick.by == Measure::work ? Measure::cost : c.yardstick.by;
}

Real in_units(Measure by, Real value) { return by == Measure::time ? 1e3 * value : value; }

std::string cost_unit(const Comparison& c) {
  const Measure by = cost_measure(c);
  if (by == Measure::iterations) return "iterations";
  if (by == Measure::time) return words(c.is_any_timed_together ? "unit.shared-time" : "unit.time");
  return priced_unit(c);
}

std::string priced_unit(const Comparison& c) {
  const std::size_t all = c.problems.size();
  const auto measured = static_cast<std::size_t>(std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.prices.are_measured(); }));
  return words(measured == all ? "unit.measured"
               : measured == 0 ? "unit.nominal"
                               : "unit.both",
               all - measured, counted_settings(c, all));
}

namespace {

// A row a method of the common order: the shares of its n settings, of which count(method, step)
// lie within each step of a grid; then n, and its failed runs.
template <class Count>
void add_shares(Table& table, const Comparison& c, const std::vector<Real>& steps, Count count) {
  const std::size_t n = c.order.settings.size();
  for (std::size_t s = 0; s < std::min(c.order.methods.size(), kMostTableRows) && n > 0; ++s) {
    std::vector<TableCell> row;
    for (const Real step : steps) {
      const Real within = static_cast<Real>(count(s, step)), share = within / Real(n);
      row.emplace_back(percent(share), TableCell::Numbers{{"share", share}, {"count", within}});
    }
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    add_row(table, c, s, std::move(row));
  }
}

constexpr Real kAtAll = std::numeric_limits<Real>::max();

}  // namespace

Table data_profile_table(const Comparison& c) {
  Table table =
      worded_table("data-profile", setting_noun(c), tau_name(c), cost_unit(c), n_column(c));
  const Measure by = cost_measure(c);
  add_shares(table, c, {10, 100, 1000, 10'000, 100'000, kAtAll}, [&](std::size_t s, Real work) {
    return std::ranges::count_if(c.order.settings, [&](std::size_t p) {
      return in_units(by, c.cell(p, s).taken[by][kTightest].median) <= work;
    });
  });
  Leading first;
  constexpr std::size_t kThousand = 3;  // its column
  for (const auto& row : table.rows) first.offer(row[kThousand].numbers[0].second, row[0].text);
  table.reading = words("data-profile.reading", unit_name(by), first.text(), percent(first.value));
  return table;
}

// Moré and Wild (2009), equation 2.8: for each accuracy and each α, the settings that are solved to
// it within α (n + 1) forward solves. Empty unless the losses and sizes of all settings are known.
Table simplex_profile_table(const Comparison& c) {
  constexpr std::array kAccuracies = {1e-1, 1e-3, 1e-5, 1e-7};
  constexpr std::array kSimplices = {10.0, 100.0, 1000.0};
  if (c.order.settings.empty() || std::ranges::any_of(c.order.settings, [&](std::size_t p) {
        const ProblemAxis& problem = c.problems[p];
        return problem.aim != Aim::loss || problem.is_learned || !problem.has_own_sheet();
      }))
    return {};
  Table table = worded_table("simplex-profile", setting_noun(c), n_column(c));
  std::vector<Real> steps(kAccuracies.size() * kSimplices.size());
  std::iota(steps.begin(), steps.end(), 0);
  add_shares(table, c, steps, [&](std::size_t s, Real step) {
    const auto [i, j] = std::div(static_cast<int>(step), static_cast<int>(kSimplices.size()));
    const std::size_t target = rung_of(kAccuracies[static_cast<std::size_t>(i)]);
    return std::ranges::count_if(c.order.settings, [&](std::size_t p) {
      const auto n = static_cast<Real>(c.problems[p].sheet->unknowns);
      return c.cell(p, s).median(Measure::work, target) <=
             kSimplices[static_cast<std::size_t>(j)] * (n + 1);
    });
  });
  Leading first;
  constexpr std::size_t kMiddle = 8;  // the column of 1e-5 within 100 (n + 1)
  for (const auto& row : table.rows) first.offer(row[kMiddle].numbers[0].second, row[0].text);
  table.reading = words("simplex-profile.reading", first.text(), percent(first.value));
  return table;
}

Table profile_table(const Comparison& c) {
  Table table = worded_table("performance-profile", setting_noun(c), tau_name(c), counted_name(c),
                             n_column(c));
  const Profile& profile = c.profiles[kTightest];
  add_shares(table, c, {1, 2, 4, 16, kAtAll}, [&](std::size_t s, Real factor) {
    return std::llround(profile.share(s, factor) * Real(c.order.settings.size()));
  });
  Leading first;
  for (std::size_t s = 0; s < table.rows.size(); ++s)
    first.offer(c.optimizers[s].tightest().score, table.rows[s][0].text);
  table.reading = first.names.empty()
                      ? words("performance-profile.none", setting_noun(c), tau_name(c))
                      : words("performance-profile.reading", first.value, first.text());
  return table;
}

// Plots of shares of problems.

namespace {

// "23 ranked methods; n = 23 settings, …; 2 of 345 of their runs failed".
std::string denominators(const Comparison& c) {
  std::size_t runs = 0, failed = 0;
  for (std::size_t s = 0; s < c.order.methods.size(); ++s)
    for (const std::size_t p : c.order.settings) {
      runs += c.cell(p, s).is_measured() ? c.cell(p, s).runs.size() : 0;
      failed += c.cell(p, s).failed;
    }
  return words("plot.denominators", c.order.methods.size(),
               counted_settings(c, c.order.settings.size()), failed, runs);
}

// 10^(i / 8) from 1, of times from a microsecond, to the first beyond `most`.
std::vector<Real> cost_grid(Measure by, Real most) {
  constexpr int kPerDecade = 8;
  const int first = by == Measure::time ? -3 * kPerDecade : 0;
  std::vector<Real> grid;
  const Real last = std::ceil(kPerDecade * std::log10(std::max(most, 10.0)));
  for (int i = first; i <= last; ++i) grid.push_back(std::pow(10.0, Real(i) / kPerDecade));
  return grid;
}

// The line that is highest at x: "sip † and 2 more (80 %)".
std::string highest_at(const Plot& plot, Real x) {
  Leading best;
  for (const PlotSeries& line : plot.series) {
    Real y = 0;
    for (std::size_t i = 0; i < line.x.size() && line.x[i] <= x * (1 + 1e-9); ++i) y = line.y[i];
    best.offer(y, line.name);
  }
  return best.names.empty() ? best.text()
                            : fmt::format("{} ({})", best.text(), percent(best.value));
}

// The share of problems whose measure is at most each point of the grid, with the 95 % bootstrap
// band over problems, settings of one name drawn together. Measures are nothing where a problem was
// not asked, infinite where it is unsolved.
PlotSeries share_series(const Comparison& c, std::size_t s, const Costs& measures,
                        const std::vector<Real>& grid) {
  std::vector<GroupSum> groups;
  for (const auto& [family, problems] : problems_by_family(c)) {
    GroupSum group;
    group.sums.resize(grid.size(), 0);
    for (const std::size_t p : problems) {
      if (!measures[p][s]) continue;
      for (std::size_t i = 0; i < grid.size(); ++i) group.sums[i] += *measures[p][s] <= grid[i];
      group.n += 1;
    }
    if (group.n > 0) groups.push_back(std::move(group));
  }
  Band band = bootstrap_ratio(groups, "problems");
  if (groups.size() < kFewestForInterval) band.low = band.high = band.value;
  for (auto* values : {&band.value, &band.low, &band.high}) values->resize(grid.size(), 0);
  return {s,     optimizer_text(c, s),  grid, band.value, band.low, band.high, false,
          false, c.optimizers[s].method};
}

// With its lines, and the best at a place and at the end.
Plots shares_plot(Plot plot, const Comparison& c, const Costs& measures,
                  const std::vector<Real>& grid, Real place) {
  plot.is_log_x = true;
  for (std::size_t s = 0; s < c.order.methods.size(); ++s)
    plot.series.push_back(share_series(c, s, measures, grid));
  if (!plot.series.empty() && plot.series[0].low != plot.series[0].high)
    plot.caption = words("plot.bands") + " " + plot.caption;
  plot.reading = words(plot.id + ".reading", unit_name(cost_measure(c)), highest_at(plot, place),
                       highest_at(plot, grid.back()));
  return {std::move(plot)};
}

}  // namespace

Plots profile_plot(const Comparison& c) {
  if (!has_order(c)) return {};
  std::vector<Real> grid;
  for (int i = 0; i <= 48; ++i) grid.push_back(std::pow(2.0, i / 8.0));
  return shares_plot(
      worded_plot("plot-profile", counted_name(c), tau_name(c), denominators(c), setting_noun(c)),
      c, ratios_of(common_costs(c, kTightest)), grid, 1);
}

Plots data_profile_plot(const Comparison& c) {
  if (c.order.settings.empty()) return {};
  const Measure by = cost_measure(c);
  Costs costs = common_costs(c, kTightest, by);
  Real largest = 1;
  for (std::size_t p = 0; p < costs.size(); ++p)
    for (std::size_t s = 0; s < costs[p].size(); ++s) {
      if (!costs[p][s]) continue;
      costs[p][s] = in_units(by, c.cell(p, s).taken[by][kTightest].median);
      if (*costs[p][s] < kNever) largest = std::max(largest, *costs[p][s]);
    }
  return shares_plot(worded_plot("plot-data-profile", tau_name(c), cost_unit(c), denominators(c),
                                 unit_name(by), setting_noun(c)),
                     c, costs, cost_grid(by, largest), 100);
}

// The plot of runtime distributions with simulated restarts.

namespace {

// Attempts drawn one after the other, what each spent added up, until the most targets that any of
// them meets are met: adds the weight to the hits at the first point of the grid that is no less.
void add_restarts(const std::vector<std::vector<Real>>& targets, const std::vector<Real>& spent,
                  Draws& random, Real weight, const std::vector<Real>& grid,
                  std::vector<Real>& hits) {
  std::ptrdiff_t most = 0, met = 0;
  for (const auto& costs : targets)
    most = std::max(most, std::ranges::find(costs, kNever) - costs.begin());
  for (Real before = 0; met < most;) {
    const auto i = static_cast<std::size_t>(random.uniform() * static_cast<Real>(targets.size()));
    for (auto cost = targets[i].begin() + met; met < most && *cost < kNever; ++met, ++cost) {
      const auto at = std::ranges::lower_bound(grid, before + *cost);
      if (at != grid.end()) hits[static_cast<std::size_t>(at - grid.begin())] += weight;
    }
    before += spent[i];
  }
}

// The share of pairs of a problem and a target that are met by each point of the grid.
PlotSeries runtime_series(const Comparison& c, std::size_t s, const std::vector<Real>& grid) {
  const Measure by = cost_measure(c);
  std::vector<Real> hits(grid.size(), 0);
  for (const std::size_t p : c.order.settings) {
    const Cell& cell = c.cell(p, s);
    if (!cell.is_measured()) continue;
    std::vector<std::vector<Real>> targets;
    std::vector<Real> spent;
    for (const std::size_t index : cell.runs) {
      const Run& run = c.runs[index];
      targets.emplace_back(kTargets, kNever);
      for (std::size_t j = 0; j < kTargets; ++j)
        targets.back()[j] = in_units(by, run.taken_by_best(by, j));
      spent.push_back(std::max(in_units(by, run.spent_by(by)), 1e-9));  // of nothing is no end
    }
    const std::uint64_t key = fnv1a(c.problems[p].spec + " " + c.optimizers[s].label);
    const bool is_certain = targets.size() == 1;  // every draw is the same
    for (std::size_t draw = 0; draw < (is_certain ? 1 : kDraws); ++draw) {
      Draws random(key, "report", "restarted targets", draw);
      add_restarts(targets, spent, random, is_certain ? Real(kDraws) : 1, grid, hits);
    }
  }
  const Real pairs = std::max(Real(c.order.settings.size() * kTargets * kDraws), 1.0);
  std::partial_sum(hits.begin(), hits.end(), hits.begin());
  for (Real& share : hits) share /= pairs;
  return {s, optimizer_text(c, s), grid, hits, {}, {}, false, false, c.optimizers[s].method};
}

}  // namespace

Plots runtime_plot(const Comparison& c) {
  if (c.order.methods.empty()) return {};
  const Measure by = cost_measure(c);
  Real most = 1;
  for (const Run& run : c.runs) most = std::max(most, in_units(by, run.spent_by(by)));
  const std::vector<Real> grid = cost_grid(by, 10 * most);  // a decade of restarts
  Plot plot =
      worded_plot("plot-runtime", setting_noun(c), cost_unit(c), denominators(c), unit_name(by));
  plot.is_log_x = true;
  for (std::size_t s = 0; s < c.order.methods.size(); ++s)
    plot.series.push_back(runtime_series(c, s, grid));
  plot.reading = words("plot-runtime.reading", unit_name(by), highest_at(plot, 100),
                       highest_at(plot, grid.back()));
  return {std::move(plot)};
}

}  // namespace isoline::reports
