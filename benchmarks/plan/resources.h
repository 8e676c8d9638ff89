// The suites, rates, claims, schemas and best losses of the tree, built into the program.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace isoline::benchmarks {

// By file name without ".json".
const std::map<std::string, std::string_view>& builtin_suites();
const std::map<std::string, std::string_view>& builtin_rates();
const std::map<std::string, std::string_view>& builtin_claims();
const std::map<std::string, std::string_view>& builtin_schemas();

std::string_view embedded_best();  // benchmarks/best.json

}  // namespace isoline::benchmarks
