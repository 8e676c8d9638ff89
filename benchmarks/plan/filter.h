// Which components a selector means, and the cells of a plan that have them.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

// "*" for all, "@family" for the optimizers of a family; "@matrix-free", "@factorizing" (a dense
// factorization of size n) and "@derivative-free" by what a step costs.
bool is_selected(const OptimizerEntry& entry, const std::string& selector);

// The cells whose problem and optimizer are among those named: specs, of which a component must
// have the options that are given, or selectors of optimizers; an empty text names all. UsageError
// where a name is unknown, or no cell is left.
std::vector<Request> filtered(const Catalog& catalog, std::vector<Request> requests,
                              const std::string& problems, const std::string& optimizers);

}  // namespace isoline::benchmarks
