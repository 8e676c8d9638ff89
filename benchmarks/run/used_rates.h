// The rows of the tables of rates that a plan took its options from, kept in its result folder:
// what was tried, and what it came to, is read there, since a report links no table.
#pragma once

#include <vector>

#include "benchmarks/plan/rates.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

// FOLDER/rates.json, schema isoline.rates/1: a row for each problem and optimizer as they were run,
// with the name of its table. The rows of earlier plans stay; none, no file. A
// damaged file is set aside.
void write_used_rates(const Rates& rates, const std::vector<Request>& requests, Store& store);

}  // namespace isoline::benchmarks
