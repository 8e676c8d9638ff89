// What the section on measured properties is made of.
#pragma once

#include <vector>

#include "core/records/audited.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using Audits = std::vector<AuditedOptimizer>;

// What this data says, a sentence a property; the last on false declarations.
std::vector<Reading> property_readings(const Audits& all);

std::vector<Plot> property_plots(const Audits& all);  // of each property that is a number

}  // namespace isoline::reports
