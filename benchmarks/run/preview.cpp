// A preview of a plan: looked up in the store, and probed.
#include "benchmarks/run/preview.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "benchmarks/run/prediction.h"
#include "core/clock.h"
#include "core/json.h"
#include "core/threads.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace {

constexpr double kProbeSeconds = 30;

// The reason why an optimizer cannot run on a problem, by its spec; empty if it can.
using Reasons = std::map<std::string, std::string>;

// The requests of one problem's setting, one for each optimizer's.
struct Setting {
  const Component* problem;
  std::map<std::string, const Component*> optimizers;  // by spec
};

// By the problem's spec; those that come first by their name stand first.
std::vector<Setting> settings_of(const std::vector<Request>& requests) {
  std::vector<Setting> settings;
  std::map<std::string_view, std::size_t> places;
  const std::string* last = nullptr;
  std::size_t place = 0;
  for (const Request& request : requests) {
    if (!last || *last != request.problem.spec) {
      const auto [at, is_new] = places.try_emplace(request.problem.spec, settings.size());
      if (is_new) settings.push_back({&request.problem, {}});
      place = at->second;
      last = &request.problem.spec;
    }
    settings[place].optimizers.try_emplace(request.optimizer.spec, &request.optimizer);
  }
  std::set<std::string_view> names;
  std::ranges::stable_partition(
      settings, [&](const Setting& each) { return names.insert(each.problem->name).second; });
  return settings;
}

Reasons probe(const Catalog& catalog, const Setting& setting) {
  const Problem problem = make_problem(catalog, *setting.problem, 0);
  Reasons reasons;
  for (const auto& [spec, optimizer] : setting.optimizers)
    reasons[spec] =
        why_inapplicable(catalog.optimizers.at(optimizer->name), optimizer->options, problem);
  return reasons;
}

// Probes the first settings, as many as time permits, in one process.
std::vector<Reasons> probes_together(const Catalog& catalog, const std::vector<Setting>& settings) {
  const auto probe_some = [&] {
    constexpr std::size_t kAtLeast = 100;
    constexpr std::int64_t kNanoseconds = 1'000'000'000;
    const std::int64_t begin = monotonic_nanoseconds();
    Json all = Json::array();
    for (const Setting& setting : settings) {
      if (all.size() >= kAtLeast && monotonic_nanoseconds() - begin > kNanoseconds) break;
      all.push_back(probe(catalog, setting));
    }
    return json_text(all);
  };
  const auto text = isolated_text(probe_some, kProbeSeconds).text;
  std::vector<Reasons> probes;
  if (text)
    for (const Json& found : parse_json(*text, "probes")) probes.push_back(found);
  return probes;
}

// One process each, where one of them cannot be made here: its cells will say so when they run.
std::vector<Reasons> probes_apart(const Catalog& catalog, const std::vector<Setting>& settings) {
  constexpr std::size_t kMost = 200;
  std::vector<Reasons> probes;
  for (const Setting& setting : settings) {
    if (probes.size() == kMost) break;
    const auto text =
        isolated_text([&] { return json_text(Json(probe(catalog, setting))); }, kProbeSeconds).text;
    probes.push_back(text ? parse_json(*text, "probe").get<Reasons>() : Reasons());
  }
  return probes;
}

// The descriptions of the problems, by spec if they were probed, and otherwise by name.
class Probes {
 public:
  Probes(const Catalog& catalog, const std::vector<Request>& requests) {
    const std::vector<Setting> settings = settings_of(requests);
    std::vector<Reasons> probes = probes_together(catalog, settings);
    if (probes.empty()) probes = probes_apart(catalog, settings);
    unknown_ = settings.size() - probes.size();
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const Reasons& kept = by_spec_[settings[i].problem->spec] = std::move(probes[i]);
      by_name_.try_emplace(settings[i].problem->name, &kept);
    }
  }
  std::string why_inapplicable(const Request& request) const {
    const auto own = by_spec_.find(request.problem.spec);
    const auto like = by_name_.find(request.problem.name);
    if (own == by_spec_.end() && like == by_name_.end()) return "";
    const Reasons& reasons = own != by_spec_.end() ? own->second : *like->second;
    const auto reason = reasons.find(request.optimizer.spec);
    return reason == reasons.end() ? "" : reason->second;
  }
  std::size_t unknown() const { return unknown_; }

 private:
  std::map<std::string, Reasons> by_spec_;
  std::map<std::string, const Reasons*> by_name_;
  std::size_t unknown_ = 0;
};

// The cells that a folder has records of, found by one look at it.
class Kept {
 public:
  Kept(std::filesystem::path folder, const PreviewOptions& options)
      : folder_(std::move(folder)), options_(options), earlier_(folder_) {}
  bool has(const Request& request) const {
    if (options_.force || !earlier_.has(request)) return false;
    std::optional<Record> record = Store::find_in(folder_, request);
    if (!record && options_.reuse) record = earlier_.find(request);
    return record && !options_.retry.contains(record->status);
  }

 private:
  std::filesystem::path folder_;
  const PreviewOptions& options_;
  RecordsOfAnyBuild earlier_;
};

// For each request, whether one of the folders has it.
std::vector<char> cached_in(const std::vector<std::filesystem::path>& folders,
                            const std::vector<Request>& requests, const PreviewOptions& options) {
  std::vector<char> is_cached(requests.size());
  for (const std::filesystem::path& folder : folders) {
    const Kept kept(folder, options);
    share(requests.size(), [&](std::size_t i) {
      if (is_cached[i] == 0) is_cached[i] = kept.has(requests[i]) ? 1 : 0;
    });
  }
  return is_cached;
}

}  // namespace

void PreviewCounts::add(const PreviewedCell& cell) {
  ++cells;
  cached += cell.is_cached;
  inapplicable += !cell.is_cached && !cell.why_inapplicable.empty();
  missing += cell.is_missing();
  if (!cell.is_missing() || !cell.seconds) return;
  ++timed_;
  timed_seconds_ += *cell.seconds;
}

std::optional<double> PreviewCounts::seconds() const {
  if (missing > 0 && timed_ == 0) return std::nullopt;
  return missing == 0 ? 0
                      : timed_seconds_ * static_cast<double>(missing) / static_cast<double>(timed_);
}

PreviewCounts counts_of(const std::vector<PreviewedCell>& cells) {
  PreviewCounts counts;
  for (const PreviewedCell& cell : cells) counts.add(cell);
  return counts;
}

Preview preview(const Catalog& catalog, const std::vector<Request>& requests,
                const std::vector<std::filesystem::path>& folders, const EarlierTimes& earlier,
                const PreviewOptions& options) {
  const Probes probes(catalog, requests);
  const std::vector<char> is_cached = cached_in(folders, requests, options);
  Preview all{.cells = {}, .likened = probes.unknown()};
  all.cells.reserve(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const Request& request = requests[i];
    PreviewedCell cell{.request = &request,
                       .is_cached = is_cached[i] != 0,
                       .why_inapplicable = probes.why_inapplicable(request)};
    if (cell.why_inapplicable.empty()) cell.seconds = earlier.of(request);
    all.timed += cell.seconds.has_value();
    all.cells.push_back(std::move(cell));
  }
  return all;
}

}  // namespace isoline::benchmarks
