// isoline status DIR: prints the progress of a run, with or without shards.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"
#include "benchmarks/shard/split.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/request.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct StatusArguments {
  std::string folder;
  bool as_json = false;
};

void declare(VerbArguments& verb, StatusArguments& given) {
  verb.text("DIR", given.folder, "Result folder of a run, with or without shards").required();
  verb.flag("--json", given.as_json, "Print JSON");
}

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
  } catch (const UsageError&) {
    return;  // damaged: its run sets it aside, and its records are counted
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
  for (RecordOutline& seen : record_outlines(folders, listener)) {
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
        "run` or `isoline plan` wrote",
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

int run(const StatusArguments& given, Session&) {
  const std::int64_t now = std::time(nullptr);
  const Census census = census_of(given.folder, now, progress_on_terminal("records"));
  say(stdout, given.as_json ? census_json(census, now) : census_text(census, now));
  return census.failed > 0 ? kWorse : kGood;
}

}  // namespace

void register_status(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "status",
       .help_position = 24,
       .summary = "Show the progress of a run",
       .examples = "  isoline status results/quick\n  isoline status results/quick --json",
       .notes = "`status` reads the records, the plan and the predictions, and changes nothing.\n"
                "Exit codes: 0 no failed cells, 2 failed cells."},
      declare, run));
}

}  // namespace isoline::benchmarks
