// The noise and the step of the differences by which J came, which the trace has.
#include <cmath>

#include "benchmarks/run/keepers/keeper.h"

namespace isoline::benchmarks {
namespace {

struct LastDifferences {
  void write(const Trace& trace, Parts& parts) const {
    if (std::isnan(trace.difference_noise)) return;
    parts.differences = {.noise = trace.difference_noise};
    if (!std::isnan(trace.difference_step)) parts.differences->step = trace.difference_step;
  }
};

}  // namespace

Keeper differences_keeper() { return keeper_of<LastDifferences>(); }

}  // namespace isoline::benchmarks
