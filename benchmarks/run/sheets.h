// The sheets of the components that a run used, for the report.
#pragma once

#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/store.h"
#include "core/records/plan.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

// What the registry knows of a component: nothing of it is made, so nothing can go wrong.
Sheet described_problem(const Catalog& catalog, const Component& problem);
Sheet described_optimizer(const Catalog& catalog, const Component& optimizer);

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
// Its privileges are those it would have on any physics, whatever inverse that has.
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

// A sheet for every component of the plan, each made in a process of its own; a problem's with the
// measured prices of its oracles. Where it cannot be made, its sheet tells what the registry knows,
// and the store has a remark.
void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store);

}  // namespace isoline::benchmarks
