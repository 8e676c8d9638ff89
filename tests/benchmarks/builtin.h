// What is built into the program, for tests of suites and of rates: its catalog, and the cells of a
// suite at its own rates.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"

namespace isoline::benchmarks {

inline const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

inline std::vector<Request> cells_of(const std::string& suite) {
  return expand(catalog(), read_suite(suite), Rates::builtin());
}

}  // namespace isoline::benchmarks
