// The plots of the statistics, and how a plot becomes SVG or JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

// In the order of a report; empty where nothing has run.
std::vector<Plot> statistic_plots(const Comparison& comparison);

// One each; plots_*.cpp. Those that have too little to show are left out.
std::optional<Plot> profile_plot(const Comparison& comparison);
std::vector<Plot> pairwise_plots(const Comparison& comparison);
std::optional<Plot> data_profile_plot(const Comparison& comparison);
std::optional<Plot> accuracy_plot(const Comparison& comparison);
std::optional<Plot> runtime_plot(const Comparison& comparison);
std::optional<Plot> rank_plot(const Comparison& comparison);
std::optional<Plot> signed_rank_plot(const Comparison& comparison);
std::optional<Plot> log_ratio_plot(const Comparison& comparison);
std::optional<Plot> target_plot(const Comparison& comparison);

inline constexpr std::size_t kMostLines = 8;      // the best optimizers
inline constexpr std::size_t kMostRivals = 4;     // of the leader, each in a plot of two lines
inline constexpr std::size_t kMostPlotRows = 25;  // problems

// Static and complete without scripts: a figure with its sentence. What belongs to an optimizer or
// a problem carries data-s or data-p, its index in the comparison.
std::string plot_html(const Plot& plot);
std::string plot_svg(const Plot& plot);
nlohmann::json plot_json(const Plot& plot, const Comparison& comparison);

// The share of an optimizer's problems whose measure is at most each point of the grid, with the
// 95 % bootstrap band over problems, settings of one name drawn together. measure[p]: nothing
// where the problem was never asked, infinite or not-a-number where unsolved.
PlotSeries share_series(const Comparison& comparison, std::size_t optimizer,
                        const std::vector<std::optional<Real>>& measure,
                        const std::vector<Real>& grid);

// What the plots share.
std::vector<Real> cost_grid(Real most);  // 10^(i / 8) from 1 to the first beyond `most`
// "16 to 23 problems; 2 of 345 runs failed", of the first optimizers.
std::string counted(const Comparison& comparison, std::size_t shown);
// Who of the lines is highest at x: "sip † and 2 more (80 %)".
std::string highest_at(const Plot& plot, Real x);

}  // namespace isoline::reports
