// Finds the fields of methods that were given the same settings.
#include "reports/read/grounds.h"

#include <algorithm>
#include <map>
#include <set>

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

}  // namespace isoline::reports
