// The worked examples of the README and the guide, compiled as the pages print them.
#pragma once

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

Catalog catalog_with_readme_examples();      // generated, with the two below
std::vector<std::string> readme_problems();  // names of the examples
std::vector<std::string> readme_optimizers();

}  // namespace isoline::benchmarks
