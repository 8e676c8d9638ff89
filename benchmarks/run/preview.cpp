// Looks up the cells of a plan in the store, and probes those that are not there. A view of a
// record extracts only the requested values.
#include "benchmarks/run/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "benchmarks/run/store.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/records/record.h"
#include "core/records/request.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

RecordOutline outline_of(const fs::path& file) {
  static thread_local JsonReader reader;
  const std::string text = read_text(file, kMostRecordBytes);
  const JsonView json = reader.parse(text, file.string());
  const JsonView request = json.at("request");
  RecordOutline seen{.cell = json.at("cell"),
                     .problem = request.at("problem").at("spec"),
                     .optimizer = request.at("optimizer").at("spec")};
  seen.budget = budget_from(request.at("budget"));
  seen.threads = request.at("threads");
  const std::optional<Status> status = status_of(json.at("status").get<std::string>());
  require(status.has_value(), "its status is unknown");
  seen.status = *status;
  const bool computes_alone = seen.threads == 1 && !json.contains("foreign");
  seen.seconds =
      real_of(json.at("summary").at(computes_alone ? "processor_seconds" : "wall_seconds"));
  const JsonView provenance = json.at("provenance");
  if (provenance.contains("run")) seen.started = provenance.at("run").at("started");
  return seen;
}

std::string question_of(const std::string& problem, const std::string& optimizer,
                        const Budget& budget, int threads) {
  return fmt::format("{}\n{}\n{} {} {} {} {} {}", problem, optimizer, budget.iterations,
                     budget.work, budget.seconds, budget.target,
                     budget.stall.value_or(kStallIterations), threads);
}

// --- which pairs are inapplicable

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
  for (const Request& request : requests) {
    const auto [at, is_new] = places.try_emplace(request.problem.spec, settings.size());
    if (is_new) settings.push_back({&request.problem, {}});
    settings[at->second].optimizers.try_emplace(request.optimizer.spec, &request.optimizer);
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

// The reasons of the first settings, as many as time permits: in one process, or in one each where
// one of them cannot be made. The cells of that one will say so when they run.
std::vector<Reasons> probes_of(const Catalog& catalog, const std::vector<Setting>& settings) {
  constexpr double kProbeSeconds = 30;
  constexpr std::size_t kAtLeast = 100, kMostApart = 200;
  const auto probe_some = [&] {
    constexpr std::int64_t kNanoseconds = 1'000'000'000;
    const std::int64_t begin = monotonic_nanoseconds();
    Json all = Json::array();
    for (const Setting& setting : settings) {
      if (all.size() >= kAtLeast && monotonic_nanoseconds() - begin > kNanoseconds) break;
      all.push_back(probe(catalog, setting));
    }
    return json_text(all);
  };
  if (const auto text = isolated_text(probe_some, kProbeSeconds).text)
    return parse_json(*text, "probes").get<std::vector<Reasons>>();
  std::vector<Reasons> probes;
  for (const Setting& setting : settings) {
    if (probes.size() == kMostApart) break;
    const auto probe_one = [&] { return json_text(Json(probe(catalog, setting))); };
    const auto text = isolated_text(probe_one, kProbeSeconds).text;
    probes.push_back(text ? parse_json(*text, "probe").get<Reasons>() : Reasons());
  }
  return probes;
}

// For each request, whether one of the folders has it, each found by one look at it.
std::vector<char> cached_in(const std::vector<fs::path>& folders,
                            const std::vector<Request>& requests, const PreviewOptions& options) {
  std::vector<char> is_cached(requests.size());
  for (const fs::path& folder : folders) {
    const RecordsOfAnyBuild earlier(folder);
    share(requests.size(), [&](std::size_t i) {
      if (is_cached[i] != 0 || options.force || !earlier.has(requests[i])) return;
      std::optional<Record> record = Store::find_in(folder, requests[i]);
      if (!record && options.reuse) record = earlier.find(requests[i]);
      is_cached[i] = record && !options.retry.contains(record->status) ? 1 : 0;
    });
  }
  return is_cached;
}

}  // namespace

std::vector<RecordOutline> record_outlines(const std::vector<fs::path>& folders,
                                           std::vector<results::Unreadable>& unreadable,
                                           const Listener& listener) {
  std::vector<std::pair<std::size_t, std::string>> files;  // a path for each would be a kilobyte
  for (std::size_t i = 0; i < folders.size(); ++i)
    for (std::string& name : names_in(folders[i] / "runs"))
      if (name.ends_with(".json")) files.emplace_back(i, std::move(name));
  std::vector<RecordOutline> seen(files.size());
  std::vector<std::string> reasons(files.size());
  const auto path_of = [&](std::size_t i) {
    return folders[files[i].first] / "runs" / files[i].second;
  };
  const auto read = [&](std::size_t i) {
    try {
      seen[i] = outline_of(path_of(i));
    } catch (const UsageError& error) {
      reasons[i] = reason_without(path_of(i).string(), error);
    }
  };
  share(files.size(), read, listener);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (!reasons[i].empty()) unreadable.push_back({path_of(i).string(), std::move(reasons[i])});
  std::erase_if(seen, [](const RecordOutline& one) { return one.cell.empty(); });
  return seen;
}

EarlierTimes::EarlierTimes(const std::vector<RecordOutline>& earlier) {
  for (const RecordOutline& one : earlier) {
    if (one.status == Status::interrupted || !std::isfinite(one.seconds)) continue;
    seconds_[one.cell].push_back(one.seconds);
    seconds_[question_of(one.problem, one.optimizer, one.budget, one.threads)].push_back(
        one.seconds);
  }
  for (auto& [cell, seconds] : seconds_) std::ranges::sort(seconds);
}

std::optional<double> EarlierTimes::of(const Request& request) const {
  if (seconds_.empty()) return std::nullopt;
  auto found = seconds_.find(request.cell);
  if (found == seconds_.end())
    found = seconds_.find(
        question_of(request.problem.spec, request.optimizer.spec, request.budget, request.threads));
  if (found == seconds_.end()) return std::nullopt;
  return found->second[found->second.size() / 2];
}

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
  if (missing == 0) return 0;
  if (timed_ == 0) return std::nullopt;
  return timed_seconds_ * static_cast<double>(missing) / static_cast<double>(timed_);
}

PreviewCounts counts_of(const std::vector<PreviewedCell>& cells) {
  PreviewCounts counts;
  for (const PreviewedCell& cell : cells) counts.add(cell);
  return counts;
}

Preview preview(const Catalog& catalog, const std::vector<Request>& requests,
                const std::vector<fs::path>& folders, const EarlierTimes& earlier,
                const PreviewOptions& options) {
  const std::vector<Setting> settings = settings_of(requests);
  const std::vector<Reasons> probes = probes_of(catalog, settings);
  std::map<std::string_view, const Reasons*> reasons;  // by spec, and else by the problem's name
  for (std::size_t i = 0; i < probes.size(); ++i) {
    reasons[settings[i].problem->spec] = &probes[i];
    reasons.try_emplace(settings[i].problem->name, &probes[i]);
  }
  const auto why_inapplicable = [&](const Request& request) -> std::string {
    auto known = reasons.find(request.problem.spec);
    if (known == reasons.end()) known = reasons.find(request.problem.name);
    if (known == reasons.end()) return "";
    const auto reason = known->second->find(request.optimizer.spec);
    return reason == known->second->end() ? "" : reason->second;
  };
  const std::vector<char> is_cached = cached_in(folders, requests, options);
  Preview all{.cells = {}, .likened = settings.size() - probes.size()};
  all.cells.reserve(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    PreviewedCell cell{.request = &requests[i],
                       .is_cached = is_cached[i] != 0,
                       .why_inapplicable = why_inapplicable(requests[i])};
    if (cell.why_inapplicable.empty()) cell.seconds = earlier.of(requests[i]);
    all.timed += cell.seconds.has_value();
    all.cells.push_back(std::move(cell));
  }
  return all;
}

}  // namespace isoline::benchmarks
