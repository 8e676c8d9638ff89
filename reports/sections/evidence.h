// The statistics of a report as tables and plots. Orders of optimizers are by what its yardstick
// counts: declared work, unless asked otherwise, which any machine repeats. What runs cost is then
// in equivalent forward solves, with raw counts beside.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/read/comparison.h"
#include "reports/sections/section.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {

using Plots = std::vector<Plot>;  // none where there is too little to show

Table profile_table(const Comparison& comparison);
Table leader_table(const Comparison& comparison);
Table loss_without_x_table(const Comparison& comparison);
Table condition_table(const Comparison& comparison);
Table data_profile_table(const Comparison& comparison);
Table anytime_table(const Comparison& comparison);
Table interval_table(const Comparison& comparison);
Table restart_table(const Comparison& comparison);
Table calls_table(const Comparison& comparison);
Table prices_table(const Comparison& comparison);

Plots profile_plot(const Comparison& comparison);
Plots log_ratio_plot(const Comparison& comparison);
Plots data_profile_plot(const Comparison& comparison);
Plots runtime_plot(const Comparison& comparison);
Plots target_plot(const Comparison& comparison);

// In the order of a report: what is declared above stands in it once it is named here.
inline constexpr Table (*kStatisticTables[])(const Comparison&) = {
    profile_table, leader_table,   loss_without_x_table, condition_table, data_profile_table,
    anytime_table, interval_table, restart_table,        calls_table,     prices_table};
inline constexpr Plots (*kStatisticPlots[])(const Comparison&) = {
    profile_plot, log_ratio_plot, data_profile_plot, runtime_plot, target_plot};

// Of the section on rates: without rows where no method ran both ways.
Table tuned_and_defaults_table(const Comparison& comparison);

// What so few problems, seeds or runs cannot show, a sentence each.
std::vector<std::string> limits_of_evidence(const Comparison& comparison);

inline constexpr std::size_t kMostTableRows = 40;  // the best optimizers
inline constexpr std::size_t kMostLines = 8;       // of a plot, the best optimizers
inline constexpr std::size_t kMostRivals = 4;      // of the leader, each in a plot of two lines
inline constexpr std::size_t kMostPlotRows = 25;   // problems

// What they share.
// The best of the common order: of tables that compare. And of all, those apart after them.
std::size_t shown_optimizers(const Comparison& comparison, std::size_t most);
std::size_t listed_optimizers(const Comparison& comparison, std::size_t most);
void rows_are_optimizers(Table& table);  // the i-th row is of the i-th
// The first columns beside the names are of the first optimizers, or problems.
void columns_are_optimizers(Table& table, std::size_t count);
void columns_are_problems(Table& table, std::size_t count);
TableCell failed_cell(const Comparison& comparison, std::size_t optimizer);  // "2/80"
TableCell count_cell(std::size_t count);
TableCell share_cell(std::size_t part, std::size_t whole);  // "33 %"
// What costs of single runs are told in: at measured prices where orders go by declared work, else
// by the yardstick too.
Measure cost_measure(const Comparison& comparison);
std::string cost_unit(const Comparison& comparison);
std::string priced_unit(const Comparison& comparison);  // "forward solves at measured prices", …
Real spent_by(const Run& run, Measure by);              // in all
Real in_units(Measure by, Real value);                  // as tables and axes have it: times in ms
// "16 to 23 settings; 2 of 345 runs failed", of the first optimizers.
std::string denominators(const Comparison& comparison, std::size_t shown);
// 10^(i / 8) from 1, of times from a microsecond, to the first beyond `most`.
std::vector<Real> cost_grid(Measure by, Real most);
// What each run of a cell took to the headline's tolerance, in those units; infinite where it did
// not get there or is missing.
std::vector<Real> costs_over_seeds(const Comparison& comparison, const Cell& cell);
// 95 % of the bootstrap of the median; of fewer seeds than can give it, their range.
Interval interval_over_seeds(const std::vector<Real>& values, const std::string& key);
std::string interval_words(const Comparison& comparison);  // which of the two, in words

// Who has the greatest value above 0, ties all.
struct Leading {
  Real value = 0;
  std::size_t count = 0;
  std::string name;

  void offer(Real mine, const std::string& label);
  std::string names() const;  // "sip † and 2 more", "nobody"
};

// Who of the lines is highest at x: "sip † and 2 more (80 %)".
std::string highest_at(const Plot& plot, Real x);

// measure[p] of each problem: nothing where it was never asked, infinite or not-a-number where
// unsolved. The share of problems whose measure is at most each point of the grid, with the 95 %
// bootstrap band over problems, settings of one name drawn together.
using Column = std::vector<std::optional<Real>>;
Column column_of(const Costs& costs, std::size_t optimizer);
PlotSeries share_series(const Comparison& comparison, std::size_t optimizer, const Column& measure,
                        const std::vector<Real>& grid);
// The same of what `parts` makes of each measure: sums over problems over their number.
template <class Parts>
Band band_over_names(const Comparison& comparison, const Column& measure, const std::string& key,
                     Parts parts) {
  std::vector<GroupSum> groups;
  for (const auto& [name, problems] : problems_by_name(comparison)) {
    GroupSum group;
    for (const std::size_t p : problems) {
      if (!measure[p]) continue;
      const std::vector<Real> values = parts(*measure[p]);
      group.sums.resize(values.size(), 0);
      for (std::size_t i = 0; i < values.size(); ++i) group.sums[i] += values[i];
      group.n += 1;
    }
    if (group.n > 0) groups.push_back(std::move(group));
  }
  return bootstrap_ratio(groups, key);
}

}  // namespace isoline::reports
