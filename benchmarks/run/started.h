// When a run began, as its record says it.
#pragma once

#include <string>

namespace isoline::benchmarks {

std::string time_now();  // "2026-11-21T06:45:42Z"

}  // namespace isoline::benchmarks
