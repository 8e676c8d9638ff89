// The suites, rates, claims and schemas of the tree, built into the program.
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

}  // namespace isoline::benchmarks
