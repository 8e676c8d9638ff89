// What a run may spend, and the loss at which it is done.
#pragma once

#include <cstdint>
#include <limits>

namespace isoline {

struct Budget {
  std::int64_t iterations = 1000;
  std::int64_t work = std::numeric_limits<std::int64_t>::max();  // declared prices, in forwards
  double seconds = std::numeric_limits<double>::infinity();      // soft; hard is twice that
  // τ of f ≤ f_L + τ s, or of the error in x where that is sought: f ≤ f_L + τ² s. 0 goes on to the
  // end of the budget.
  double target = 1e-10;
};

}  // namespace isoline
