// What a run took to reach each tolerance.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "reports/comparison.h"

namespace isoline::reports {

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

}  // namespace isoline::reports
