// isoline plan: prints what a run would do, its predicted time, and its division into shards.
#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/shard/split.h"
#include "core/records/json_view.h"
#include "core/text.h"

namespace isoline::benchmarks {

namespace {

namespace fs = std::filesystem;

struct PlanArguments {
  RunArguments run;
  std::vector<std::string> earlier;  // result folders
  int shards = 0;                    // 0: the whole
  bool as_json = false;
};

void declare(VerbArguments& verb, PlanArguments& given) {
  declare_cells(verb, given.run);
  verb.whole("--jobs", given.run.jobs, "Number of cells at a time (default: one per core)", kJobs);
  declare_what_is_done(verb, given.run);
  verb.whole(
      "--shards", given.shards,
      "Divide the plan into this many shards of about equal time, and write the predictions to "
      "predicted.json in the result folder, unless that file exists",
      kShards);
  verb.texts("--from", given.earlier, "Earlier result folders, from which times are predicted")
      .between_commas();
  verb.flag("--all", given.run.lists_all, "List every shard, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON");
}

struct ShardPlan {
  Weights weights = Weights::written;
  std::vector<PreviewCounts> shards;
};

// Divides the cells; writes the folder's predictions where it has none.
ShardPlan shard_plan(const PlannedRun& all, std::size_t count, Preview& shown) {
  ShardPlan plan{.weights = keep_predictions(all.folder, shown),
                 .shards = std::vector<PreviewCounts>(count)};
  const std::vector<double> weights = weights_of(all.requests, all.folder);
  const std::vector<std::size_t> shards = split(all.requests, weights, count);
  for (std::size_t i = 0; i < shards.size(); ++i) plan.shards[shards[i]].add(shown.cells[i]);
  return plan;
}

std::string counts_json(const PreviewCounts& counts) {
  return fmt::format(
      "\"cells\": {}, \"cached\": {}, \"inapplicable\": {}, \"missing\": {}, \"seconds\": {}",
      counts.cells, counts.cached, counts.inapplicable, counts.missing,
      counts.seconds() ? fmt::format("{}", *counts.seconds()) : "null");
}

void print_json(const PlannedRun& all, const Preview& shown, const ShardPlan& plan, int jobs) {
  std::string text =
      fmt::format("{{{}, \"jobs\": {}, \"folder\": {}, \"shards\": [",
                  counts_json(counts_of(shown.cells)), jobs, json_of_text(all.folder.string()));
  for (std::size_t i = 0; i < plan.shards.size(); ++i)
    text += fmt::format("{}{{\"shard\": \"{}\", {}}}", i == 0 ? "" : ", ",
                        Shard{i + 1, plan.shards.size()}.text(), counts_json(plan.shards[i]));
  say(stdout, text + "]}\n");
}

std::string weights_text(Weights weights, const PlannedRun& all, std::size_t timed) {
  const std::string file = predicted_file(all.folder).string();
  switch (weights) {
    case Weights::written:
      return fmt::format("predictions: {}, {} from earlier runs and {} from nominal costs", file,
                         timed, all.requests.size() - timed);
    case Weights::kept:
      return fmt::format("predictions: {}, written earlier", file);
    case Weights::declared:
      break;
  }
  return "predictions: none, because earlier shards ran without them; the cells are divided by "
         "nominal cost";
}

void print_shards(const PlannedRun& all, const Preview& shown, const ShardPlan& plan,
                  const PlanArguments& given, int jobs) {
  constexpr std::size_t kMost = 20;
  const std::size_t count = plan.shards.size();
  const std::size_t listed = given.run.lists_all ? count : std::min(kMost, count);
  for (std::size_t i = 0; i < listed; ++i)
    say(stdout, fmt::format("shard {:>9}  {}\n", Shard{i + 1, count}.text(),
                            preview_text(plan.shards[i], jobs)));
  if (listed < count)
    say(stdout, fmt::format("… and {} more shard{}; --all lists them\n", count - listed,
                            count - listed == 1 ? "" : "s"));
  double longest = 0;
  for (const PreviewCounts& shard : plan.shards)
    longest = std::max(longest, shard.seconds().value_or(0));
  if (longest > 0)
    say(stdout, fmt::format("the longest shard takes about {}\n", duration_text(longest / jobs)));
  say(stdout, weights_text(plan.weights, all, shown.timed) + "\n");
}

int run(const PlanArguments& given, Session& session) {
  const PlannedRun all = planned_run(given.run, session.catalog());
  const int jobs = given.run.jobs > 0 ? given.run.jobs : one_a_core();
  const auto count = static_cast<std::size_t>(given.shards);
  const auto folders = count > 0 ? result_folders(all.folder) : std::vector<fs::path>{all.folder};
  Preview shown = preview_of(all, given.run, given.earlier, folders, session);
  const ShardPlan plan = count > 0 ? shard_plan(all, count, shown) : ShardPlan();
  if (given.as_json) {
    print_json(all, shown, plan, jobs);
    return kGood;
  }
  print_counts(shown, jobs);
  say(stdout, fmt::format("result folder: {}\n", all.folder.string()));
  if (count > 0) print_shards(all, shown, plan, given, jobs);
  return kGood;
}

}  // namespace

void register_plan(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "plan",
       .help_position = 20,
       .summary = "Print what a run would do, its predicted time, and its division into shards",
       .examples =
           R"(  isoline plan quick                      the cells and their predicted time
  isoline plan quick --shards 16 --from results/before     shards of equal time
  isoline plan quick --shards 16 --json   for the matrix of a workflow)",
       .notes =
           "The predicted time of a cell is its time in records of the result folder and of --from "
           "or, without such a record, the time of the same cell with other seeds. Other cells "
           "have no prediction.\n"
           "`isoline run --shard` divides the plan by predicted.json alone, so all tasks use the "
           "same shards, whenever they start."},
      declare, run));
}

}  // namespace isoline::benchmarks
