// What each oracle of a problem takes, measured in forward solves. Budgets count declared prices;
// these stand in the problem's sheet, for reports.
#pragma once

#include <optional>

#include "core/records/request.h"
#include "core/records/sheet.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

using problems::Problem;

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

}  // namespace isoline::benchmarks
