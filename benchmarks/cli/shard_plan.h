// A plan as its shards will divide it, told before any of them runs: what `plan` prints and
// `submit` goes by.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/cli/undertaking.h"
#include "benchmarks/shard/predicted.h"

namespace isoline::benchmarks {

class Session;

// The preview of an undertaking, by the records below its folder and in other result folders.
Preview foreseen(const Undertaking& all, const RunArguments& given,
                 const std::vector<std::string>& earlier,
                 const std::vector<std::filesystem::path>& folders, Session& session);

struct ShardPlan {
  Weights weights = Weights::written;
  std::vector<PreviewCounts> shards;
};

// Writes the folder's predictions where it has none, and divides the cells.
ShardPlan shards_of(const Undertaking& all, std::size_t count, Preview& shown);

}  // namespace isoline::benchmarks
