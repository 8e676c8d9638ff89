// A result folder as one file that others can cite: the same bytes from the same folder, wherever
// and whenever it is made.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/threads.h"

namespace isoline::benchmarks {

struct Packed {
  std::size_t records = 0, files = 0;
  std::vector<std::string> left_out;  // names of what stands there and is no plain file
};

// The records with their fields, the plan, the rates, the audit, the sheets and the report, after a
// manifest of them all. What else stands in the folder stays there. Whole or not at all; UsageError
// where there is no record.
Packed pack_results(const std::filesystem::path& folder, const std::filesystem::path& out,
                    const Listener& listener = {});

}  // namespace isoline::benchmarks
