// Checks of components before they run: that specs and networks fit, and that what another program
// computes passes the tests of this tree.
#pragma once

#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

// UsageError with the first component's complaint, before anything is written. Each is made in a
// process of its own: what crashes there is left to its cells to report.
void require_sound(const Catalog& catalog, const std::vector<Request>& requests);

// Checks an external component before it runs, as the tests check the problems of
// this tree: its products by Taylor's slopes, the adjoint identity and its Jacobian, its inverse by
// the round trip, and that the same call gives the same bits.

// UsageError with the first violated property of a problem of these requests, and the measured
// value, or with the reason if a problem cannot be checked, since it fails or does not answer.
// Checks only problems without records in the store, each at the first of its seeds, in its own
// process.
void require_certified(const Catalog& catalog, const std::vector<Request>& requests,
                       const Store& store, Progress::Style style = Progress::Style::silent);

}  // namespace isoline::benchmarks
