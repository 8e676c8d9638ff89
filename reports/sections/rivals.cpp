// Plots of orders: the leader against each rival alone, ratios, mean ranks, signed ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/rank_tests.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostRanks = 20;

// The profiles of two alone, on the problems given to both.
Plot pair_plot(const Comparison& c, const Costs& costs, std::size_t rival) {
  std::vector<std::optional<Real>> mine(costs.size()), other(costs.size());
  for (std::size_t p = 0; p < costs.size(); ++p) {
    if (!costs[p][0] || !costs[p][rival]) continue;
    const auto ratios = cost_ratios({costs[p][0], costs[p][rival]});
    mine[p] = ratios[0];
    other[p] = ratios[1];
  }
  std::vector<Real> grid;
  for (int i = 0; i <= 48; ++i) grid.push_back(std::pow(2.0, i / 8.0));
  const Pairing pairing = pairing_of(costs, groups_of(c), 0, rival);
  const std::size_t even = pairing.ties + pairing.neither;
  const std::string names[] = {optimizer_text(c, 0), optimizer_text(c, rival)};
  return {.id = fmt::format("plot-pair-{}", rival),
          .title = fmt::format("{} against {} alone", names[0], names[1]),
          .reading = fmt::format("{} needs less on {} of {} problems, {} on {}; {} tie{}.",
                                 names[0], pairing.wins, pairing.doublings.size() + pairing.neither,
                                 names[1], pairing.losses, even, even == 1 ? "" : "s"),
          .caption = fmt::format("Profiles of two alone, {} to {}, with 95 % bands; failed: {} and "
                                 "{}.",
                                 counted_name(c), tau_name(c), failed_cell(c, 0).text,
                                 failed_cell(c, rival).text),
          .x_label = fmt::format("multiple of the better method's {}", counted_name(c)),
          .y_label = fmt::format("share of {}s", setting_noun(c)),
          .is_log_x = true,
          .series = {share_series(c, 0, mine, grid), share_series(c, rival, other, grid)}};
}

}  // namespace

Plots pairwise_plots(const Comparison& c) {
  Plots plots;
  if (!has_order(c)) return plots;
  const Costs costs = common_costs(c, kTightest);
  for (std::size_t rival = 1; rival < shown_optimizers(c, kMostRivals + 1); ++rival)
    plots.push_back(pair_plot(c, costs, rival));
  return plots;
}

// One bar a problem: the doublings by which the leader is told from the next.
Plots log_ratio_plot(const Comparison& c) {
  if (c.order.methods.size() < 2) return {};
  const Costs costs = common_costs(c, kTightest);
  std::vector<std::pair<Real, std::string>> bars;
  std::size_t given = 0;
  for (const auto& [name, problems] : problems_by_name(c)) {
    const Pairing pairing = pairing_of(costs, {problems}, 0, 1);
    given += !pairing.doublings.empty() || pairing.neither > 0;
    if (!pairing.doublings.empty()) bars.emplace_back(pairing.doublings[0], name);
  }
  if (bars.empty()) return {};
  std::ranges::sort(bars);
  const std::string first = optimizer_text(c, 0), second = optimizer_text(c, 1);
  Plot plot{
      .kind = Plot::Kind::bars,
      .id = "plot-log-ratio",
      .title = fmt::format("{} against {}, problem by problem", first, second),
      .reading =
          fmt::format("{} {}.", second, pairing_text(c, pairing_of(costs, groups_of(c), 0, 1), 0)),
      .caption = fmt::format(
          "log2 of the ratio of median {} to {}, sorted, of several settings the median: "
          "below 0 {} needs less, above 0 {}; at ±{:.0f} at least {:.0f} times, or the other never reaches it (Morales 2002). n = {} problems given to both, of which neither "
          "solves {}; failed: {} and {}.",
          counted_name(c), tau_name(c), first, second, std::log2(kProfileEnd), kProfileEnd, given,
          given - bars.size(), failed_cell(c, 0).text, failed_cell(c, 1).text),
      .x_label = "problems",
      .y_label = fmt::format("log2 of the ratio of {}", counted_name(c))};
  PlotSeries series{0, first + " / " + second, {}, {}, {}, {}};
  for (const auto& [ratio, name] : bars) {
    series.x.push_back(Real(plot.rows.size()));
    series.y.push_back(ratio);
    plot.rows.push_back({name, {.problem = problems_by_name(c).at(name)[0]}});
  }
  plot.series.push_back(std::move(series));
  return {std::move(plot)};
}

Plots rank_plot(const Comparison& c) {
  const auto ranks = ranks_by_name(c, c.yardstick.by);
  if (ranks.size() < 2) return {};
  Plot plot{.kind = Plot::Kind::dots,
            .id = "plot-rank",
            .title = "Mean rank",
            .reading = "",
            .caption = fmt::format(
                "By {} to {}, with its {} over n = {} problems given to all ranked methods; gaps "
                "below {:.3g} are not resolvable (Nemenyi); {}.",
                counted_name(c), tau_name(c), interval_name(ranks.size()), ranks.size(),
                least_gap(c.order.methods.size(), ranks.size()),
                denominators(c, shown_optimizers(c, kMostRanks))),
            .x_label = "mean rank, 1 the best",
            .y_label = ""};
  for (std::size_t s = 0; s < shown_optimizers(c, kMostRanks); ++s) {
    std::vector<Real> own;
    Real sum = 0;
    for (const auto& [name, rank] : ranks) {
      own.push_back(rank[s]);
      sum += rank[s];
    }
    const Interval interval = bootstrap_mean(own, "ranks");
    plot.series.push_back({s,
                           optimizer_text(c, s),
                           {sum / Real(own.size())},
                           {Real(s)},
                           {interval.low},
                           {interval.high}});
    plot.rows.push_back({optimizer_text(c, s), {.optimizer = s}});
  }
  const auto best =
      std::ranges::min_element(plot.series, {}, [](const PlotSeries& one) { return one.x[0]; });
  const Real gap = least_gap(c.order.methods.size(), ranks.size());
  const auto within = std::ranges::count_if(
      plot.series, [&](const PlotSeries& one) { return one.x[0] - best->x[0] < gap; });
  plot.reading = fmt::format(
      "{} has the least, {:.3g}; of the others shown {} are within the gap that Nemenyi’s test "
      "resolves.",
      best->name, best->x[0], within - 1);
  return {std::move(plot)};
}

Plots signed_rank_plot(const Comparison& c) {
  const std::size_t k = shown_optimizers(c, kMostTablePairs);
  if (k < 2) return {};
  const SignedRanks ranked = signed_ranks(c, k);
  Plot plot{.kind = Plot::Kind::matrix,
            .id = "plot-signed-rank",
            .title = "Which pairs of the best can be told apart",
            .reading = fmt::format(
                "{} of {} pairs can be told apart at 0.05; the least adjusted p is {:.2g}.",
                ranked.told, ranked.pairs.size(), ranked.least),
            .caption = fmt::format(
                "Wilcoxon’s signed ranks on doublings of {} to {}, p after Holm over all pairs; "
                "the darker the surer, framed at 0.05 or less; {}.",
                counted_name(c), tau_name(c), denominators(c, k)),
            .x_label = "",
            .y_label = ""};
  const Real none = std::nan("");
  for (std::size_t s = 0; s < k; ++s) {
    plot.rows.push_back({optimizer_text(c, s), {.optimizer = s}});
    plot.series.push_back({s, optimizer_text(c, s), {}, std::vector<Real>(k, none), {}, {}});
    for (std::size_t b = 0; b < k; ++b) plot.series.back().x.push_back(Real(b));
  }
  for (const RankedPair& pair : ranked.pairs)
    plot.series[pair.a].y[pair.b] = plot.series[pair.b].y[pair.a] = pair.adjusted;
  return {std::move(plot)};
}

}  // namespace isoline::reports
