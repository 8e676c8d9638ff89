// The data profile as a table.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/draws.h"
#include "core/files.h"
#include "core/results/ranking.h"
#include "core/results/statistics.h"
#include "core/results/study.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

Table data_profile_table(const Comparison& c) {
  constexpr std::array<int, 5> kWork = {10, 100, 1000, 10'000, 100'000};
  Table table{
      .id = "data-profile",
      .title = "Data profile",
      .reading = "",
      .caption = fmt::format(
          "Share of the {}s given to a method that its median run solves to {} within so many {}; "
          "unsolved, inapplicable and missing ones stay in n.",
          setting_noun(c), tau_name(c), cost_unit(c)),
      .columns = {"optimizer"},
      .rows = {}};
  for (const int work : kWork) table.columns.push_back(fmt::format("≤ {}", work));
  for (const std::string& column : std::vector<std::string>{"at all", n_column(c), "failed"})
    table.columns.push_back(column);
  const Measure by = cost_measure(c);
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    const std::size_t n = c.order.settings.size();
    for (const Real work : {Real(kWork[0]), Real(kWork[1]), Real(kWork[2]), Real(kWork[3]),
                            Real(kWork[4]), std::numeric_limits<Real>::max()}) {
      std::size_t within = 0;
      for (const std::size_t p : c.order.settings)
        within += in_units(by, c.cell(p, s).taken[by][kTightest].median) <= work;
      row.push_back(share_cell(within, n));
      if (work == kWork[2] && n > 0) first.offer(Real(within) / Real(n), optimizer_text(c, s));
    }
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = fmt::format("The largest share within 1000 {}: {} ({}).", unit_name(by),
                              first.names(), percent(first.value));
  return table;
}

// The performance profile as a table.

Table profile_table(const Comparison& c) {
  Table table{
      .id = "performance-profile",
      .title = "Performance profile",
      .reading = "",
      .caption = fmt::format(
          "Share of the {}s given to a method that its median run solves to {} within so many "
          "times the least {} (Dolan, Moré 2002). The score that ranks is the area under it, over "
          "log2 of the factor up to 64.",
          setting_noun(c), tau_name(c), counted_name(c)),
      .columns = {"optimizer", "≤ 1×", "≤ 2×", "≤ 4×", "≤ 16×", "at all", n_column(c), "failed"},
      .rows = {}};
  const Profile& profile = c.profiles[kTightest];
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const std::size_t n = s < profile.solvers.size() ? profile.solvers[s].problems : 0;
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (const Real factor : {1.0, 2.0, 4.0, 16.0, std::numeric_limits<Real>::max()}) {
      const Real share = n == 0 ? 0 : profile.share(s, factor);
      row.push_back(share_cell(static_cast<std::size_t>(std::llround(share * Real(n))), n));
    }
    first.offer(c.optimizers[s].tightest().score, optimizer_text(c, s));
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = first.count == 0
                      ? fmt::format("No method solves any {} to {}.", setting_noun(c), tau_name(c))
                      : fmt::format("The highest score, {:.3f}: {}.", first.value, first.names());
  return table;
}

// Plots of shares of problems: performance, data and accuracy profiles.

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
  const Costs ratios = ratios_of(common_costs(c, kTightest));
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

// The plot of runtime distributions with simulated restarts.

namespace {

// Counts of hits by the first point of the grid that is no less, over simulated restarts.
class RestartedHits {
 public:
  explicit RestartedHits(const std::vector<Real>& grid) : grid_(grid), hits_(grid.size(), 0) {}

  void add(const std::vector<std::vector<Real>>& targets, const std::vector<Real>& spent,
           const std::string& key) {
    const bool is_certain = targets.size() == 1;  // every draw is the same
    for (std::size_t draw = 0; draw < (is_certain ? 1 : kDraws); ++draw) {
      Draws random(fnv1a(key), "report", "restarted targets", draw);
      follow(targets, spent, random, is_certain ? Real(kDraws) : 1);
    }
  }
  // The share met by each point of the grid; `pairs`: of problems, targets and draws.
  std::vector<Real> shares(Real pairs) const {
    std::vector<Real> shares;
    Real sum = 0;
    for (const Real hits : hits_) shares.push_back((sum += hits) / pairs);
    return shares;
  }

 private:
  // Attempts drawn one after the other, what each spent added up, until the most that any of them
  // meets is met.
  void follow(const std::vector<std::vector<Real>>& targets, const std::vector<Real>& spent,
              Draws& random, Real weight) {
    std::size_t most = 0, met = 0;
    for (const auto& costs : targets)
      most = std::max(most,
                      static_cast<std::size_t>(std::ranges::find(costs, kNever) - costs.begin()));
    for (Real before = 0; met < most;) {
      const auto i = static_cast<std::size_t>(random.uniform() * static_cast<Real>(targets.size()));
      for (; met < most && targets[i][met] < kNever; ++met) {
        const auto at = std::ranges::lower_bound(grid_, before + targets[i][met]);
        if (at != grid_.end()) hits_[static_cast<std::size_t>(at - grid_.begin())] += weight;
      }
      before += spent[i];
    }
  }

  const std::vector<Real>& grid_;
  std::vector<Real> hits_;
};

PlotSeries runtime_series(const Comparison& c, std::size_t s, const std::vector<Real>& grid) {
  const Measure by = cost_measure(c);
  RestartedHits hits(grid);
  Real pairs = 0;
  for (const std::size_t p : c.order.settings) {
    const Cell& cell = c.cell(p, s);
    pairs += static_cast<Real>(kTargets * kDraws);
    if (!cell.is_measured()) continue;
    std::vector<std::vector<Real>> targets;
    std::vector<Real> spent;
    for (const std::size_t index : cell.runs) {
      const Run& run = c.runs[index];
      targets.emplace_back(kTargets, kNever);
      for (std::size_t j = 0; j < kTargets; ++j) targets.back()[j] = in_units(by, run.taken(by, j));
      spent.push_back(std::max(in_units(by, run.spent_by(by)), 1e-9));  // of nothing is no end
    }
    hits.add(targets, spent, c.problems[p].spec + " " + c.optimizers[s].label);
  }
  return {s, optimizer_text(c, s), grid, hits.shares(std::max(pairs, 1.0)), {}, {}};
}

}  // namespace

Plots runtime_plot(const Comparison& c) {
  if (shown_optimizers(c, kMostLines) == 0) return {};
  const Measure by = cost_measure(c);
  Real most = 1;
  for (const Run& run : c.runs) most = std::max(most, in_units(by, run.spent_by(by)));
  const std::vector<Real> grid = cost_grid(by, 10 * most);  // a decade of restarts
  Plot plot{.id = "plot-runtime",
            .title = "Runtime distribution with restarts",
            .reading = "",
            .caption = fmt::format(
                "Share of all pairs of a {} and one of 51 targets, 1 to 1e-10 of the "
                "way to what it aims at, met within so many {}, in 1,000 simulated "
                "sequences of runs drawn with replacement (COCO), each of another seed "
                "and so another instance; {}.",
                setting_noun(c), cost_unit(c), denominators(c, shown_optimizers(c, kMostLines))),
            .x_label = std::string(unit_name(by)),
            .y_label = fmt::format("share of {}s and targets", setting_noun(c)),
            .is_log_x = true};
  for (std::size_t s = 0; s < shown_optimizers(c, kMostLines); ++s)
    plot.series.push_back(runtime_series(c, s, grid));
  plot.reading = fmt::format("Most targets within 100 {}: {}; in the end: {}.", unit_name(by),
                             highest_at(plot, 100), highest_at(plot, grid.back()));
  return {std::move(plot)};
}

}  // namespace isoline::reports
