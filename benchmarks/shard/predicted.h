// Schema isoline.predicted/1: what the cells of a plan were predicted to take, written once, before
// any of its shards runs. Every task of a run in shards divides the plan by this file alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/run/preview.h"

namespace isoline::benchmarks {

inline constexpr const char* kPredictedSchema = "isoline.predicted/1";

struct PredictedCell {
  std::string cell;
  double seconds = 0;
};

std::filesystem::path predicted_file(const std::filesystem::path& folder);

std::string file_text(const std::vector<PredictedCell>& cells);
std::vector<PredictedCell> predicted_from_text(const std::string& text, const std::string& origin);

// None where the folder has no such file; UsageError where it has one that cannot be read.
std::optional<std::vector<PredictedCell>> read_predicted(const std::filesystem::path& folder);

// How the shards of a folder are to be divided.
enum class Weights { written, kept, declared };

// Writes the predictions of a plan's cells, unless the folder has some, which then take the place
// of those shown; or unless shards were run there without any: these are divided by declared work,
// and stay so. UsageError where the predictions that are there are of another plan.
Weights keep_predictions(const std::filesystem::path& folder, Preview& shown);

// A weight a request, which is all that a split depends on: its predicted seconds, or, in a folder
// without predictions, the forward solves that its budget allows. UsageError where the predictions
// are of another plan.
std::vector<double> weights_of(const std::vector<Request>& requests,
                               const std::filesystem::path& folder);

}  // namespace isoline::benchmarks
