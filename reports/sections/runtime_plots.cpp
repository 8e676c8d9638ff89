// The plot of runtime distributions with simulated restarts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "core/draws.h"
#include "reports/read/reached.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
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
      const std::vector<Reached> ladder = ladder_of(run, c.problems[p].prices, run.aim);
      for (std::size_t j = 0; j < std::min(ladder.size(), kTargets); ++j)
        targets.back()[j] = in_units(by, ladder[j].by(by));
      spent.push_back(std::max(in_units(by, spent_by(run, by)), 1e-9));  // of nothing is no end
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
  for (const Run& run : c.runs) most = std::max(most, in_units(by, spent_by(run, by)));
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
