// The division of a plan, counted.
#include "benchmarks/cli/shard_plan.h"

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/certificate.h"
#include "benchmarks/shard/split.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

Preview foreseen(const Undertaking& all, const RunArguments& given,
                 const std::vector<std::string>& earlier, const std::vector<fs::path>& folders,
                 Session& session) {
  require_sound(session.catalog(), all.requests);
  std::vector<fs::path> timed = result_folders(all.folder);
  for (const std::string& folder : earlier) {
    const std::vector<fs::path> there = result_folders(folder);
    require(!there.empty(), [&] { return folder + ": no such result folder"; });
    timed.insert(timed.end(), there.begin(), there.end());
  }
  return preview(session.catalog(), all.requests, folders, EarlierTimes(glances_at(timed)),
                 {.force = given.force, .reuse = given.reuse, .retry = statuses_of(given.retry)});
}

ShardPlan shards_of(const Undertaking& all, std::size_t count, Preview& shown) {
  ShardPlan plan{.weights = keep_predictions(all.folder, shown),
                 .shards = std::vector<PreviewCounts>(count)};
  const std::vector<double> weights = weights_of(all.requests, all.folder);
  const std::vector<std::size_t> shards = split(all.requests, weights, count);
  for (std::size_t i = 0; i < shards.size(); ++i) plan.shards[shards[i]].add(shown.cells[i]);
  return plan;
}

}  // namespace isoline::benchmarks
