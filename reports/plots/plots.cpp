// Gathers the plots of the statistics and what they share.
#include "reports/plots/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/text.h"

namespace isoline::reports {

std::vector<Real> cost_grid(Real most) {
  constexpr Real kPerDecade = 8;
  std::vector<Real> grid;
  const Real last = std::ceil(kPerDecade * std::log10(std::max(most, 10.0)));
  for (Real i = 0; i <= last; ++i) grid.push_back(std::pow(10.0, i / kPerDecade));
  return grid;
}

std::string counted(const Comparison& c, std::size_t shown) {
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

std::string highest_at(const Plot& plot, Real x) {
  Real best = -1;
  std::vector<std::string> names;
  for (const PlotSeries& line : plot.series) {
    Real y = 0;
    for (std::size_t i = 0; i < line.x.size() && line.x[i] <= x * (1 + 1e-9); ++i) y = line.y[i];
    if (y > best) best = y, names.clear();
    if (y == best) names.push_back(line.name);
  }
  if (names.empty()) return "nobody";
  return fmt::format("{}{} ({})", names[0],
                     names.size() > 1 ? fmt::format(" and {} more", names.size() - 1) : "",
                     percent(best));
}

std::vector<Plot> statistic_plots(const Comparison& c) {
  if (c.runs.empty()) return {};
  std::vector<Plot> plots;
  const auto add = [&](std::optional<Plot> plot) {
    if (plot) plots.push_back(std::move(*plot));
  };
  add(profile_plot(c));
  for (Plot& plot : pairwise_plots(c)) plots.push_back(std::move(plot));
  add(log_ratio_plot(c));
  add(rank_plot(c));
  add(signed_rank_plot(c));
  add(data_profile_plot(c));
  add(runtime_plot(c));
  add(accuracy_plot(c));
  add(target_plot(c));
  return plots;
}

}  // namespace isoline::reports
