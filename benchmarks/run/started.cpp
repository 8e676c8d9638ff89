// The date of a record, in universal time.
#include "benchmarks/run/started.h"

#include <fmt/chrono.h>

#include <chrono>

namespace isoline::benchmarks {

std::string time_now() {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace isoline::benchmarks
