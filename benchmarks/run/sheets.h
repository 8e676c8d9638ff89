// The sheets of the components that a run used, for the report.
#pragma once

#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/store.h"
#include "core/records/plan.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
// Its privileges are those it would have on any physics, whatever inverse that has.
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

// A sheet for every component of the plan, each made in a process of its own; a problem's with the
// measured prices of its oracles.
void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store);

}  // namespace isoline::benchmarks
