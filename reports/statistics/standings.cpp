// Counts, ranks and resamples. An optimizer is compared on a problem with those that were given the
// very same problem, and judged over the problems planned for it: a grid too large for a method
// that factorizes is no defeat, a problem it was given and does not apply to is one.
#include "reports/statistics/standings.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "core/random.h"

namespace isoline::reports {
namespace {

// Median work; nothing where the pair was never planned.
std::vector<std::optional<Real>> costs_of(const std::vector<Cell>& row, std::size_t tolerance) {
  std::vector<std::optional<Real>> costs;
  for (const Cell& cell : row)
    costs.push_back(cell.planned == 0 ? std::nullopt
                                      : std::optional<Real>(cell.work[tolerance].median));
  return costs;
}

Costs costs_at(const Comparison& c, std::size_t tolerance) {
  Costs costs;
  for (const auto& row : c.cells) costs.push_back(costs_of(row, tolerance));
  return costs;
}

void count(OptimizerAxis& optimizer, const Cell& cell) {
  optimizer.planned += cell.planned > 0;
  optimizer.applicable += cell.planned > 0 && cell.inapplicable.empty();
  add_missing(optimizer.privileges, cell.privileges);
  if (!cell.is_measured()) return;
  optimizer.runs += cell.runs.size();
  optimizer.failed += cell.failed;
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    Standing& standing = optimizer.standings[t];
    standing.solved += cell.work[t].is_solved();
    standing.wins += cell.is_best[t];
    standing.reached += cell.work[t].n - cell.work[t].unsolved;
  }
}

void fill_typical(Comparison& c, std::size_t tolerance) {
  std::vector<std::vector<Real>> ratios(c.optimizers.size());
  for (const auto& row : costs_at(c, tolerance)) {
    const auto ratio = cost_ratios(row);
    for (std::size_t s = 0; s < ratio.size(); ++s)
      if (ratio[s]) ratios[s].push_back(*ratio[s]);
  }
  const Profile profile = performance_profile(costs_at(c, tolerance));
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
  const std::vector<Real> zeros(c.optimizers.size(), 0);
  std::vector<Scores> scores;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    if (p == 0 || c.problems[p].name() != c.problems[p - 1].name())
      scores.push_back({zeros, zeros});
    const auto ratios = cost_ratios(costs[p]);
    for (std::size_t s = 0; s < ratios.size(); ++s) {
      if (!ratios[s]) continue;
      scores.back().sum[s] += score_of(*ratios[s], kProfileEnd);
      scores.back().problems[s] += 1;
    }
  }
  return scores;
}

// Bootstrap over problems: Efron (1979).
std::optional<Leader> leader_by(const Comparison& c, const Costs& costs) {
  constexpr std::size_t kDraws = 1000;
  const std::vector<Scores> scores = scores_by_name(c, costs);
  const std::vector<Real> zeros(c.optimizers.size(), 0);
  Scores all{zeros, zeros};
  for (const Scores& some : scores) all.add(some);
  Leader leader;
  if (zeros.empty() || all.sum[leader.optimizer = all.leader()] == 0) return std::nullopt;
  std::size_t times_first = 0;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    RandomStream random(0, "report", "resample", draw);
    Scores drawn{zeros, zeros};
    for (std::size_t i = 0; i < scores.size(); ++i)
      drawn.add(scores[static_cast<std::size_t>(random.uniform(0, Real(scores.size())))]);
    times_first += drawn.leader() == leader.optimizer;
  }
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
    c.profiles[t] = performance_profile(costs_at(c, t));
  c.leader = leader_by(c, costs_at(c, kTightest));
  c.open_leader = leader_by(c, without_privileged(c, costs_at(c, kTightest)));
  std::set<std::string> names;
  for (const ProblemAxis& problem : c.problems) names.insert(problem.name());
  c.names = names.size();
}

}  // namespace isoline::reports
