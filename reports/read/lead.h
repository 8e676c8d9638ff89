// Who leads a field of methods over given problems, by how much, and whether that is settled. From
// costs alone.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/results/statistics.h"

namespace isoline::reports {

using namespace results;  // statistics, as if they were ours

inline constexpr Real kProfileEnd = 64;  // the factor up to which a profile's area ranks

// Rows of costs by name of problem: settings of one problem are no two witnesses.
using Groups = std::vector<std::vector<std::size_t>>;

// Two methods over the problems that both were asked and one of them solves.
struct Pairing {
  // log2(cost of a / cost of b) a name, the median over its settings: within ±log2 kProfileEnd,
  // which is also what solving against not solving counts; 0 on a setting that neither solves.
  std::vector<Real> doublings;
  std::size_t wins = 0, losses = 0, ties = 0;  // of a, over names
  std::size_t neither = 0;                     // names that neither solves: left out of all else

  Real typical() const;  // what b costs as a multiple of what a costs: 2^(−median); 1 of nothing
  std::array<Real, 2> interval() const;  // of it: 95 % of that median
};
Pairing pairing_of(const Costs& costs, const Groups& groups, std::size_t a, std::size_t b);

struct Scored {
  std::size_t optimizer = 0;
  Real score = 0;  // area of its profile up to kProfileEnd, among those compared
  std::size_t solved = 0, wins = 0, problems = 0;  // wins: least cost of all compared, ties all
};
// All that were asked something, best first.
std::vector<Scored> ranked_by(const Costs& costs);
bool are_tied(Real score, Real other);

// One of the others, against the leader.
struct Rival {
  std::size_t optimizer = 0;
  Pairing pairing;       // the leader's
  Real p = 1;            // of the mean doublings, by sign flips
  Real adjusted = 1;     // after Holm over all rivals
  bool is_told() const;  // apart from the leader and behind it, after Holm
};

struct Lead {
  std::vector<Scored> ranked;  // best first
  std::size_t tied = 1;        // so many share the greatest score
  std::vector<Rival> rivals;   // in the order of their rank; those left out of the family missing
  // Each rival is behind at kSignificant over kLeastNames problems or more.
  bool is_settled = false;
  // Share of kDraws drawings of the problems anew that leave the first one first; ties share.
  Real stays_first = 0;

  std::size_t told() const;  // rivals told apart after Holm
};
inline constexpr Real kSignificant = 0.05;
inline constexpr std::size_t kLeastNames = 8;

// Nothing where no problem is solved. in_family[s]: s is worth testing the leader against.
std::optional<Lead> lead_among(const Costs& costs, const Groups& groups,
                               const std::vector<bool>& in_family);

// The factor between two methods that data as these find in 80 % of all cases at kSignificant.
Real detectable_factor(const Pairing& pairing);

}  // namespace isoline::reports
