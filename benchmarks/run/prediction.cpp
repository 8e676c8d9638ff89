// Reads records through a view, which extracts the requested values only.
#include "benchmarks/run/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"
#include "core/records/record.h"
#include "core/records/request.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

std::optional<RecordOutline> outline_of(const fs::path& file) {
  static thread_local JsonReader reader;
  try {
    const std::string text = read_text(file, kMostRecordBytes);
    const JsonView json = reader.parse(text, file.string());
    const JsonView request = json.at("request");
    RecordOutline seen{.cell = json.at("cell"),
                       .problem = request.at("problem").at("spec"),
                       .optimizer = request.at("optimizer").at("spec")};
    seen.budget = budget_from(request.at("budget"));
    seen.threads = request.at("threads");
    const std::optional<Status> status = status_of(json.at("status").get<std::string>());
    require(status.has_value(), "it has no known status");
    seen.status = *status;
    seen.wall_seconds = real_of(json.at("summary").at("wall_seconds"));
    const JsonView provenance = json.at("provenance");
    if (provenance.contains("run")) seen.started = provenance.at("run").at("started");
    return seen;
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

std::string question_of(const std::string& problem, const std::string& optimizer,
                        const Budget& budget, int threads) {
  return fmt::format("{}\n{}\n{} {} {} {} {}", problem, optimizer, budget.iterations, budget.work,
                     budget.seconds, budget.target, threads);
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::vector<RecordOutline> record_outlines(const std::vector<fs::path>& folders,
                                           const Listener& listener) {
  std::vector<std::pair<std::size_t, std::string>> files;  // a path for each would be a kilobyte
  for (std::size_t i = 0; i < folders.size(); ++i)
    for (std::string& name : names_in(folders[i] / "runs"))
      if (name.ends_with(".json")) files.emplace_back(i, std::move(name));
  std::vector<std::optional<RecordOutline>> seen(files.size());
  share(
      files.size(),
      [&](std::size_t i) {
        seen[i] = outline_of(folders[files[i].first] / "runs" / files[i].second);
      },
      listener);
  std::vector<RecordOutline> all;
  for (std::optional<RecordOutline>& one : seen)
    if (one) all.push_back(std::move(*one));
  return all;
}

EarlierTimes::EarlierTimes(const std::vector<RecordOutline>& earlier) {
  std::map<std::string, std::vector<double>> cells, questions;
  for (const RecordOutline& one : earlier) {
    if (one.status == Status::interrupted || !std::isfinite(one.wall_seconds)) continue;
    cells[one.cell].push_back(one.wall_seconds);
    questions[question_of(one.problem, one.optimizer, one.budget, one.threads)].push_back(
        one.wall_seconds);
  }
  for (auto& [cell, seconds] : cells) by_cell_[cell] = median_of(seconds);
  for (auto& [question, seconds] : questions) by_question_[question] = median_of(seconds);
}

std::optional<double> EarlierTimes::of(const Request& request) const {
  if (by_cell_.empty()) return std::nullopt;
  if (const auto own = by_cell_.find(request.cell); own != by_cell_.end()) return own->second;
  const auto other = by_question_.find(
      question_of(request.problem.spec, request.optimizer.spec, request.budget, request.threads));
  return other == by_question_.end() ? std::nullopt : std::optional<double>(other->second);
}

}  // namespace isoline::benchmarks
