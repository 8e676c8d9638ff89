// The sheets of the components that a run used, for the report.
#pragma once

#include "benchmarks/catalog.h"
#include "core/sheet.h"

namespace isoline {

Sheet problem_sheet(const Catalog& catalog, const Component& problem);
Sheet optimizer_sheet(const Catalog& catalog, const Component& optimizer);

}  // namespace isoline
