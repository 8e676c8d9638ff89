// The progress of a plan, from the files in its result folders, whether or not runs continue in
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/records/request.h"
#include "core/threads.h"

namespace isoline::benchmarks {

// Copies into the folder of a shard the records of its requests, by this build, that stand in the
// folder of the whole or in that of another shard; none that it has itself. How many.
std::size_t adopt_records(const std::vector<Request>& requests, const std::filesystem::path& whole,
                          const std::filesystem::path& shard);

// The progress of a plan, from the files in its result folders, whether or not runs continue in
// them.

struct Census {
  std::size_t planned = 0;
  std::size_t done = 0;     // with a record that stays: failed ones too
  std::size_t failed = 0;   // of them
  std::size_t running = 0;  // locked by a run at the moment, according to the file system
  std::size_t left = 0;     // neither done nor running
  std::optional<double> left_seconds;       // predicted of all that are not done, one at a time
  std::optional<double> remaining_seconds;  // until the end, at the pace of the last hour
};

// For the result folder and the shards below it. `now` in seconds since 1970. UsageError if both
// are missing.
Census census_of(const std::filesystem::path& whole, std::int64_t now,
                 const Listener& listener = {});

}  // namespace isoline::benchmarks
