// Ranks by score and resamples the factor between the first two, by names of problems: two grids of
// one equation are no two witnesses.
#include "reports/statistics/lead.h"

#include <algorithm>
#include <map>

#include "core/random.h"

namespace isoline::reports {
namespace {

// Median work to the tightest tolerance, of those compared where it was asked of them.
Costs costs_among(const Comparison& c, bool is_open) {
  Costs costs;
  for (const auto& row : c.cells) {
    costs.emplace_back(row.size());
    for (std::size_t s = 0; s < row.size(); ++s)
      if (row[s].planned > 0 && !(is_open && !c.optimizers[s].privileges.empty()))
        costs.back()[s] = row[s].work[kTightest].median;
  }
  return costs;
}

std::vector<Scored> ranked_by(const Costs& costs, std::size_t optimizers) {
  std::vector<Scored> all(optimizers);
  for (std::size_t s = 0; s < optimizers; ++s) all[s].optimizer = s;
  for (const auto& row : costs) {
    const auto ratios = cost_ratios(row);
    Real least = kNever;
    for (const auto& cost : row) least = std::min(least, cost.value_or(kNever));
    for (std::size_t s = 0; s < ratios.size(); ++s) {
      if (!ratios[s]) continue;
      ++all[s].problems;
      all[s].score += score_of(*ratios[s], kProfileEnd);
      all[s].solved += *ratios[s] < kNever;
      all[s].wins += *row[s] < kNever && *row[s] == least;
    }
  }
  std::erase_if(all, [](const Scored& scored) { return scored.problems == 0; });
  for (Scored& scored : all) scored.score /= static_cast<Real>(scored.problems);
  std::ranges::stable_sort(all, std::ranges::greater{}, &Scored::score);
  return all;
}

// Second's work over first's, by name of problem, where at least one of the two solves it.
using Ratios = std::map<std::string, std::vector<Real>>;

Ratios ratios_of(const Comparison& c, const Costs& costs, std::size_t first, std::size_t second) {
  Ratios ratios;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    const auto &mine = costs[p][first], &other = costs[p][second];
    if (!mine || !other || (*mine == kNever && *other == kNever)) continue;
    const Real ratio = *mine == kNever ? 0 : std::max(*other, 1.0) / std::max(*mine, 1.0);
    ratios[c.problems[p].name()].push_back(ratio);
  }
  return ratios;
}

Interval resampled(const Ratios& ratios) {
  constexpr Real kTail = 0.025;
  std::vector<const std::vector<Real>*> names;
  for (const auto& [name, values] : ratios) names.push_back(&values);
  std::vector<Real> all;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    RandomStream random(0, "report", "factor", draw);
    std::vector<Real> sample;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto& drawn = *names[static_cast<std::size_t>(random.uniform() * Real(names.size()))];
      sample.insert(sample.end(), drawn.begin(), drawn.end());
    }
    all.push_back(median_of(std::move(sample)));
  }
  std::ranges::sort(all);
  return {quantile(all, kTail), quantile(all, 1 - kTail)};
}

}  // namespace

std::optional<Lead> lead_of(const Comparison& c, bool is_open) {
  const std::optional<Leader>& leader = is_open ? c.open_leader : c.leader;
  if (!leader) return std::nullopt;
  const Costs costs = costs_among(c, is_open);
  Lead lead{.ranked = ranked_by(costs, c.optimizers.size()),
            .stays_first = leader->stays_first,
            .interval = {}};
  if (lead.ranked.size() < 2) return lead;
  const Ratios ratios = ratios_of(c, costs, lead.ranked[0].optimizer, lead.ranked[1].optimizer);
  std::vector<Real> pooled;
  for (const auto& [name, values] : ratios)
    pooled.insert(pooled.end(), values.begin(), values.end());
  lead.compared = pooled.size();
  if (pooled.empty()) return lead;
  lead.factor = median_of(pooled);
  lead.interval = resampled(ratios);
  return lead;
}

}  // namespace isoline::reports
