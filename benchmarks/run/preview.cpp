// What a plan would do: looked up in the store, probed and estimated.
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

// What one problem says of itself and of each optimizer, found in a process of its own.
struct Probe {
  double forward_seconds = 0;
  double unknowns = 0;
  std::map<std::string, std::string> reasons;  // by optimizer spec
};

double time_forward(const Problem& problem) {
  constexpr int kTimes = 5;
  Point point;
  double least = 1e9;
  for (int i = 0; i < kTimes; ++i) {
    const std::int64_t begin = monotonic_nanoseconds();
    problem.forward(problem.start(), point);
    least = std::min(least, 1e-9 * static_cast<double>(monotonic_nanoseconds() - begin));
  }
  return least;
}

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

Json probe(const Catalog& catalog, const Setting& setting) {
  const Problem problem = make_problem(catalog, *setting.problem, 0);
  Json reasons = Json::object();
  for (const auto& [spec, optimizer] : setting.optimizers)
    reasons[spec] =
        why_inapplicable(catalog.optimizers.at(optimizer->name), optimizer->options, problem);
  return {{"forward_seconds", time_forward(problem)},
          {"unknowns", problem.unknowns()},
          {"reasons", std::move(reasons)}};
}

Probe probe_from(const Json& found) {
  return {found.at("forward_seconds"), found.at("unknowns"), found.at("reasons")};
}

// Of the first settings, as many as there is time for, made in one process.
std::vector<Probe> probes_together(const Catalog& catalog, const std::vector<Setting>& settings) {
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
  std::vector<Probe> probes;
  if (text)
    for (const Json& found : parse_json(*text, "probes")) probes.push_back(probe_from(found));
  return probes;
}

// One process each, where one of them cannot be made here: its cells will say so when they run.
std::vector<Probe> probes_apart(const Catalog& catalog, const std::vector<Setting>& settings) {
  constexpr std::size_t kMost = 200;
  std::vector<Probe> probes;
  for (const Setting& setting : settings) {
    if (probes.size() == kMost) break;
    const auto text =
        isolated_text([&] { return json_text(probe(catalog, setting)); }, kProbeSeconds).text;
    probes.push_back(text ? probe_from(parse_json(*text, "probe")) : Probe());
  }
  return probes;
}

// What the problems say of themselves, by spec: those that were probed, and by name for the others.
class Probes {
 public:
  Probes(const Catalog& catalog, const std::vector<Request>& requests) {
    const std::vector<Setting> settings = settings_of(requests);
    std::vector<Probe> probes = probes_together(catalog, settings);
    if (probes.empty()) probes = probes_apart(catalog, settings);
    unknown_ = settings.size() - probes.size();
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const Probe& kept = by_spec_[settings[i].problem->spec] = std::move(probes[i]);
      by_name_.try_emplace(settings[i].problem->name, &kept);
    }
  }
  const Probe& of(const Component& problem) const {
    static const Probe none;
    if (const auto at = by_spec_.find(problem.spec); at != by_spec_.end()) return at->second;
    const auto like = by_name_.find(problem.name);
    return like == by_name_.end() ? none : *like->second;
  }
  std::size_t unknown() const { return unknown_; }

 private:
  std::map<std::string, Probe> by_spec_;
  std::map<std::string, const Probe*> by_name_;
  std::size_t unknown_ = 0;
};

double estimate(const Catalog& catalog, const Request& request, const Probe& probed) {
  const ProblemCost cost{probed.forward_seconds, probed.unknowns};
  return predicted_seconds(catalog, request, cost) + kProcessSeconds;
}

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

// Of each request, whether one of the folders has it.
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
  if (cell.is_missing()) seconds += cell.seconds;
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
    const Probe& probed = probes.of(request.problem);
    const auto reason = probed.reasons.find(request.optimizer.spec);
    PreviewedCell cell{.request = &request, .is_cached = is_cached[i] != 0};
    if (reason != probed.reasons.end()) cell.why_inapplicable = reason->second;
    const std::optional<double> took = earlier.of(request);
    all.timed += took.has_value();
    if (cell.why_inapplicable.empty())
      cell.seconds = took ? *took + kProcessSeconds : estimate(catalog, request, probed);
    all.cells.push_back(std::move(cell));
  }
  return all;
}

}  // namespace isoline::benchmarks
