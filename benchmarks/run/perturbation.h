// Starts that differ from the given one in the last bit.
#pragma once

#include "core/array.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

// θ₀ with each component moved by one unit in its last place, up or down by the stream
// (seed, problem, "last bit", number). A zero has none of its own: it takes that of the largest
// component, or of 1 where all are zero.
Vector perturbed_start(Vector start, const Request& request, int number);

}  // namespace isoline::benchmarks
