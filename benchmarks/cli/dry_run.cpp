// The output of --dry-run: the cells of a run with their predicted time, its division into shards,
// or the progress of a run that has begun.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"
#include "benchmarks/shard/split.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"
#include "core/records/request.h"
#include "core/seeds.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// --- the plan of a run

// "36 cells: 4 cached, 2 inapplicable, 30 to run, about 12 s with 2 at a time"
std::string preview_text(const PreviewCounts& counts, int jobs) {
  const std::optional<double> seconds = counts.seconds();
  return fmt::format(
      "{}: {} cached, {} inapplicable, {} to run{}", reports::counted(counts.cells, "cell"),
      counts.cached, counts.inapplicable, counts.missing,
      seconds ? fmt::format(", about {} with {} at a time", duration_text(*seconds / jobs), jobs)
              : "; no time estimate (no earlier runs)");
}

// That text, and how many settings were predicted from others of the same problem.
void print_counts(const Preview& shown, int jobs) {
  say(stdout, preview_text(counts_of(shown.cells), jobs) + "\n");
  if (shown.likened > 0)
    say(stdout,
        fmt::format(
            "{} of problems not probed: assumed to be like the other settings of the problem\n",
            reports::counted(shown.likened, "setting")));
}

// Outlines of records; names those that cannot be read.
std::vector<RecordOutline> outlines_of(const std::vector<fs::path>& folders,
                                       const Listener& listener = {}) {
  std::vector<results::Unreadable> unreadable;
  std::vector<RecordOutline> outlines = record_outlines(folders, unreadable, listener);
  say_left_out(unreadable);
  return outlines;
}

// The preview of a run, from the records in its folder and in other result folders.
Preview preview_of(const PlannedRun& all, const RunArguments& given,
                   const std::vector<fs::path>& folders, Session& session) {
  require_sound(session.catalog(), all.requests);
  std::vector<fs::path> timed = result_folders(all.folder);
  for (const std::string& folder : given.earlier) {
    const std::vector<fs::path> there = result_folders(folder);
    require(!there.empty(), [&] {
      return folder + " is not a result folder; `isoline run --out FOLDER` creates one";
    });
    timed.insert(timed.end(), there.begin(), there.end());
  }
  return preview(session.catalog(), all.requests, folders, EarlierTimes(outlines_of(timed)),
                 {.force = given.force, .reuse = given.reuse, .retry = statuses_of(given.retry)});
}

std::string fate_of(const PreviewedCell& cell) {
  if (cell.is_cached) return "cached";
  return cell.why_inapplicable.empty() ? "run" : "inapplicable: " + cell.why_inapplicable;
}

void print_cells(const std::vector<PreviewedCell>& cells, const RunArguments& given) {
  constexpr std::size_t kMost = 20;
  const std::size_t listed = given.lists_all ? cells.size() : std::min(kMost, cells.size());
  for (std::size_t i = 0; i < listed; ++i) {
    const Request& request = *cells[i].request;
    say(stdout, fmt::format("{:28} {:44} seed {:<4} {}\n", request.problem.spec,
                            request.optimizer.spec, seed_text(request.seed), fate_of(cells[i])));
  }
  if (listed < cells.size())
    say(stdout, fmt::format("… and {} more cell{}; --all lists them\n", cells.size() - listed,
                            cells.size() - listed == 1 ? "" : "s"));
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
                  const RunArguments& given, int jobs) {
  constexpr std::size_t kMost = 20;
  const std::size_t count = plan.shards.size();
  const std::size_t listed = given.lists_all ? count : std::min(kMost, count);
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

int plan_printed(const RunArguments& given, Session& session) {
  PlannedRun all = planned_run(given, session.catalog());
  if (!given.shard.empty()) keep_shard(given.shard, all);
  const int jobs = given.exclusive ? 1 : given.jobs > 0 ? given.jobs : one_a_core();
  const auto count = static_cast<std::size_t>(given.shards);
  const auto folders = count > 0 ? result_folders(all.folder) : std::vector<fs::path>{all.folder};
  Preview shown = preview_of(all, given, folders, session);
  const ShardPlan plan = count > 0 ? shard_plan(all, count, shown) : ShardPlan();
  if (given.as_json) {
    print_json(all, shown, plan, jobs);
    return kGood;
  }
  print_counts(shown, jobs);
  say(stdout, fmt::format("result folder: {}\n", all.folder.string()));
  if (count > 0)
    print_shards(all, shown, plan, given, jobs);
  else
    print_cells(shown.cells, given);
  return kGood;
}

// --- the progress of a run

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

// The known facts about a planned cell.
struct Known {
  double weight = 1;  // predicted seconds; 1 each where nothing was predicted
  std::optional<RecordOutline> latest;
};
using Cells = std::unordered_map<std::string, Known>;

void add_planned(const fs::path& folder, Cells& cells) {
  const fs::path file = folder / "plan.json";
  if (!is_there(file)) return;
  try {
    for (const PlannedCell& one : plan_from_text(read_text(file), file.string()).cells)
      cells.try_emplace(one.cell);
  } catch (const UsageError& error) {  // its run sets it aside, and its records are counted
    say_left_out({{file.string(), reason_without(file.string(), error)}});
  }
}

// The prediction for each cell; cells without one count as the mean of the others. Whether there
// are times among them.
bool add_predicted(const std::vector<PredictedCell>& predicted, Cells& cells) {
  double seconds = 0, known = 0;
  for (const PredictedCell& one : predicted) {
    if (std::isnan(one.seconds)) continue;
    seconds += one.seconds;
    ++known;
  }
  for (const PredictedCell& one : predicted)
    cells[one.cell].weight = !std::isnan(one.seconds) ? one.seconds
                             : known > 0              ? seconds / known
                                                      : 1;
  return known > 0;
}

void add_records(const std::vector<fs::path>& folders, Cells& cells, const Listener& listener) {
  for (RecordOutline& seen : outlines_of(folders, listener)) {
    if (seen.status == Status::interrupted) continue;
    Known& cell = cells[seen.cell];
    if (!cell.latest || cell.latest->started < seen.started) cell.latest = std::move(seen);
  }
}

// Seconds that the rest takes at the pace of the last hour; none where nothing ended in it.
std::optional<double> remaining(const Cells& cells, double left, std::int64_t now) {
  constexpr std::int64_t kWindow = 3600;
  double done = 0;
  std::int64_t first = now;
  for (const auto& [cell, known] : cells) {
    if (!known.latest) continue;
    const auto begun = instant_from(known.latest->started);
    if (!begun || *begun < now - kWindow || *begun > now) continue;
    first = std::min(first, *begun);
    done += known.weight;
  }
  if (!(done > 0)) return std::nullopt;
  return left * static_cast<double>(std::max<std::int64_t>(1, now - first)) / done;
}

// For the result folder and the shards below it. `now` in seconds since 1970. UsageError if both
// are missing.
Census census_of(const fs::path& whole, std::int64_t now, const Listener& listener) {
  const std::vector<fs::path> folders = result_folders(whole);
  Cells cells;
  const auto predicted = read_predicted(whole);
  const bool tells_times = predicted && add_predicted(*predicted, cells);
  require(predicted || !folders.empty(), [&] {
    return fmt::format(
        "{}: no such result folder, or one without records and plan; pass a folder that `isoline "
        "run` wrote",
        whole.string());
  });
  if (!predicted)  // else they name the same cells
    for (const fs::path& folder : folders) add_planned(folder, cells);
  add_records(folders, cells, listener);
  Census census{.planned = cells.size()};
  for (const fs::path& folder : folders) census.running += held_cells(folder);
  double left = 0;
  for (const auto& [cell, known] : cells) {
    census.done += known.latest.has_value();
    census.failed += known.latest && is_failure(known.latest->status);
    if (!known.latest) left += known.weight;
  }
  const std::size_t missing = census.planned - census.done;
  census.running = std::min(census.running, missing);
  census.left = missing - census.running;
  if (tells_times) census.left_seconds = left;
  if (missing > 0) census.remaining_seconds = remaining(cells, left, now);
  return census;
}

std::string or_null(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "null";
}

std::string end_text(double remaining_seconds, std::int64_t now) {
  return instant_text(now + static_cast<std::int64_t>(remaining_seconds));
}

std::string census_json(const Census& census, std::int64_t now) {
  const std::string end =
      census.remaining_seconds ? "\"" + end_text(*census.remaining_seconds, now) + "\"" : "null";
  return fmt::format(
      "{{\"planned\": {}, \"done\": {}, \"running\": {}, \"failed\": {}, \"left\": {}, "
      "\"left_seconds\": {}, \"remaining_seconds\": {}, \"end\": {}}}\n",
      census.planned, census.done, census.running, census.failed, census.left,
      or_null(census.left_seconds), or_null(census.remaining_seconds), end);
}

std::string census_text(const Census& census, std::int64_t now) {
  std::string text = fmt::format("{}: {} done, {} of them failed, {} running, {} left\n",
                                 reports::counted(census.planned, "cell"), census.done,
                                 census.failed, census.running, census.left);
  if (census.done == census.planned) return text;
  if (census.left_seconds)
    text += fmt::format("predicted time of the rest: {}, one cell at a time\n",
                        duration_text(*census.left_seconds));
  if (!census.remaining_seconds)
    return text + "no cell ended in the last hour, so the end cannot be predicted\n";
  return text + fmt::format("at the pace of the last hour, the run ends in {}, at {}\n",
                            duration_text(*census.remaining_seconds),
                            end_text(*census.remaining_seconds, now));
}

}  // namespace

int dry_run(const RunArguments& given, Session& session) {
  if (builtin_suites().contains(given.suite) || !fs::is_directory(given.suite))
    return plan_printed(given, session);
  const std::int64_t now = std::time(nullptr);
  const Census census = census_of(given.suite, now, progress_on_terminal("records"));
  say(stdout, given.as_json ? census_json(census, now) : census_text(census, now));
  return census.failed > 0 ? kWorse : kGood;
}

}  // namespace isoline::benchmarks
