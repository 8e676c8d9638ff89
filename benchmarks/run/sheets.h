// The sheets of the components that a run used, for the report, with the measured prices of
// oracles.
#pragma once

#include <optional>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"
#include "core/records/plan.h"
#include "core/records/request.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

using problems::Problem;

// What each oracle of a problem takes, measured in forward solves. Budgets count declared prices;
// these stand in the problem's sheet, for reports.

// A price is resolved where a forward solve takes a microsecond and the rounds agree within a
// factor: below, a call is mostly the overhead of calling, and its price drifts from session to
// session by more than the rounds of one tell.
inline constexpr double kLeastForwardSeconds = 1e-6;
bool is_resolved(const MeasuredPrice& price, double forward_seconds);

// Every oracle that the problem offers, at its start, and of a learned one its network alone. Some
// 10 ms an oracle; a dense matrix that would take more than 10 ms, as its declared price has it, is
// left out, and what is left when a second has gone.
MeasuredPrices measure_prices(const Problem& problem, const std::string& build);

// Whose prices these are: they hold for one build on one processor.
std::string prices_build(const Component& problem);
bool are_ours(const std::optional<MeasuredPrices>& prices, const std::string& build);

// What the registry knows of a component: nothing of it is made, so nothing can go wrong.
Sheet described_problem(const Catalog& catalog, const Component& problem);
Sheet described_optimizer(const Catalog& catalog, const Component& optimizer);

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
// Its privileges are those it would have on any physics, whatever inverse that has.
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

// A sheet for every component of the plan, each made in a process of its own; a problem's with the
// measured prices of its oracles. Where it cannot be made, its sheet tells what the registry knows,
// and the store has a remark.
void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                  Progress::Style style = Progress::Style::silent);

}  // namespace isoline::benchmarks
