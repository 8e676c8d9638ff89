// The grid of kept iterations.
#include "core/ladder.h"

#include <cmath>

#include "core/real.h"

namespace isoline {

std::int64_t next_kept_after(std::int64_t iteration) {
  constexpr std::int64_t kEvery = 100;
  constexpr Real kPerDecade = 32;
  if (iteration < kEvery) return iteration + 1;
  const Real passed = std::floor(kPerDecade * std::log10(static_cast<Real>(iteration)) + 1e-9);
  std::int64_t next = iteration;
  for (Real step = passed; next <= iteration; ++step)
    next = std::llround(std::pow(10.0, step / kPerDecade));
  return next;
}

}  // namespace isoline
