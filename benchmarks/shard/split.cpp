// Shards: asked for, weighed and dealt.
#include "benchmarks/shard/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <queue>

#include "core/errors.h"
#include "core/files.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostShards = 100'000;
constexpr const char* kVariables[] = {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN",
                                      "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_STEP"};

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

// The place of this task in its array, whose indices may begin anywhere and leave some out evenly.
Shard shard_of_array(const Environment& environment) {
  std::string told;
  for (const char* variable : kVariables)
    told += fmt::format("{}{}={}", told.empty() ? "" : " ", variable, environment(variable));
  const auto id = number_in(environment(kVariables[0])),
             least = number_in(environment(kVariables[1])),
             count = number_in(environment(kVariables[2]));
  const std::size_t step = number_in(environment(kVariables[3])).value_or(1);
  const bool is_one = id && least && count && step > 0 && *id >= *least &&
                      (*id - *least) % step == 0 && (*id - *least) / step < *count;
  require(is_one, [&] {
    return fmt::format("--shard auto: this is no task of an array with even steps: {}", told);
  });
  return {(*id - *least) / step + 1, *count};
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
  if (is_automatic && own.empty()) {
    require(!environment(kVariables[0]).empty(),
            "--shard auto: neither ISOLINE_SHARD nor SLURM_ARRAY_TASK_ID is set here");
    return shard_of_array(environment);
  }
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

}  // namespace isoline::benchmarks
