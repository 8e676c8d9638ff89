// How a crash is looked into.
#pragma once

#include <filesystem>
#include <string>

#include "benchmarks/run/runner.h"

namespace isoline::benchmarks {

// Where its record is and what of it says most, the command that repeats it in one process, under a
// debugger or for a core file, and where that would be.
std::string advice_on(const Crash& crash, const std::filesystem::path& folder);

}  // namespace isoline::benchmarks
