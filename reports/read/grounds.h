// Who is compared with whom, and on which settings: methods that were given the very same ones.
#pragma once

#include <vector>

#include "reports/read/comparison.h"

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

}  // namespace isoline::reports
