// Counts and ranks. An optimizer is compared on settings with those that were given the very same
// ones: a grid too large for a method that factorizes is no defeat, a problem it was given and does
// not apply to is one.
#include "reports/read/leaders.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"

namespace isoline::reports {
namespace {

void count(OptimizerAxis& optimizer, const Cell& cell) {
  optimizer.planned += cell.planned > 0;
  optimizer.applicable += cell.planned > 0 && cell.inapplicable.empty();
  add_missing(optimizer.privileges, cell.privileges);
  if (!cell.is_measured()) return;
  optimizer.runs += cell.runs.size();
  optimizer.failed += cell.failed;
}

// The middle of the costs over the least, in logarithms: infinite where half is unsolved.
Real typical_of(const Costs& ratios, std::size_t s) {
  std::vector<Real> doublings;
  for (const auto& row : ratios)
    if (row[s]) doublings.push_back(std::log2(*row[s]));
  return std::exp2(median_of(std::move(doublings)));
}

}  // namespace

std::map<std::size_t, Standing> standings_in(const Comparison& c, const Order& order,
                                             const Costs& costs, const RunsThere& runs_there) {
  Costs ratios;
  for (const auto& row : costs) ratios.push_back(cost_ratios(row));
  std::map<std::size_t, Standing> standings;
  for (const std::size_t s : order.methods) {
    Standing& standing = standings[s];
    standing.typical = typical_of(ratios, s);
    for (const std::size_t p : order.settings) {
      const Cell& cell = c.cell(p, s);
      if (!cell.is_measured()) continue;
      standing.runs += cell.runs.size();
      standing.reached += runs_there(p, s);
    }
  }
  for (const Scored& scored : ranked_by(costs)) {
    Standing& standing = standings[scored.optimizer];
    standing.settings = scored.problems;
    standing.solved = scored.solved;
    standing.wins = scored.wins;
    standing.score = scored.score;
  }
  return standings;
}

namespace {

std::map<std::size_t, Standing> standings_to(const Comparison& c, const Order& order,
                                             std::size_t tolerance) {
  return standings_in(c, order, costs_within(c, order, tolerance, c.yardstick.by),
                      [&](std::size_t p, std::size_t s) {
                        const Spread& spread = c.cell(p, s).headline[tolerance];
                        return spread.n - spread.unsolved;
                      });
}

void mark_best(Comparison& c, std::size_t p, std::size_t tolerance) {
  std::vector<Cell>& row = c.cells[p];
  const bool is_common = c.order.has_setting(p);
  Real least = kNever;
  for (std::size_t s = 0; s < row.size(); ++s)
    if (!is_common || c.order.has(s)) least = std::min(least, row[s].headline[tolerance].median);
  for (Cell& cell : row) {
    const Real mine = cell.headline[tolerance].median;
    cell.is_best[tolerance] = mine < kNever && mine <= least;
  }
}

void fill_common(Comparison& c) {
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    for (const auto& [s, standing] : standings_to(c, c.order, t))
      c.optimizers[s].standings[t] = standing;
}

void sort_by_score(Order& order, const Costs& costs) {
  order.methods.clear();
  for (const Scored& scored : ranked_by(costs)) order.methods.push_back(scored.optimizer);
}

std::size_t place_of(const std::vector<Scored>& ranked, std::size_t optimizer) {
  const auto mine = std::ranges::find(ranked, optimizer, &Scored::optimizer);
  if (mine == ranked.end()) return 0;
  return 1 + static_cast<std::size_t>(std::ranges::count_if(ranked, [&](const Scored& each) {
           return each.score > mine->score && !are_tied(each.score, mine->score);
         }));
}

void fill_apart(Comparison& c) {
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    if (c.order.has(s)) continue;
    Placed placed = placed_in(c, s);
    if (placed.among.settings.empty()) continue;  // it learns alone
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      c.optimizers[s].standings[t] = standings_to(c, placed.among, t)[s];
    const Costs costs = costs_within(c, placed.among, kTightest, c.yardstick.by);
    placed.place = place_of(ranked_by(costs), s);
    sort_by_score(placed.among, costs);
    c.apart.push_back(std::move(placed));
  }
}

// The optimizers, best first, those apart after all others.
std::vector<std::size_t> best_first(const Comparison& c) {
  std::vector<std::size_t> order(c.optimizers.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    if (c.order.has(a) != c.order.has(b)) return c.order.has(a);
    const Standing &mine = c.optimizers[a].tightest(), &other = c.optimizers[b].tightest();
    if (!are_tied(mine.score, other.score)) return mine.score > other.score;
    if (mine.reached != other.reached) return mine.reached > other.reached;
    return c.optimizers[a].standings[0].score > c.optimizers[b].standings[0].score;
  });
  return order;
}

// Sorts the optimizers with all that is stored by their index.
void rank_optimizers(Comparison& c) {
  const std::vector<std::size_t> order = best_first(c);
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  const auto sorted = [&](const auto& values) {
    auto out = values;
    for (std::size_t i = 0; i < order.size(); ++i) out[i] = values[order[i]];
    return out;
  };
  const auto move = [&](std::size_t& optimizer) { optimizer = place[optimizer]; };
  c.optimizers = sorted(c.optimizers);
  for (auto& row : c.cells) row = sorted(row);
  for (Run& run : c.runs) move(run.optimizer);
  std::ranges::for_each(c.order.methods, move);
  std::ranges::sort(c.order.methods);
  for (Placed& placed : c.apart) {
    move(placed.optimizer);
    std::ranges::for_each(placed.among.methods, move);
  }
  std::ranges::sort(c.apart, {}, &Placed::optimizer);
}

void fill_other_orders(Comparison& c) {
  c.other_orders = orders_beside(c, c.order);
  for (Order& order : c.other_orders)
    sort_by_score(order, costs_within(c, order, kTightest, c.yardstick.by));
}

// What privileged methods took does not count: the others are measured by the best of themselves.
Costs without_privileged(const Comparison& c, Costs costs) {
  for (auto& row : costs)
    for (std::size_t s = 0; s < row.size(); ++s)
      if (!c.optimizers[s].privileges.empty()) row[s].reset();
  return costs;
}

}  // namespace

bool Order::has(std::size_t optimizer) const {
  return std::ranges::find(methods, optimizer) != methods.end();
}

bool Order::has_setting(std::size_t problem) const {
  return std::ranges::find(settings, problem) != settings.end();
}

void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some) {
  for (const std::string& one : some)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

void fill_standings(Comparison& c) {
  for (const auto& row : c.cells)
    for (std::size_t s = 0; s < row.size(); ++s) count(c.optimizers[s], row[s]);
  c.order = common_order(c);
  for (std::size_t p = 0; p < c.cells.size(); ++p)
    for (std::size_t t = 0; t < kTolerances.size(); ++t) mark_best(c, p, t);
  fill_common(c);
  fill_apart(c);
  rank_optimizers(c);
  fill_other_orders(c);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    c.profiles[t] = performance_profile(common_costs(c, t));
  c.lead = lead_of(c, false, c.yardstick.by);
  c.open_lead = lead_of(c, true, c.yardstick.by);
  c.names = problems_by_name(c).size();
}

std::optional<Lead> lead_of(const Comparison& c, bool is_open, Measure by) {
  Costs costs = common_costs(c, kTightest, by);
  if (is_open) costs = without_privileged(c, std::move(costs));
  std::optional<Lead> lead = lead_among(costs, groups_of(c), family_of(c, c.order));
  // Of three methods or more it is asked first whether they differ at all.
  if (lead && lead->rivals.size() > 1 && friedman_of(c) > kSignificant) lead->is_settled = false;
  return lead;
}

}  // namespace isoline::reports
