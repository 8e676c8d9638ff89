// The worked examples of the README, compiled as the page prints them.
#pragma once

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

Catalog catalog_with_readme_examples();      // generated, with the two below
std::vector<std::string> readme_problems();  // names of its examples
std::vector<std::string> readme_optimizers();

}  // namespace isoline::benchmarks
