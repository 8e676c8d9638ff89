// What is built into the program: its catalog, one of its cells by its specs, the cells of a suite
// at its own rates, and its schemas, for tests of what is held to them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "core/json.h"

namespace isoline::benchmarks {

inline const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

inline Request cell_of(const std::string& problem, const std::string& optimizer,
                       const Budget& budget = {}) {
  return named({.problem = complete_problem(catalog(), parse_spec(problem)),
                .optimizer = complete_optimizer(catalog(), parse_spec(optimizer)),
                .budget = budget});
}

inline std::vector<Request> cells_of(const std::string& suite) {
  return expand(catalog(), read_suite(suite), Rates::builtin());
}

inline Json schema(const std::string& name) {
  return parse_json(std::string(builtin_schemas().at(name)), name);
}

}  // namespace isoline::benchmarks
