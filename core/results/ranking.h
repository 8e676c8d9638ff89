// The settings on which methods are compared, their ranking, and the leader.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/results/decisions.h"
#include "core/results/statistics.h"
#include "core/results/table.h"

namespace isoline::results {

// Methods that were run on the very same settings.
struct Order {
  std::vector<std::size_t> settings, methods;  // problems; optimizers, best first

  bool has(std::size_t optimizer) const;
  bool has_setting(std::size_t problem) const;
};

// A table at a yardstick: pivoted, its optimizers ranked. All that a report says is read off it.
struct Comparison : Table {
  Yardstick yardstick;
  Pivot cells;   // [problem][optimizer]
  Order order;   // the optimizers that are ranked come first of all, best first
  Order sanity;  // the classical and toy problems of a study of physics, which rank no method
  std::array<Profile, kTolerances.size()> profiles;  // of the order
  // Which of the ranked are best at the tightest tolerance; none where nothing is solved.
  std::optional<Decision> decision;
  std::optional<Decision> open_decision;  // among those without extra information alone
  std::size_t names = 0;                  // of problems, options apart

  const Cell& cell(std::size_t problem, std::size_t optimizer) const {
    return cells[problem][optimizer];
  }
  Real taken(const Run& run, Measure by, std::size_t tolerance) const {
    return run.taken(by, yardstick.tolerances[tolerance].rung);
  }
};

Comparison compare_optimizers(const Study& study, const Yardstick& yardstick = {});

// Whether contrasts named in a suite are tested on it: nonlinear and judged by x, with exact data;
// or with noise, where a run is judged by its distance from the least-squares solution.
bool is_contrasted(const ProblemAxis& problem, bool is_noisy);

// Whether a problem counts for the ranking: of a suite with contrasts, the settings that these are
// on. Its other settings are controls, which are listed in place of a sanity check, or ill-posed.
// Elsewhere a tolerance of the loss means little for a network, so learned problems are reported
// separately, by the error in x, unless a study has no others; so are ill-posed ones, by the error
// in x over work, and those whose least loss is unknown, by their losses. Classical and toy
// problems do not count beside physics.
bool is_ordered(const Comparison& comparison, std::size_t problem);
bool is_sanity(const Comparison& comparison, std::size_t problem);
bool is_ill_posed(const Comparison& comparison, std::size_t problem);  // and not learned
bool is_all_learned(const Comparison& comparison);

// costs[p][s]: medians to a target in the unit of their measure; nothing where never planned, nor
// outside the order.
Costs costs_to(const Comparison& comparison, const Order& order, Measure by, std::size_t target);
// To one of the tolerances, by what the yardstick counts unless told otherwise: of all cells, and
// of the order.
Costs median_costs(const Comparison& comparison, std::size_t tolerance,
                   std::optional<Measure> by = {});
Costs common_costs(const Comparison& comparison, std::size_t tolerance,
                   std::optional<Measure> by = {});
Costs ratios_of(const Costs& costs);  // over the least of each problem

std::size_t names_of(const Comparison& comparison, const Order& order);  // of its settings
std::size_t families_of(const Comparison& comparison, const Order& order);
// Its linear settings, or its nonlinear ones.
Order part_of_order(const Comparison& comparison, bool is_linear);
// Whether there are families enough to speak of an order over them.
bool has_order(const Comparison& comparison);

// But for rounding; of equal scores the one that solves more settings is ahead.
bool are_tied(Real score, Real other);
bool are_tied(const Standing& standing, const Standing& other);

// How those of the order did to a target, the headline's or another that a reader chooses; best
// first.
struct Ranked {
  std::size_t optimizer = 0;
  Standing standing;
};
std::vector<Ranked> standings_to(const Comparison& comparison, Measure by, std::size_t target);
std::vector<Ranked> standings_over(const Comparison& comparison, const Order& order, Measure by,
                                   std::size_t target);
// The error in x over ‖x*‖ when this share of its budget of work is spent, over seeds.
Spread x_error_at(const Comparison& comparison, std::size_t problem, std::size_t optimizer,
                  Real share);
// The share of a method's processor time that its oracle calls do not explain at their measured
// prices, over the runs whose calls were all measured and that took long enough to time.
Spread own_time(const Comparison& comparison, std::size_t optimizer);

// A learned problem at equal work: what networks have come to when all have spent as much.

struct AtEqualWork {
  Spread x_error, loss;                  // on the validation, over seeds
  std::size_t diverged = 0;              // runs that count with their last finite value
  std::map<std::uint64_t, Real> errors;  // in x, by seed
};
struct EqualWork {
  Real work = 0;  // declared: the least that any method was allowed
  std::vector<std::optional<AtEqualWork>> methods;  // by optimizer; none where nothing ran

  // The methods with a measured error, least error in x first.
  std::vector<std::size_t> nearest_first() const;
};
// For each run, the last kept point within this work. A run that ended sooner has its last point, a
// diverged one its last finite point; for a failed run it is infinite.
EqualWork equal_work(const Comparison& comparison, std::size_t problem);

// How many times as large the error of the second method is, by the mean of the logarithm over the
// seeds that both have, with its 95 % t interval, or with the range of fewer than six.
struct TimesLarger {
  Real times = kNever;
  std::optional<Interval> interval;
  std::size_t larger = 0, seeds = 0;

  bool is_range() const { return seeds < kFewestForInterval; }
};
TimesLarger times_larger(const AtEqualWork& first, const AtEqualWork& second);

// The optimizers that ran on a problem, best first: by what the yardstick counts, from the tightest
// tolerance to the loosest, then by final loss; of a learned one by the error in x at equal work.
std::vector<std::size_t> ranking(const Comparison& comparison, std::size_t problem);

}  // namespace isoline::results
