// The run loop without anything around it.
#include "benchmarks/run/in_process.h"

#include <memory>

#include "benchmarks/run/execute.h"
#include "core/threads.h"

namespace isoline::benchmarks {

void run_in_process(const Catalog& catalog, const std::vector<Request>& requests,
                    const std::function<void(const Request&, const Trace&)>& ended) {
  for (const Request& request : requests) {
    set_library_threads(request.threads);
    const auto trace = std::make_unique<Trace>();  // too large for a stack
    execute(catalog, request, *trace);
    ended(request, *trace);
  }
}

}  // namespace isoline::benchmarks
