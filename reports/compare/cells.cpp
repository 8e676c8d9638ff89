// Turns records into cells of a comparison, each as it is read.
#include "reports/compare/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "core/digest.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/ladder.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr const char* kDisputed = "two records of this cell and build differ";

// Equal values are kept once, for as long as the program runs.
template <class Value>
std::shared_ptr<const Value> shared_value(const std::string& key, const Value& value) {
  static std::mutex mutex;
  static std::unordered_map<std::string, std::shared_ptr<const Value>> pool;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const Value>& kept = pool[key];
  if (!kept) kept = std::make_shared<const Value>(value);
  return kept;
}

// The geometric mean over kept points of what lies above the smallest that counts: one point that
// differs moves it. Rounding of 1e-16 of the problem's scale moves it by up to 1e-10.
Real mean_of_path(const std::vector<Real>& losses, Real scale) {
  Real sum = 0;
  std::size_t count = 0;
  for (const Real loss : losses) {
    const Real size = std::abs(loss) + kSmallestShare * std::abs(scale);
    if (!std::isfinite(size) || size == 0) continue;
    sum += std::log(size);
    ++count;
  }
  return count == 0 ? 0 : std::exp(sum / Real(count));
}

// Without hits, where f_L is not known, the path stands for the work.
void add_figures(ComparedCell& cell, const Record& record) {
  const Summary& summary = record.summary;
  const Curve& curve = record.curve;
  // Not-a-number is no better than infinite.
  const auto known = [](Real value) { return std::isnan(value) ? kNever : value; };
  cell.figures.assign(kFigures, std::nan(""));
  cell.scale = record.scale.value_or(summary.start_loss);
  cell.figures[kLoss] = known(summary.loss);
  cell.figures[kBestLoss] = known(summary.best_loss);
  cell.figures[kPath] = mean_of_path(curve.loss, cell.scale);
  if (!std::isnan(summary.start_x_error)) {
    cell.x_scale = record.x_scale.value_or(summary.start_x_error);
    cell.figures[kXError] = known(summary.x_error);
    for (std::size_t t = 0; record.x_scale && t < kTolerances.size(); ++t) {
      const Real goal = x_goal(kTolerances[t].tau, *record.x_scale, record.x_floor);
      const auto met = std::ranges::find_if(
          curve.x_error, [&](Real error) { return std::isfinite(error) && error <= goal; });
      cell.figures[kWorkToX + t] =
          met == curve.x_error.end()
              ? kNever
              : Real(curve.work[static_cast<std::size_t>(met - curve.x_error.begin())]);
    }
  }
  const auto misses = [](const auto& verdicts) {
    return std::ranges::count_if(verdicts, [](const auto& one) { return one.second == false; });
  };
  if (!record.verified.empty())
    cell.figures[kUnverified] = Real(misses(record.verified) + misses(record.found));
  for (std::size_t j = 0; record.hits && j < std::min(kTargets, record.hits->target.size()); ++j)
    cell.figures[kWork + j] = record.hits->iteration[j] < 0 ? kNever : Real(record.hits->work[j]);
}

// The path apart from the rest, so that each is called by its name.
void add_digests(ComparedCell& cell, const Record& record) {
  Json json = result_of(to_json(record));
  for (const char* known : {"build", "build_parts", "cell", "schema"}) json.erase(known);
  Json path = Json::object();
  for (const char* name : {"curve", "trajectory", "series", "exhibit", "hits"})
    if (json.contains(name)) {
      path[name] = std::move(json[name]);
      json.erase(name);
    }
  cell.trace = digest(json_text(path));
  for (const auto& [name, value] : json.items())
    cell.members.emplace_back(*shared_value(name, name), fnv1a(json_text(value)));
  cell.rest = digest(json_text(json));
}

ComparedCell cell_of(const Record& record) {
  const Request& request = record.request;
  ComparedCell cell{.key = record.cell,
                    .title = "",
                    .problem = shared_component(request.problem),
                    .optimizer = shared_component(request.optimizer),
                    .seed = request.seed,
                    .terms = fmt::format("budget {}, threads {}",
                                         json_text(to_json(request).at("budget")), request.threads),
                    .status = record.status,
                    .build = record.build,
                    .parts = shared_parts(record.build_parts),
                    .criterion = criterion_of(record),
                    .privileges = record.privileges};
  cell.title = title_of(cell);
  cell.is_cut = record.is_nondeterministic || record.status == Status::timeout ||
                record.status == Status::interrupted;
  cell.processor = record.provenance.build->processor;
  if (const std::string key = cell_digest(request); key != record.cell)
    cell.doubt = fmt::format("its cell is not the digest of its request, {}", key);
  else if (const auto broken = broken_invariants(record); !broken.empty())
    cell.doubt = broken.front();
  if (record.status == Status::inapplicable) return cell;
  for (const Real seconds : record.repeat_wall_seconds)
    if (std::isfinite(seconds) && seconds > 0)
      cell.seconds.push_back(seconds);
    else
      ++cell.senseless_times;
  add_digests(cell, record);
  add_figures(cell, record);
  return cell;
}

}  // namespace

std::string figure_name(std::size_t figure) {
  const auto* kind = std::ranges::find_if(
      kFigureKinds, [&](const FigureKind& one) { return figure < one.first + one.count; });
  if (kind->count == 1) return kind->name;
  const std::size_t i = figure - kind->first;
  return kind->name + reports::figure(rung(kind->first == kWork ? i : kTolerances[i].rung));
}

std::string title_of(const ComparedCell& cell) {
  return fmt::format("{} × {}, seed {}", shown_spec(cell.problem->spec),
                     shown_spec(cell.optimizer->spec), cell.seed);
}

Json component_json(const Component& component) {
  Json json = {
      {"name", component.name}, {"spec", component.spec}, {"options", to_json(component.options)}};
  if (component.asked != component.spec && !component.asked.empty())
    json["asked"] = component.asked;
  return json;
}

std::shared_ptr<const Component> shared_component(const Component& component) {
  Component kept;  // without the digests of its sources
  kept.name = component.name;
  kept.options = component.options;
  kept.spec = component.spec;
  kept.asked = component.asked.empty() ? component.spec : component.asked;
  return shared_value(json_text(component_json(kept)), kept);
}

std::shared_ptr<const BuildParts> shared_parts(const BuildParts& parts) {
  return shared_value(json_text(Json(parts)), parts);
}

std::vector<ComparedCell> compared_cells(const Study& study) {
  std::vector<ComparedCell> all(study.runs.size());
  share(all.size(), [&](std::size_t i) {
    all[i] = cell_of(study.runs[i]);
    if (study.disputed.contains(all[i].key)) all[i].doubt = kDisputed;
  });
  return all;
}

FolderCells read_cells(const std::string& folder, const Listener& listener) {
  std::error_code unknown;
  require(std::filesystem::is_directory(folder, unknown),
          [&] { return folder + ": no such result folder"; });
  std::vector<Unreadable> unlisted;
  const std::vector<std::string> files = record_files({folder}, unlisted);
  std::vector<RunMark> marks(files.size());  // without a cell where a file could not be read
  std::vector<ComparedCell> cells(files.size());
  const auto read = [&](std::size_t i) {
    try {
      const Record record = read_unchecked_record(files[i]);
      cells[i] = cell_of(record);
      marks[i] = mark_of(record);
    } catch (const std::exception&) {
      marks[i].cell.clear();
    }
  };
  share(files.size(), read, listener);
  const Newest newest = newest_of(marks, [&](std::size_t i, std::size_t j) {
    return are_at_odds(read_unchecked_record(files[i]), read_unchecked_record(files[j]));
  });
  const auto lost = std::ranges::count(marks, "", &RunMark::cell);
  FolderCells found{.cells = {},
                    .unreadable = unlisted.size() + static_cast<std::size_t>(lost),
                    .superseded = newest.superseded};
  for (const std::size_t k : newest.kept) {
    if (newest.disputed.contains(marks[k].cell)) cells[k].doubt = kDisputed;
    found.cells.push_back(std::move(cells[k]));
  }
  return found;
}

}  // namespace isoline::reports
