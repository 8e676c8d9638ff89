// A learned problem at equal work: what networks have come to when all have spent as much.
#pragma once

#include <optional>
#include <vector>

#include "reports/read/comparison.h"

namespace isoline::reports {

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

}  // namespace isoline::reports
