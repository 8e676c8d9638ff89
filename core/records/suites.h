// The suites that a plan names, each with its version: "quick@1". Without a version, it is
// version 1.
#pragma once

#include <string>
#include <vector>

namespace isoline {

// Adds a suite that is not there yet. UsageError if another version of it is there: the settings of
// two versions differ, so their results never stand in one ranking.
void add_suite(std::vector<std::string>& suites, const std::string& suite);

}  // namespace isoline
