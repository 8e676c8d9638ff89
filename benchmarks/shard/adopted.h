// Records that another division of the same plan left: what is done is not done again.
#pragma once

#include <filesystem>
#include <vector>

#include "core/records/request.h"

namespace isoline::benchmarks {

// Copies into the folder of a shard the records of its requests, by this build, that stand in the
// folder of the whole or in that of another shard; none that it has itself. How many.
std::size_t adopt_records(const std::vector<Request>& requests, const std::filesystem::path& whole,
                          const std::filesystem::path& shard);

}  // namespace isoline::benchmarks
