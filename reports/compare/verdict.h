// The sentence and the exit code that a comparison ends with.
#pragma once

#include "reports/compare/gate.h"

namespace isoline::reports {

// Fills both in, once all else is there.
void conclude(GateResult& result, const GateOptions& options);

}  // namespace isoline::reports
