// Records counted, failures in words.
#include "benchmarks/run/outcome.h"

#include <fmt/format.h>

namespace isoline::benchmarks {

void Outcome::count(const Record& record) {
  ++statuses[record.status];
  if (is_failure(record.status))
    failures.push_back(fmt::format("{}: {}: {}", title_of(record.request), name_of(record.status),
                                   record.message));
  if (record.status == Status::crashed && !crash)
    crash = Crash{record.request, fmt::format("runs/{}-{}.json", record.cell, record.build)};
  if (record.status == Status::interrupted) ++interrupted;
}

std::string title_of(const Request& request) {
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     request.seed);
}

}  // namespace isoline::benchmarks
