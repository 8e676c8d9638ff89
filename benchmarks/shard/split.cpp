// Divides plans by predicted times. Plans can have hundreds of thousands of cells, so predictions
// are written and read without a JSON tree.
#include "benchmarks/shard/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <unordered_map>

#include "benchmarks/run/store.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"
#include "core/records/record.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastSeconds = 1e-2;  // a fork, a record, its fsync: on a busy machine

// In forward solves, not in seconds: the smallest cost of a step is the same for all methods.
double declared_work(const Request& request) {
  constexpr double kWorkPerIteration = 3;
  return std::min(static_cast<double>(request.budget.work),
                  kWorkPerIteration * static_cast<double>(request.budget.iterations));
}

// The predictions of a folder by cell; UsageError where they lack one of these.
std::unordered_map<std::string, double> predictions_for(const std::vector<const Request*>& requests,
                                                        const fs::path& folder) {
  std::unordered_map<std::string, double> seconds;
  const auto predicted = read_predicted(folder);
  if (!predicted) return seconds;
  for (const PredictedCell& one : *predicted) seconds.emplace(one.cell, one.seconds);
  const auto known = static_cast<std::size_t>(std::ranges::count_if(
      requests, [&](const Request* request) { return seconds.contains(request->cell); }));
  require(known == requests.size(), [&] {
    return fmt::format(
        "{} belongs to another plan: it contains {} of this plan's {} cells; use another --out",
        predicted_file(folder).string(), known, requests.size());
  });
  return seconds;
}

}  // namespace

fs::path predicted_file(const fs::path& folder) { return folder / "predicted.json"; }

std::string file_text(const std::vector<PredictedCell>& cells) {
  std::string text = fmt::format("{{\"schema\": \"{}\", \"cells\": [", kPredictedSchema);
  const char* between = "\n";
  for (const PredictedCell& one : cells) {
    text += fmt::format("{}{{\"cell\": \"{}\", \"seconds\": {}}}", between, one.cell,
                        std::isnan(one.seconds) ? "null" : fmt::format("{}", one.seconds));
    between = ",\n";
  }
  return text + "\n]}\n";
}

std::vector<PredictedCell> predicted_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    require(json.at("schema").get<std::string>() == kPredictedSchema,
            "its schema is not supported");
    std::vector<PredictedCell> cells;
    for (const JsonView& one : json.at("cells").values()) {
      const JsonView seconds = one.at("seconds");
      cells.push_back({one.at("cell"), seconds.is_null() ? kUnknown : real_of(seconds)});
      require(!(cells.back().seconds <= 0), "the time of a cell must be positive");
    }
    return cells;
  } catch (const UsageError& error) {
    throw UsageError(
        fmt::format("{} is not a valid {}: {}", origin, kPredictedSchema, error.what()));
  }
}

std::optional<std::vector<PredictedCell>> read_predicted(const fs::path& folder) {
  const fs::path file = predicted_file(folder);
  if (!is_there(file)) return std::nullopt;
  return predicted_from_text(read_text(file), file.string());
}

Weights keep_predictions(const fs::path& folder, Preview& shown) {
  if (!is_there(predicted_file(folder))) {
    if (!names_in(folder / "shards").empty()) return Weights::declared;
    std::vector<PredictedCell> cells;
    for (const PreviewedCell& one : shown.cells)
      cells.push_back(
          {one.request->cell, one.seconds ? std::max(*one.seconds, kLeastSeconds) : kUnknown});
    std::error_code error;
    fs::create_directories(folder, error);  // where it cannot be made the next line says so
    write_text(predicted_file(folder), file_text(cells));
    return Weights::written;
  }
  std::vector<const Request*> requests;
  for (const PreviewedCell& one : shown.cells) requests.push_back(one.request);
  const auto predictions = predictions_for(requests, folder);
  for (PreviewedCell& cell : shown.cells) {
    const double seconds = predictions.at(cell.request->cell);
    cell.seconds = std::isnan(seconds) ? std::nullopt : std::optional(seconds);
  }
  return Weights::kept;
}

std::vector<double> weights_of(const std::vector<Request>& requests, const fs::path& folder) {
  std::vector<const Request*> all;
  for (const Request& request : requests) all.push_back(&request);
  const auto predictions = predictions_for(all, folder);
  std::vector<double> weights;
  double known_seconds = 0, known_work = 0;
  for (const Request& request : requests) {
    const auto at = predictions.find(request.cell);
    weights.push_back(at == predictions.end() ? kUnknown : at->second);
    if (std::isnan(weights.back())) continue;
    known_seconds += weights.back();
    known_work += declared_work(request);
  }
  const double pace = known_seconds > 0 ? known_seconds / known_work : 1;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (std::isnan(weights[i])) weights[i] = pace * declared_work(requests[i]);
  return weights;
}

// Shards: parsed, weighed and assigned.

namespace {

constexpr std::size_t kMostShards = 100'000;
// How a scheduler numbers the tasks of an array: the environment variables that hold the index of
// this task, the least and the greatest index, the number of tasks, and the step between indices.
// An empty name: the scheduler sets no such variable.
struct Scheduler {
  const char *name, *index, *first, *last, *count, *step;
  std::size_t base;          // the least index if `first` is empty
  const char* outside = "";  // the value of `index` in a job that is not an array
};

constexpr Scheduler kSchedulers[] = {
    {"SLURM", "SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "", "SLURM_ARRAY_TASK_COUNT",
     "SLURM_ARRAY_TASK_STEP", 0},
    {"PBS", "PBS_ARRAY_INDEX", "", "", "", "", 1},
    {"TORQUE", "PBS_ARRAYID", "", "", "", "", 1},
    {"LSF", "LSB_JOBINDEX", "", "LSB_JOBINDEX_END", "", "LSB_JOBINDEX_STEP", 1, "0"},
    {"SGE", "SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", "", "SGE_TASK_STEPSIZE", 1,
     "undefined"},
    {"HTCondor", "_CONDOR_PROCNO", "", "", "_CONDOR_NPROCS", "", 0},
    {"Kubernetes", "JOB_COMPLETION_INDEX", "", "", "", "", 0},
};
constexpr const char* kCount = "ISOLINE_SHARDS";  // for schedulers that do not set the number

// A number of digits alone; nothing of anything else.
std::optional<std::size_t> number_in(const std::string& text) {
  constexpr std::size_t kMostDigits = 9;
  if (text.empty() || text.size() > kMostDigits) return std::nullopt;
  if (text.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return std::stoul(text);
}

std::optional<Shard> shard_in(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto index = number_in(text.substr(0, slash)), count = number_in(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count || *count > kMostShards)
    return std::nullopt;
  return Shard{*index, *count};
}

// The position of this task in its array, whose indices may begin anywhere and have even gaps.
Shard shard_of_array(const Scheduler& of, const Environment& environment) {
  std::string found;
  for (const char* variable : {of.index, of.first, of.last, of.count, of.step, kCount})
    if (*variable != 0)
      found += fmt::format("{}{}={}", found.empty() ? "" : " ", variable, environment(variable));
  const auto number = [&](const char* variable) { return number_in(environment(variable)); };
  const auto id = number(of.index), first = *of.first == 0 ? of.base : number(of.first),
             last = number(of.last);
  const std::size_t step = number(of.step).value_or(1);
  auto count = number(of.count);
  if (!count && first && last && *last >= *first && step > 0) count = (*last - *first) / step + 1;
  if (!count) count = number(kCount);
  require(count.has_value(), [&] {
    return fmt::format(
        "--shard auto requires the number of tasks, which {} does not set here; set {} to it, got "
        "{}",
        of.name, kCount, found);
  });
  const bool is_one = id && first && step > 0 && *id >= *first && (*id - *first) % step == 0 &&
                      (*id - *first) / step < *count && *count <= kMostShards;
  require(is_one, [&] {
    return fmt::format(
        "--shard auto requires a task of a {} array whose indices have equal steps{}, got {}",
        of.name, *of.first == 0 ? fmt::format(" and begin at {}", of.base) : "", found);
  });
  return {(*id - *first) / step + 1, *count};
}

// UsageError unless this process is a task of exactly one scheduler's array.
const Scheduler& scheduler_of(const Environment& environment) {
  std::vector<const Scheduler*> set;
  std::string known, found;
  for (const Scheduler& each : kSchedulers) {
    known += fmt::format(", {}", each.index);
    const std::string value = environment(each.index);
    if (value.empty() || value == each.outside) continue;
    set.push_back(&each);
    found += fmt::format("{}{}={}", found.empty() ? "" : ", ", each.index, value);
  }
  require(!set.empty(), [&] {
    return "--shard auto works only in a task of a job array, or if ISOLINE_SHARD is set; none of "
           "these environment variables is set: ISOLINE_SHARD" +
           known;
  });
  require(set.size() == 1, [&] {
    return fmt::format(
        "--shard auto found the variables of {} schedulers ({}); set ISOLINE_SHARD, such as 3/16",
        set.size(), found);
  });
  return *set.front();
}

}  // namespace

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

fs::path Shard::folder(const fs::path& whole) const {
  return whole / "shards" / fmt::format("{}-of-{}", index, count);
}

std::string of_this_process(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

Shard shard_of(const std::string& asked, const Environment& environment) {
  const bool is_automatic = asked == "auto";
  const std::string own = environment("ISOLINE_SHARD");
  if (is_automatic && own.empty()) return shard_of_array(scheduler_of(environment), environment);
  const std::string& text = is_automatic ? own : asked;
  const auto shard = shard_in(text);
  require(shard.has_value(), [&] {
    return fmt::format("{} must be I/N with 1 ≤ I ≤ N ≤ {}{}, got '{}'",
                       is_automatic ? "ISOLINE_SHARD" : "--shard", kMostShards,
                       is_automatic ? "" : ", or auto", text);
  });
  return *shard;
}

std::vector<std::size_t> split(const std::vector<Request>& requests,
                               const std::vector<double>& weights, std::size_t shards) {
  std::vector<std::size_t> order(requests.size()), shard_of_each(requests.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    if (weights[a] != weights[b]) return weights[a] > weights[b];
    return requests[a].cell < requests[b].cell;
  });
  using Load = std::pair<double, std::size_t>;  // the least comes first, of equals the first shard
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::size_t shard = 0; shard < shards; ++shard) loads.emplace(0, shard);
  for (const std::size_t cell : order) {
    const auto [load, shard] = loads.top();
    loads.pop();
    shard_of_each[cell] = shard;
    loads.emplace(load + weights[cell], shard);
  }
  return shard_of_each;
}

std::vector<Request> part_of(std::vector<Request> requests, const std::vector<std::size_t>& shards,
                             const Shard& wanted) {
  std::vector<Request> part;
  for (std::size_t i = 0; i < requests.size(); ++i)
    if (shards[i] == wanted.index - 1) part.push_back(std::move(requests[i]));
  return part;
}

std::vector<fs::path> result_folders(const fs::path& whole) {
  std::vector<fs::path> folders;
  std::error_code unknown;
  if (fs::is_directory(whole / "runs", unknown)) folders.push_back(whole);
  for (const std::string& name : names_in(whole / "shards"))
    if (fs::is_directory(whole / "shards" / name / "runs", unknown))
      folders.push_back(whole / "shards" / name);
  return folders;
}

void adopt_records(const std::vector<Request>& requests, const fs::path& whole,
                   const fs::path& shard) {
  for (const fs::path& other : result_folders(whole)) {
    const std::vector<std::string> there = names_in(other / "runs");
    if (other == shard || there.empty()) continue;
    const Store store(shard);
    for (const Request& request : requests) {
      const std::string name = Store::name_of(request);
      if (!std::ranges::binary_search(there, name) || store.has(request)) continue;
      const fs::path from = other / "runs" / name, to = shard / "runs" / name;
      try {
        for (const auto& beside : {field_path, answer_path})
          if (is_there(beside(from))) write_text(beside(to), read_text(beside(from)));
        write_text(to, read_text(from));
      } catch (const UsageError&) {  // it is missing or not a record: then the cell runs
      }
    }
  }
}

}  // namespace isoline::benchmarks
