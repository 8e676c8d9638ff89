// Records found by their file names, which contain cell and build.
#include "benchmarks/shard/census.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "benchmarks/run/pending.h"
#include "benchmarks/run/prediction.h"
#include "benchmarks/run/store.h"
#include "benchmarks/shard/split.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/record.h"
#include "core/records/request.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

// False if the file is missing or not a record: then the cell runs.
bool adopt(const fs::path& from, const fs::path& to) {
  try {
    if (const fs::path fields = field_path(from); is_there(fields))
      write_text(field_path(to), read_text(fields));
    write_text(to, read_text(from));
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

}  // namespace

std::size_t adopt_records(const std::vector<Request>& requests, const fs::path& whole,
                          const fs::path& shard) {
  std::size_t adopted = 0;
  for (const fs::path& other : result_folders(whole)) {
    const std::vector<std::string> there = names_in(other / "runs");
    if (other == shard || there.empty()) continue;
    const Store store(shard);
    for (const Request& request : requests) {
      const std::string name = Store::name_of(request);
      if (!std::ranges::binary_search(there, name) || store.has(request)) continue;
      adopted += adopt(other / "runs" / name, shard / "runs" / name);
    }
  }
  return adopted;
}

// Plans, records, locks and predictions, counted.

namespace fs = std::filesystem;

namespace {

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

// The prediction for each cell; cells without one count as the mean of the others.
struct Predicted {
  bool is_there = false, tells_times = false;
};
Predicted add_predicted(const fs::path& whole, Cells& cells) {
  const auto predicted = read_predicted(whole);
  if (!predicted) return {};
  double seconds = 0, known = 0;
  for (const PredictedCell& one : *predicted) {
    if (std::isnan(one.seconds)) continue;
    seconds += one.seconds;
    ++known;
  }
  for (const PredictedCell& one : *predicted)
    cells[one.cell].weight = !std::isnan(one.seconds) ? one.seconds
                             : known > 0              ? seconds / known
                                                      : 1;
  return {true, known > 0};
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

}  // namespace

Census census_of(const fs::path& whole, std::int64_t now, const Listener& listener) {
  const std::vector<fs::path> folders = result_folders(whole);
  Cells cells;
  const Predicted predicted = add_predicted(whole, cells);
  require(predicted.is_there || !folders.empty(),
          [&] { return fmt::format("{} is not a result folder and has no plan", whole.string()); });
  if (!predicted.is_there)  // else they name the same cells
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
  if (predicted.tells_times) census.left_seconds = left;
  if (missing > 0) census.remaining_seconds = remaining(cells, left, now);
  return census;
}

}  // namespace isoline::benchmarks
