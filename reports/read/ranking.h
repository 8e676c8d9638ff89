// Which methods are compared on which settings, and in which order they stand.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reports/read/comparison.h"
#include "reports/read/reached.h"

namespace isoline::reports {

// Whether a problem counts for an order: a tolerance of the loss says little of a network, so what
// is learned is told apart, by its error in x, unless a study holds nothing else.
bool is_ordered(const Comparison& comparison, std::size_t problem);
bool is_all_learned(const Comparison& comparison);

// The order of most methods. A setting is shared where more than half of the methods were given it;
// a method is ranked that was given at least half of the shared ones; common are the settings that
// all ranked ones were given. So one method's additional settings move no other. A method with two
// meanings is ranked where each of them was given all common settings, else it stands apart.
Order common_order(const Comparison& comparison);

// All other settings, by who was given them, at least two methods.
std::vector<Order> orders_beside(const Comparison& comparison, const Order& common);

// Where a method that is not ranked is compared: its settings among the common ones, or else all of
// its own, with the ranked methods that were given all of these. Its place is not counted yet.
Placed placed_in(const Comparison& comparison, std::size_t optimizer);

// costs[p][s] as those of median_costs; nothing outside the order.
Costs costs_within(const Comparison& comparison, const Order& order, std::size_t tolerance,
                   Measure by);
// Of the common order, by what the yardstick counts.
Costs common_costs(const Comparison& comparison, std::size_t tolerance);
Costs common_costs(const Comparison& comparison, std::size_t tolerance, Measure by);

Groups groups_of(const Comparison& comparison);  // rows of one name, all problems

// Methods that apply to at least half of the settings of an order: worth a test.
std::vector<bool> family_of(const Comparison& comparison, const Order& order);

// Whether there are problems enough to speak of an order over them.
bool has_order(const Comparison& comparison);
std::size_t names_of(const Comparison& comparison, const Order& order);  // of its settings

// Orders over problems: ranks, ratios, and how far they can be told from chance.

// Ranks of the methods of the common order by name of problem, in the order of order.methods:
// settings of one problem are no two witnesses, so their ranks are averaged and ranked again.
std::map<std::string, std::vector<Real>> ranks_by_name(const Comparison& comparison, Measure by);

// Friedman's p over these ranks, of the methods that apply to most of the settings.
Real friedman_of(const Comparison& comparison);

// A learned problem at equal work: what networks have come to when all have spent as much.

struct AtEqualWork {
  Spread x_error, loss;  // on the validation, over seeds; infinite where a run had failed by then
};

struct EqualWork {
  Real work = 0;  // declared: the least that the median run of any method spent
  std::vector<std::optional<AtEqualWork>> methods;  // by optimizer; none where nothing ran

  // Who measured something, least error in x first.
  std::vector<std::size_t> nearest_first() const;
  Real least_x_error() const;  // infinite where no median is finite
};
// Of each run the last kept point that had spent no more. A run that ended sooner of its own keeps
// its last point.
EqualWork equal_work(const Comparison& comparison, std::size_t problem);

// Who stands where: the common order, its leader, and who is compared apart from it.

// Finds the orders, counts for each optimizer, sorts all that is stored by optimizer, and finds who
// leads. Needs the cells aggregated.
void fill_standings(Comparison& comparison);

// How those of an order stand by these costs, whatever tolerance they and the runs that get there
// are of: by optimizer.
using RunsThere = std::function<std::size_t(std::size_t problem, std::size_t optimizer)>;
std::map<std::size_t, Standing> standings_in(const Comparison& comparison, const Order& order,
                                             const Costs& costs, const RunsThere& runs_there);

// Adds those that are not there yet.
void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some);

// The lead of the common order at the tightest tolerance by any measure: among all, or among those
// without privileges alone; nothing where none of them solves anything.
std::optional<Lead> lead_of(const Comparison& comparison, bool is_open, Measure by);

// Medians of all cells to all 51 targets by every measure, and who stands where at each: what the
// page's slider of tolerance and its switch of measure choose from.

struct Ranked {
  std::size_t optimizer = 0;
  bool is_apart = false;  // of the common order
  Standing standing;
};

class Ladders {
 public:
  explicit Ladders(const Comparison& comparison);  // which must outlive it

  const TargetMedians& at(std::size_t problem, std::size_t optimizer) const {
    return medians_[problem][optimizer];
  }
  // The ranked, best first, then those apart, each as it is compared with them. At the tolerances
  // of the yardstick by its measure: the standings of the comparison.
  std::vector<Ranked> standings(Measure by, std::size_t target) const;

 private:
  Costs costs(const Order& order, Measure by, std::size_t target) const;

  const Comparison& comparison_;
  std::vector<std::vector<TargetMedians>> medians_;  // [problem][optimizer]
};

}  // namespace isoline::reports
