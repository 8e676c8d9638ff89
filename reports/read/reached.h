// What runs took to reach each tolerance, and each of the 51 targets.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "core/ladder.h"
#include "reports/read/comparison.h"

namespace isoline::reports {

inline constexpr std::size_t kTargets = kRungs;

// The least loss any run of a problem and seed has reached: f_L where none is declared.
class BestKnown {
 public:
  using Minima = std::map<std::pair<std::string, std::uint64_t>, Real>;  // by problem and seed

  explicit BestKnown(const Study& study);
  explicit BestKnown(Minima least) : least_(std::move(least)) {}
  // Declared, else the best known; not-a-number where no run of its problem and seed is.
  Real minimum(const Record& record) const;

 private:
  Minima least_;
};

// Fills the minimum, work and seconds: exact from the record's hits, otherwise read off the kept
// curve.
void fill_reached(Run& run, const BestKnown& best);

// Fills the costs, once the minimum is there.
void fill_costs(Run& run, const Prices& prices);

// Costs at which the run first met the targets τ = 10^(−j/5), j = 0 … count − 1, infinite where it
// did not.
std::vector<Real> target_costs(const Run& run, const Prices& prices, std::size_t count);

// What each of the targets took, over seeds: what the page's slider of tolerance reads. Exact from
// the hits of the records, otherwise read off their kept curves, as the tables are.
struct TargetMedians {
  std::vector<Real> work, seconds;   // of the targets whose median work is finite
  std::vector<std::size_t> reached;  // how many targets each run reached, by seed
};
TargetMedians target_medians(const Comparison& comparison, const Cell& cell);

}  // namespace isoline::reports
