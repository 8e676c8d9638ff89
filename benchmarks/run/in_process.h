// Cells run in this very process, one after another, for a debugger: nothing stands between a
// mistake and whoever looks for it.
#pragma once

#include <functional>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "core/trace.h"

namespace isoline::benchmarks {

// Each is told when it has ended. No isolation, no limit but the soft budgets, no judge, no record:
// a crash ends this process, and leaves a core file where the shell allows one.
void run_in_process(const Catalog& catalog, const std::vector<Request>& requests,
                    const std::function<void(const Request&, const Trace&)>& ended);

}  // namespace isoline::benchmarks
