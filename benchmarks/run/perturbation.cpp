// Moves the components of a start by one unit in the last place each.
#include "benchmarks/run/perturbation.h"

#include <cmath>
#include <limits>

#include "core/random.h"

namespace isoline::benchmarks {

Vector perturbed_start(Vector start, const Request& request, int number) {
  constexpr Real kUnit = std::numeric_limits<Real>::epsilon();  // of 1
  constexpr Real kAbove = std::numeric_limits<Real>::infinity();
  const Real largest = start.size() > 0 ? start.cwiseAbs().maxCoeff() : 0;
  const Real of_zero = kUnit * (largest > 0 ? largest : 1);
  Vector signs(start.size());
  RandomStream(request.seed, request.problem.name, "last bit", static_cast<std::uint64_t>(number))
      .signs(signs);
  for (Index i = 0; i < start.size(); ++i)
    start[i] = start[i] == 0 ? signs[i] * of_zero : std::nextafter(start[i], signs[i] * kAbove);
  return start;
}

}  // namespace isoline::benchmarks
