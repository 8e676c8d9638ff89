// The part of a plan that somebody asks for.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

// The cells whose problem and optimizer are among these specs: of the name, and with the options
// that are given. An empty text keeps all. UsageError where nothing is left.
std::vector<Request> filtered(const Catalog& catalog, std::vector<Request> requests,
                              const std::string& problems, const std::string& optimizers);

}  // namespace isoline::benchmarks
