// Cells of records asked for again.
#pragma once

#include "benchmarks/plan/catalog.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

// What the record asked for, of the components that this program has: UsageError where it has them
// no more, or they have other options. Its cell is the one that this program asks for.
Request request_again(const Catalog& catalog, const Record& record, double hard_seconds);

}  // namespace isoline::benchmarks
