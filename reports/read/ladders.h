// Medians of all cells to all 51 targets by every measure, and who stands where at each: what the
// page's slider of tolerance and its switch of measure choose from.
#pragma once

#include <vector>

#include "reports/read/comparison.h"
#include "reports/read/reached.h"

namespace isoline::reports {

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
