// The metadata of the components that a run used, for the report, with the measured costs of
// oracles.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"
#include "core/records/request.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

// A cost is resolved if a forward solve takes a microsecond and the rounds agree within a factor:
// below, a call is mostly overhead, and its cost varies more between sessions than between rounds.
bool is_resolved(const MeasuredPrice& price, double forward_seconds);

// The cost in forward solves of every oracle that the problem offers, at its start; for a learned
// problem, also of its network alone. Budgets count nominal costs; these are for reports. Takes
// some 10 ms per oracle. Omits a dense matrix that would take more than 10 ms by its nominal cost,
// and everything that is left after one second. Calls another program at most 20 times, not for
// products by differences, and once if a forward solve takes 0.1 s or longer.
MeasuredPrices measure_prices(const Problem& problem, const std::string& build);

// The digest of the sources of a problem alone, to which its certificate and its prices belong.
std::string build_of(const Component& problem);

// The registry's view of a component: nothing is created, so nothing can fail.
Sheet described_problem(const Catalog& catalog, const Component& problem);
Sheet described_optimizer(const Catalog& catalog, const Component& optimizer);

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
Sheet problem_sheet(const Catalog& catalog, const Component& component, const Problem& problem);
// Its extra information is what it would have on any physics, with every kind of inverse.
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

// The metadata of every component of the plan, each created in its own process, with the measured
// costs of a problem's oracles. If that fails, the metadata contain what the registry knows, and
// the store gets a remark.
using Certificates = std::map<std::string, std::string>;  // by problem: the build that has passed
void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                  Progress::Style style = Progress::Style::silent,
                  const Certificates& certificates = {});

}  // namespace isoline::benchmarks
