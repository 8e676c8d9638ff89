// Methods for a reader's own problem: those that need no more than the reader has, ranked by what
// they did on settings of that size within a budget.
#pragma once

#include <array>
#include <limits>
#include <string_view>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::results {

// Offers of a simulator besides y = P(x): each level includes those before it.
enum class Derivatives { none, gradient, jacobian, hessian };
inline constexpr std::array<std::string_view, 4> kDerivativeNames = {"forward", "gradient",
                                                                     "jacobian", "hessian"};

struct Means {
  Derivatives derivatives = Derivatives::none;
  bool has_inverse = false;  // a local inverse of the physics
  Index least_unknowns = 0, most_unknowns = std::numeric_limits<Index>::max();
  Real budget = kNever;  // of work, in forward solves
  Real noise = 0;  // in the data, over their rms: settings with up to three times less or more
  bool has_bounds = false;    // on the unknowns
  bool has_failures = false;  // some calls fail
};
// The classes of unknowns that a reader chooses from: up to 10, 11 to 100, more than 100.
inline constexpr std::array<std::array<Index, 2>, 3> kSizeClasses = {
    {{0, 10}, {11, 100}, {101, Means{}.most_unknowns}}};

// The data that a reader can choose from, by the settings there are: exact without bounds, with
// noise of each size, with bounds, with calls that fail.
std::vector<Means> kinds_of_data(const Comparison& comparison);

// A method under one name, whatever it saw on each setting.
struct Advised {
  std::size_t optimizer = 0;  // its row on most of the settings
  std::size_t settings = 0;   // that it was run on and needs no more for
  std::size_t solved = 0;     // of them, by the median run within the budget
  Real score = 0;             // of its profile among these methods
  Real work = kNever;         // the median over these settings, in forward solves
  bool is_in_group = false;   // not significantly worse than the best
};
struct Advice {
  std::size_t of_size = 0;  // settings of that size
  // Those that count: all of that size, or those of a method that was run on some alone and solves
  // more of them than the first of the others.
  std::vector<std::size_t> settings;
  std::vector<Advised> ranked;   // run on all that count, best first; none where none solves any
  std::vector<Advised> partial;  // run on some
};
// On direct problems whose x the data determine. What a method needs is what its runs were counted
// to ask for.
Advice advise(const Comparison& comparison, const Means& means);

}  // namespace isoline::results
