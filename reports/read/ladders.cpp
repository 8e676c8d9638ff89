// Standings along the ladder of targets.
#include "reports/read/ladders.h"

#include <algorithm>

#include "core/threads.h"
#include "reports/read/leaders.h"

namespace isoline::reports {

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
