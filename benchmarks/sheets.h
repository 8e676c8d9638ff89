// The sheets of the components that a run used, for the report.
#pragma once

#include <vector>

#include "benchmarks/catalog.h"
#include "benchmarks/store.h"
#include "core/sheet.h"

namespace isoline {

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

// A sheet for every component of the plan, each made in a process of its own; a problem's with the
// measured prices of its oracles.
void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store);

// What a store is told of a plan.
std::vector<PlannedCell> planned_cells(const std::vector<Request>& requests);

}  // namespace isoline
