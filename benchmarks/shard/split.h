// A plan divided into shards of about equal predicted time, and the shard that a command line
// selects.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/run/preview.h"
#include "core/records/request.h"

namespace isoline::benchmarks {

// The predicted times of a plan's cells, written once, before any of its shards runs.
// Every task of a run in shards divides the plan by this file alone.
inline constexpr const char* kPredictedSchema = "isoline.predicted/1";

struct PredictedCell {
  std::string cell;
  double seconds = 0;  // NaN: no earlier run predicts it
};

std::filesystem::path predicted_file(const std::filesystem::path& folder);

std::string file_text(const std::vector<PredictedCell>& cells);
std::vector<PredictedCell> predicted_from_text(const std::string& text, const std::string& origin);

// None where the folder has no such file; UsageError where it has one that cannot be read.
std::optional<std::vector<PredictedCell>> read_predicted(const std::filesystem::path& folder);

// How the shards of a folder are to be divided.
enum class Weights { written, kept, declared };

// Writes the predictions of a plan's cells, unless the folder has some, which then replace the
// arguments, or unless shards ran there without predictions: these are divided by nominal cost, and
// remain so. UsageError if existing predictions belong to another plan.
Weights keep_predictions(const std::filesystem::path& folder, Preview& shown);

// A weight a request, which is all that a split depends on: its predicted seconds; where there are
// none, the forward solves that its budget allows, at the pace of those predicted. UsageError where
// the predictions are of another plan.
std::vector<double> weights_of(const std::vector<Request>& requests,
                               const std::filesystem::path& folder);

struct Shard {
  std::size_t index = 1, count = 1;  // the third of sixteen is 3, 16

  std::string text() const;  // "3/16"
  // Where the records of this shard go, below the folder of the whole: "shards/3-of-16".
  std::filesystem::path folder(const std::filesystem::path& whole) const;
};

using Environment = std::function<std::string(const char* variable)>;  // empty: not set
std::string of_this_process(const char* variable);

// "3/16"; or "auto": the text in ISOLINE_SHARD, or else the position of this task in the array of a
// scheduler (docs/on-a-cluster.md). UsageError if none or two are set, or the number of tasks is
// not.
Shard shard_of(const std::string& asked, const Environment& environment = of_this_process);

// The shard of each cell, from 0. The heaviest first, each to the shard that has least (Graham,
// SIAM J. Appl. Math. 17, 1969: the longest processing time first, at most 4/3 of the optimum);
// equal ones in the order of their digests. It depends on nothing else, so that every task finds
// the same split.
std::vector<std::size_t> split(const std::vector<Request>& requests,
                               const std::vector<double>& weights, std::size_t shards);

// The requests of one shard, in their order.
std::vector<Request> part_of(std::vector<Request> requests, const std::vector<std::size_t>& shards,
                             const Shard& wanted);

// The result folders below the folder of a whole that a run in shards has made, in order; and the
// folder itself, first, where it holds records of its own.
std::vector<std::filesystem::path> result_folders(const std::filesystem::path& whole);

// Copies into the folder of a shard the records of its requests, by this build, that stand in the
// folder of the whole or in that of another shard; none that it has itself.
void adopt_records(const std::vector<Request>& requests, const std::filesystem::path& whole,
                   const std::filesystem::path& shard);

}  // namespace isoline::benchmarks
