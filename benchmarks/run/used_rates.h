// The rows of the tables of rates that a plan took its options from, kept in its result folder:
// what was tried, and what it came to, is read there, since a report links no table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/plan/rates.h"

namespace isoline::benchmarks {

// FOLDER/rates.json, schema isoline.rates/1: a row for each problem and optimizer as they were run,
// with the name of its table. The rows of earlier plans stay; none, no file. What it returns are
// remarks for its user: of a damaged file, which is set aside.
std::vector<std::string> write_used_rates(const Rates& rates, const std::vector<Request>& requests,
                                          const std::filesystem::path& folder);

}  // namespace isoline::benchmarks
