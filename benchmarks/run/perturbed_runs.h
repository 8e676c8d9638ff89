// Recorded runs repeated from starts that differ in the last bit: what moves then hangs on
// rounding, and so on the processor and the libraries, not on the method.
#pragma once

#include <optional>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/runner.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

// What the record asked for, of the components that this program has: UsageError where it has them
// no more, or they have other options. Its cell is the one that this program asks for.
Request request_again(const Catalog& catalog, const Record& record, double hard_seconds);

// Recorded runs repeated from starts that differ in the last bit: what moves then hangs on
// rounding, and so on the processor and the libraries, not on the method.

// The records of perturbation `number`, run in a folder that is gone afterwards. Left out are cells
// that a clock or a kill ended, and inapplicable ones. UsageError where a record is of another
// build: its figures would differ by more than the perturbation. Nothing where it was interrupted.
std::optional<std::vector<Record>> perturbed_records(const Catalog& catalog,
                                                     const std::vector<Record>& records, int number,
                                                     RunOptions options);

}  // namespace isoline::benchmarks
