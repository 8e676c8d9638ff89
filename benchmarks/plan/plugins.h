// What shared libraries bring, added to a catalog.
#pragma once

#include <string>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

// UsageError, which names the path, where it is no plugin or a name is taken.
void add_plugin(Catalog& catalog, const std::string& path);

}  // namespace isoline::benchmarks
