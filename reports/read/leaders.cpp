// Counts, ranks and resamples. An optimizer is compared on a problem with those that were given the
// very same problem, and judged over the problems planned for it: a grid too large for a method
// that factorizes is no defeat, a problem it was given and does not apply to is one.
#include "reports/read/leaders.h"

#include <algorithm>
#include <numeric>

namespace isoline::reports {
namespace {

void count(OptimizerAxis& optimizer, const Cell& cell) {
  optimizer.planned += cell.planned > 0;
  optimizer.applicable += cell.planned > 0 && cell.inapplicable.empty();
  add_missing(optimizer.privileges, cell.privileges);
  if (!cell.is_measured()) return;
  optimizer.runs += cell.runs.size();
  optimizer.failed += cell.failed;
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    Standing& standing = optimizer.standings[t];
    standing.solved += cell.headline[t].is_solved();
    standing.wins += cell.is_best[t];
    standing.reached += cell.headline[t].n - cell.headline[t].unsolved;
  }
}

void fill_typical(Comparison& c, std::size_t tolerance) {
  std::vector<std::vector<Real>> ratios(c.optimizers.size());
  const Costs costs = median_costs(c, tolerance);
  for (const auto& row : costs) {
    const auto ratio = cost_ratios(row);
    for (std::size_t s = 0; s < ratio.size(); ++s)
      if (ratio[s]) ratios[s].push_back(*ratio[s]);
  }
  const Profile profile = performance_profile(costs);
  for (std::size_t s = 0; s < ratios.size() && s < profile.solvers.size(); ++s) {
    c.optimizers[s].standings[tolerance].typical = median_of(std::move(ratios[s]));
    c.optimizers[s].standings[tolerance].score = profile.area(s, kProfileEnd);
  }
}

// Sorts the optimizers, best first, with all that is stored by their index.
void rank_optimizers(Comparison& c) {
  std::vector<std::size_t> order(c.optimizers.size()), place(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const Standing &mine = c.optimizers[a].tightest(), &other = c.optimizers[b].tightest();
    if (mine.score != other.score) return mine.score > other.score;
    if (mine.reached != other.reached) return mine.reached > other.reached;
    return c.optimizers[a].standings[0].score > c.optimizers[b].standings[0].score;
  });
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  const auto sorted = [&](const auto& values) {
    auto out = values;
    for (std::size_t i = 0; i < order.size(); ++i) out[i] = values[order[i]];
    return out;
  };
  c.optimizers = sorted(c.optimizers);
  for (auto& row : c.cells) row = sorted(row);
  for (Run& run : c.runs) run.optimizer = place[run.optimizer];
}

// Sums of scores and numbers of problems of each optimizer, over problems of one name. Names are
// what is drawn anew, not rows: two grids of one equation are no two witnesses.
struct Scores {
  std::vector<Real> sum, problems;
  explicit Scores(std::size_t optimizers) : sum(optimizers, 0), problems(optimizers, 0) {}
  void add(const Scores& other) {
    for (std::size_t s = 0; s < sum.size(); ++s) {
      sum[s] += other.sum[s];
      problems[s] += other.problems[s];
    }
  }
  std::size_t leader() const {
    std::size_t best = 0;
    const auto mean = [this](std::size_t s) { return sum[s] / std::max(problems[s], 1.0); };
    for (std::size_t s = 1; s < sum.size(); ++s)
      if (mean(s) > mean(best)) best = s;
    return best;
  }
};

std::vector<Scores> scores_by_name(const Comparison& c, const Costs& costs) {
  std::vector<Scores> scores;
  for (const auto& [name, problems] : problems_by_name(c)) {
    Scores& of_name = scores.emplace_back(c.optimizers.size());
    for (const std::size_t p : problems) {
      const auto ratios = cost_ratios(costs[p]);
      for (std::size_t s = 0; s < ratios.size(); ++s) {
        if (!ratios[s]) continue;
        of_name.sum[s] += score_of(*ratios[s], kProfileEnd);
        of_name.problems[s] += 1;
      }
    }
  }
  return scores;
}

std::optional<Leader> leader_by(const Comparison& c, const Costs& costs) {
  const std::size_t optimizers = c.optimizers.size();
  const std::vector<Scores> scores = scores_by_name(c, costs);
  Scores all(optimizers);
  for (const Scores& some : scores) all.add(some);
  Leader leader{.optimizer = all.leader()};
  if (optimizers == 0 || all.sum[leader.optimizer] == 0) return std::nullopt;
  std::size_t times_first = 0;
  resample(scores.size(), {0, "report", "resample"}, [&](const Places& places) {
    Scores drawn(optimizers);
    for (const std::size_t place : places) drawn.add(scores[place]);
    times_first += drawn.leader() == leader.optimizer;
  });
  leader.stays_first = static_cast<Real>(times_first) / static_cast<Real>(kDraws);
  return leader;
}

// What privileged methods took does not count: the others are measured by the best of themselves.
Costs without_privileged(const Comparison& c, Costs costs) {
  for (auto& row : costs)
    for (std::size_t s = 0; s < row.size(); ++s)
      if (!c.optimizers[s].privileges.empty()) row[s].reset();
  return costs;
}

Costs costs_among(const Comparison& c, bool is_open) {
  Costs costs = median_costs(c, kTightest);
  return is_open ? without_privileged(c, std::move(costs)) : costs;
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

// Second's work over first's on problems of one name, where at least one of the two solves them; a
// name without any is left out.
std::vector<std::vector<Real>> ratios_of(const Comparison& c, const Costs& costs, std::size_t first,
                                         std::size_t second) {
  std::vector<std::vector<Real>> all;
  for (const auto& [name, problems] : problems_by_name(c)) {
    std::vector<Real> ratios;
    for (const std::size_t p : problems) {
      const auto &mine = costs[p][first], &other = costs[p][second];
      if (!mine || !other || (*mine == kNever && *other == kNever)) continue;
      ratios.push_back(*mine == kNever ? 0 : std::max(*other, 1.0) / std::max(*mine, 1.0));
    }
    if (!ratios.empty()) all.push_back(std::move(ratios));
  }
  return all;
}

Real pooled_median(const std::vector<std::vector<Real>>& ratios, const Places& places) {
  std::vector<Real> pooled;
  for (const std::size_t place : places)
    pooled.insert(pooled.end(), ratios[place].begin(), ratios[place].end());
  return median_of(std::move(pooled));
}

}  // namespace

void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some) {
  for (const std::string& one : some)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

void fill_standings(Comparison& c) {
  for (const auto& row : c.cells)
    for (std::size_t s = 0; s < row.size(); ++s) count(c.optimizers[s], row[s]);
  for (std::size_t t = 0; t < kTolerances.size(); ++t) fill_typical(c, t);
  rank_optimizers(c);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    c.profiles[t] = performance_profile(median_costs(c, t));
  c.leader = leader_by(c, costs_among(c, false));
  c.open_leader = leader_by(c, costs_among(c, true));
  c.names = problems_by_name(c).size();
}

std::optional<Lead> lead_of(const Comparison& c, bool is_open) {
  const std::optional<Leader>& leader = is_open ? c.open_leader : c.leader;
  if (!leader) return std::nullopt;
  const Costs costs = costs_among(c, is_open);
  Lead lead{.ranked = ranked_by(costs, c.optimizers.size()),
            .stays_first = leader->stays_first,
            .interval = {}};
  if (lead.ranked.size() < 2) return lead;
  const auto ratios = ratios_of(c, costs, lead.ranked[0].optimizer, lead.ranked[1].optimizer);
  for (const auto& of_name : ratios) lead.compared += of_name.size();
  if (ratios.empty()) return lead;
  Places all(ratios.size());
  std::iota(all.begin(), all.end(), 0);
  lead.factor = pooled_median(ratios, all);
  std::vector<Real> draws;
  resample(ratios.size(), {0, "report", "factor"},
           [&](const Places& places) { draws.push_back(pooled_median(ratios, places)); });
  lead.interval = interval_of(std::move(draws));
  return lead;
}

}  // namespace isoline::reports
