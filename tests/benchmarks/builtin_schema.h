// The schemas that are built into the program, for tests of what is held to them.
#pragma once

#include <string>

#include "benchmarks/plan/catalog.h"
#include "core/json.h"

namespace isoline::benchmarks {

inline Json schema(const std::string& name) {
  return parse_json(std::string(builtin_schemas().at(name)), name);
}

}  // namespace isoline::benchmarks
