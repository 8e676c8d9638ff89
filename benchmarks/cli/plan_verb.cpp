// isoline plan: what a run would do, how long it may take, and how it divides into shards.
#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/shard_plan.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/shard/split.h"
#include "core/records/json_view.h"
#include "core/text.h"

namespace isoline::benchmarks {

namespace {

namespace fs = std::filesystem;

std::string json_of(const PreviewCounts& counts) {
  return fmt::format(
      "\"cells\": {}, \"cached\": {}, \"inapplicable\": {}, \"missing\": {}, \"seconds\": {}",
      counts.cells, counts.cached, counts.inapplicable, counts.missing, counts.seconds);
}

void print_json(const Undertaking& all, const Preview& shown, const ShardPlan& plan, int jobs) {
  std::string text =
      fmt::format("{{{}, \"jobs\": {}, \"folder\": {}, \"shards\": [",
                  json_of(counts_of(shown.cells)), jobs, json_of_text(all.folder.string()));
  for (std::size_t i = 0; i < plan.shards.size(); ++i)
    text += fmt::format("{}{{\"shard\": \"{}\", {}}}", i == 0 ? "" : ", ",
                        Shard{i + 1, plan.shards.size()}.text(), json_of(plan.shards[i]));
  say(stdout, text + "]}\n");
}

std::string words_of(Weights weights, const Undertaking& all, std::size_t timed) {
  const std::string file = predicted_file(all.folder).string();
  switch (weights) {
    case Weights::written:
      return fmt::format("predictions: {}, {} by earlier runs and {} by declared prices", file,
                         timed, all.requests.size() - timed);
    case Weights::kept:
      return fmt::format("predictions: {}, as it was written before", file);
    case Weights::declared:
      break;
  }
  return "predictions: none, since shards were run here without; they are divided by declared work";
}

void print_shards(const Undertaking& all, const Preview& shown, const ShardPlan& plan,
                  const PlanArguments& given, int jobs) {
  constexpr std::size_t kMost = 20;
  const std::size_t count = plan.shards.size();
  const std::size_t listed = given.run.lists_all ? count : std::min(kMost, count);
  for (std::size_t i = 0; i < listed; ++i)
    say(stdout, fmt::format("shard {:>9}  {}\n", Shard{i + 1, count}.text(),
                            words_of(plan.shards[i], jobs)));
  if (listed < count) say(stdout, fmt::format("… and {} more; --all lists them\n", count - listed));
  const auto longest = std::ranges::max_element(plan.shards, {}, &PreviewCounts::seconds);
  say(stdout,
      fmt::format("the longest shard takes about {}\n", duration_text(longest->seconds / jobs)));
  say(stdout, words_of(plan.weights, all, shown.timed) + "\n");
}

}  // namespace

int plan_verb(const PlanArguments& given, Session& session) {
  const Undertaking all = undertaking_of(given.run, session.catalog());
  const int jobs = given.run.jobs > 0 ? given.run.jobs : one_a_core();
  const auto count = static_cast<std::size_t>(given.shards);
  const auto folders = count > 0 ? result_folders(all.folder) : std::vector<fs::path>{all.folder};
  Preview shown = foreseen(all, given.run, given.earlier, folders, session);
  const ShardPlan plan = count > 0 ? shards_of(all, count, shown) : ShardPlan();
  if (given.as_json) {
    print_json(all, shown, plan, jobs);
    return kGood;
  }
  print_counts(shown, jobs);
  say(stdout, fmt::format("result folder: {}\n", all.folder.string()));
  if (count > 0) print_shards(all, shown, plan, given, jobs);
  return kGood;
}

}  // namespace isoline::benchmarks
