// The two jobs that SLURM is given for a run in shards: an array, a task a shard, and one that
// merges and reports once all tasks have ended, however they ended. Words alone: nothing is run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isoline::benchmarks {

struct Submission {
  std::string name;                      // of the plan
  std::filesystem::path program;         // the one that all tasks run
  std::filesystem::path folder, merged;  // result folder of the whole, and of the union
  std::vector<std::string> run;          // words after `isoline run`, but for the shard's
  std::vector<std::pair<std::string, std::string>> environment;  // that fixes the kernels
  std::size_t shards = 1;
  int processors = 1;                // of a task
  double seconds = 0;                // limit of a task; 0: the partition's
  std::vector<std::string> options;  // further ones of sbatch, as they are
};

// As a POSIX shell runs it; it prints the number of the job.
std::string array_command(const Submission& given);
// The same; the array's number is what the variable `array` holds.
std::string merge_command(const Submission& given);

// SLURM's bound on the indices of an array, in what `scontrol show config` prints: they are below.
std::optional<std::size_t> most_array_size(const std::string& config);

// How many shards: as many as are wanted, but for the bound on arrays, and for shards that are
// shorter than `least` seconds; one at least.
struct ShardLimits {
  std::size_t wanted = 16, array_size = 1001;
  double least_seconds = 300;
};
std::size_t shards_within(const ShardLimits& limits, double seconds);

}  // namespace isoline::benchmarks
