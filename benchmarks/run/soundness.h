// What only shows when components are made: a network that does not fit its problem, a spec within
// a spec that is wrong.
#pragma once

#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

// UsageError with the first component's complaint, before anything is written. Each is made in a
// process of its own: what crashes there is left to its cells to report.
void require_sound(const Catalog& catalog, const std::vector<Request>& requests);

}  // namespace isoline::benchmarks
