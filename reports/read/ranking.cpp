// Finds the fields of methods that were given the same settings.
#include "reports/read/ranking.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/results/statistics.h"
#include "core/results/tests.h"
#include "core/threads.h"

namespace isoline::reports {
namespace {

bool is_asked(const Comparison& c, std::size_t p, std::size_t s) {
  return c.cell(p, s).planned > 0;
}

// Methods by their names before meanings are told apart, each with its columns.
std::vector<std::vector<std::size_t>> columns_of_methods(const Comparison& c) {
  std::map<std::string, std::vector<std::size_t>> columns;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    columns[c.optimizers[s].name_of_all()].push_back(s);
  std::vector<std::vector<std::size_t>> all;
  for (auto& [name, list] : columns) all.push_back(std::move(list));
  return all;
}

bool is_any_asked(const Comparison& c, std::size_t p, const std::vector<std::size_t>& columns) {
  return std::ranges::any_of(columns, [&](std::size_t s) { return is_asked(c, p, s); });
}

std::vector<std::size_t> shared_settings(const Comparison& c) {
  const auto methods = columns_of_methods(c);
  std::vector<std::size_t> shared;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const auto asked = std::ranges::count_if(
        methods, [&](const auto& columns) { return is_any_asked(c, p, columns); });
    if (is_ordered(c, p) && 2 * static_cast<std::size_t>(asked) > methods.size())
      shared.push_back(p);
  }
  return shared;
}

std::size_t asked_of(const Comparison& c, const std::vector<std::size_t>& settings, std::size_t s) {
  return static_cast<std::size_t>(
      std::ranges::count_if(settings, [&](std::size_t p) { return is_asked(c, p, s); }));
}

}  // namespace

bool is_ordered(const Comparison& c, std::size_t p) {
  return !c.problems[p].is_learned || is_all_learned(c);
}

bool is_all_learned(const Comparison& c) {
  return std::ranges::all_of(c.problems, &ProblemAxis::is_learned);
}

Order common_order(const Comparison& c) {
  Order order;
  const std::vector<std::size_t> shared = shared_settings(c);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (!c.optimizers[s].is_meaning && 2 * asked_of(c, shared, s) >= shared.size() &&
        !shared.empty())
      order.methods.push_back(s);
  for (const std::size_t p : shared)
    if (std::ranges::all_of(order.methods, [&](std::size_t s) { return is_asked(c, p, s); }))
      order.settings.push_back(p);
  for (std::size_t s = 0; s < c.optimizers.size() && !order.settings.empty(); ++s)
    if (c.optimizers[s].is_meaning && asked_of(c, order.settings, s) == order.settings.size())
      order.methods.push_back(s);
  return order;
}

std::vector<Order> orders_beside(const Comparison& c, const Order& common) {
  std::map<std::vector<std::size_t>, std::vector<std::size_t>> settings;  // by who was given them
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!is_ordered(c, p) || common.has_setting(p)) continue;
    std::vector<std::size_t> methods;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (is_asked(c, p, s)) methods.push_back(s);
    if (methods.size() > 1) settings[methods].push_back(p);
  }
  std::vector<Order> orders;
  for (const auto& [methods, some] : settings)
    orders.push_back({.settings = some, .methods = methods});
  std::ranges::stable_sort(orders, std::ranges::greater{},
                           [](const Order& order) { return order.methods.size(); });
  return orders;
}

Placed placed_in(const Comparison& c, std::size_t optimizer) {
  Placed placed{.optimizer = optimizer, .among = {}};
  const std::vector<std::size_t> shared = shared_settings(c);
  placed.shared = shared.size();
  placed.asked = asked_of(c, shared, optimizer);
  Order& among = placed.among;
  for (const std::size_t p : c.order.settings)
    if (is_asked(c, p, optimizer)) among.settings.push_back(p);
  const bool is_beside = among.settings.empty();  // none of its settings is common
  for (std::size_t p = 0; p < c.problems.size() && is_beside; ++p)
    if (is_ordered(c, p) && is_asked(c, p, optimizer)) among.settings.push_back(p);
  for (const std::size_t s : c.order.methods)
    if (asked_of(c, among.settings, s) == among.settings.size()) among.methods.push_back(s);
  among.methods.push_back(optimizer);
  return placed;
}

Costs costs_within(const Comparison& c, const Order& order, std::size_t tolerance, Measure by) {
  const Costs all = median_costs(c, tolerance, by);
  Costs costs(all.size(), std::vector<std::optional<Real>>(c.optimizers.size()));
  for (const std::size_t p : order.settings)
    for (const std::size_t s : order.methods) costs[p][s] = all[p][s];
  return costs;
}

Costs common_costs(const Comparison& c, std::size_t tolerance) {
  return common_costs(c, tolerance, c.yardstick.by);
}
Costs common_costs(const Comparison& c, std::size_t tolerance, Measure by) {
  return costs_within(c, c.order, tolerance, by);
}

Groups groups_of(const Comparison& c) {
  Groups groups;
  for (const auto& [name, problems] : problems_by_name(c)) groups.push_back(problems);
  return groups;
}

std::vector<bool> family_of(const Comparison& c, const Order& order) {
  std::vector<bool> is_in(c.optimizers.size(), false);
  for (const std::size_t s : order.methods) {
    const auto applicable = std::ranges::count_if(
        order.settings, [&](std::size_t p) { return c.cell(p, s).inapplicable.empty(); });
    is_in[s] = 2 * static_cast<std::size_t>(applicable) >= order.settings.size();
  }
  return is_in;
}

std::size_t names_of(const Comparison& c, const Order& order) {
  std::set<std::string> names;
  for (const std::size_t p : order.settings) names.insert(c.problems[p].name);
  return names.size();
}

bool has_order(const Comparison& c) {
  constexpr std::size_t kFewProblems = 4;
  return c.order.methods.size() > 1 && names_of(c, c.order) >= kFewProblems;
}

// Ranks and ratios by problem.

std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& c, Measure by) {
  const Costs costs = common_costs(c, kTightest, by);
  std::map<std::string, std::vector<Real>> sums;
  for (const std::size_t p : c.order.settings) {
    std::vector<Real> values;
    for (const std::size_t s : c.order.methods) values.push_back(*costs[p][s]);
    const std::vector<Real> ranks = mid_ranks(values);
    std::vector<Real>& sum = sums[c.problems[p].name];
    sum.resize(ranks.size(), 0);
    for (std::size_t i = 0; i < ranks.size(); ++i) sum[i] += ranks[i];
  }
  for (auto& [name, sum] : sums) sum = mid_ranks(sum);
  return sums;
}

Real friedman_of(const Comparison& c) {
  const std::vector<bool> is_in = family_of(c, c.order);
  std::vector<std::vector<Real>> blocks;
  for (const auto& [name, ranks] : ranks_by_name(c, c.yardstick.by)) {
    std::vector<Real>& block = blocks.emplace_back();
    for (std::size_t i = 0; i < ranks.size(); ++i)
      if (is_in[c.order.methods[i]]) block.push_back(ranks[i]);
  }
  return friedman_p(blocks);
}

// Reads learned runs where all have spent the same.

namespace {

Real median_spent(const Comparison& c, const Cell& cell) {
  std::vector<Real> spent;
  for (const std::size_t run : cell.runs)
    if (const Summary& summary = c.runs[run].record->summary; summary.work > 0)
      spent.push_back(Real(summary.work));
  return median_of(std::move(spent));
}

Real value_at(const Record& record, const std::vector<Real>& column, Real work) {
  const auto& spent = record.curve.work;
  const auto passed = static_cast<std::size_t>(
      std::ranges::upper_bound(spent, static_cast<std::int64_t>(work)) - spent.begin());
  const bool has_ended = passed == spent.size() && is_failure(record.status);
  if (passed == 0 || passed > column.size() || has_ended) return kNever;
  return column[passed - 1];
}

AtEqualWork read_at(const Comparison& c, const Cell& cell, Real work) {
  std::vector<Real> x_errors, losses;
  for (const std::size_t run : cell.runs) {
    const Record& record = *c.runs[run].record;
    x_errors.push_back(value_at(record, record.curve.x_error, work));
    losses.push_back(value_at(record, record.curve.loss, work));
  }
  return {spread_of(std::move(x_errors)), spread_of(std::move(losses))};
}

}  // namespace

std::vector<std::size_t> EqualWork::nearest_first() const {
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < methods.size(); ++s)
    if (methods[s]) order.push_back(s);
  std::ranges::stable_sort(order, {}, [&](std::size_t s) { return methods[s]->x_error.median; });
  return order;
}

Real EqualWork::least_x_error() const {
  Real least = kNever;
  for (const auto& method : methods)
    if (method) least = std::min(least, method->x_error.median);
  return least;
}

EqualWork equal_work(const Comparison& c, std::size_t problem) {
  EqualWork all{.work = kNever, .methods = {}};
  for (const Cell& cell : c.cells[problem])
    if (cell.is_measured()) all.work = std::min(all.work, median_spent(c, cell));
  for (const Cell& cell : c.cells[problem])
    all.methods.push_back(cell.is_measured() ? std::optional(read_at(c, cell, all.work))
                                             : std::nullopt);
  return all;
}

// Counts and ranks. An optimizer is compared on settings with those that were given the very same
// ones: a grid too large for a method that factorizes is no defeat, a problem it was given and does
// not apply to is one.

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

// Standings along the ladder of targets.

Ladders::Ladders(const Comparison& c) : comparison_(c), medians_(c.problems.size()) {
  share(c.problems.size(), [&](std::size_t p) {
    for (const Cell& cell : c.cells[p]) medians_[p].push_back(target_medians(c, cell));
  });
}

Costs Ladders::costs(const Order& order, Measure by, std::size_t target) const {
  const Comparison& c = comparison_;
  Costs costs(c.problems.size(), std::vector<std::optional<Real>>(c.optimizers.size()));
  for (const std::size_t p : order.settings)
    for (const std::size_t s : order.methods)
      if (c.cell(p, s).planned > 0) costs[p][s] = medians_[p][s].at(by, target) / least_unit(by);
  return costs;
}

std::vector<Ranked> Ladders::standings(Measure by, std::size_t target) const {
  const Comparison& c = comparison_;
  const auto places_in = [&](const Order& order) {
    return standings_in(c, order, costs(order, by, target), [&](std::size_t p, std::size_t s) {
      return medians_[p][s].runs_at(target);
    });
  };
  std::vector<Ranked> places;
  for (const auto& [s, standing] : places_in(c.order))
    places.push_back({.optimizer = s, .standing = standing});
  std::ranges::stable_sort(places, [](const Ranked& a, const Ranked& b) {
    if (!are_tied(a.standing.score, b.standing.score)) return a.standing.score > b.standing.score;
    return a.standing.reached > b.standing.reached;
  });
  for (const Placed& placed : c.apart)
    places.push_back({.optimizer = placed.optimizer,
                      .is_apart = true,
                      .standing = places_in(placed.among)[placed.optimizer]});
  return places;
}

}  // namespace isoline::reports
