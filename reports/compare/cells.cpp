// Turns records into cells of a comparison, each as it is read.
#include "reports/compare/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/status.h"
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

// The values of the first kept point at which a column is at most the goal.
Real work_until(const Curve& curve, const std::vector<Real>& column, Real goal) {
  for (std::size_t i = 0; i < column.size(); ++i)
    if (std::isfinite(column[i]) && column[i] <= goal) return Real(curve.work[i]);
  return kNever;
}

// The geometric mean over kept points of what lies above the smallest that counts: one point that
// differs moves it. Rounding of 1e-16 of the problem's scale moves it by up to 1e-10.
ComparedFigure mean_of_path(const std::vector<Real>& losses, Real scale) {
  Real sum = 0;
  std::size_t count = 0;
  for (const Real loss : losses) {
    const Real size = std::abs(loss) + kSmallestShare * std::abs(scale);
    if (!std::isfinite(size) || size == 0) continue;
    sum += std::log(size);
    ++count;
  }
  const Real mean = count == 0 ? 0 : std::exp(sum / Real(count));
  return {.quantity = Quantity::path, .value = mean, .scale = mean / kSmallestShare};
}

// Without hits, where f_L is not known, the path stands for the work.
std::vector<ComparedFigure> figures_of(const Record& record) {
  const Summary& summary = record.summary;
  const Real scale = record.scale.value_or(summary.start_loss);
  std::vector<ComparedFigure> all = {
      {.quantity = Quantity::loss, .value = summary.loss, .scale = scale},
      {.quantity = Quantity::best_loss, .value = summary.best_loss, .scale = scale},
      mean_of_path(record.curve.loss, scale)};
  if (!std::isnan(summary.start_x_error))
    all.push_back({.quantity = Quantity::x_error,
                   .value = summary.x_error,
                   .scale = record.x_scale.value_or(summary.start_x_error)});
  if (!std::isnan(summary.start_x_error) && record.x_scale)
    for (const auto& [name, tau, rung] : kTolerances)
      all.push_back({.quantity = Quantity::work_to_x,
                     .rung = rung,
                     .value = work_until(record.curve, record.curve.x_error,
                                         x_goal(tau, *record.x_scale, record.x_floor))});
  const auto misses = [](const auto& verdicts) {
    return std::ranges::count_if(verdicts, [](const auto& one) { return one.second == false; });
  };
  if (!record.verified.empty())
    all.push_back({.quantity = Quantity::unverified,
                   .value = Real(misses(record.verified) + misses(record.found))});
  for (std::size_t j = 0; record.hits && j < record.hits->target.size(); ++j)
    all.push_back({.quantity = Quantity::work,
                   .rung = j,
                   .value = record.hits->iteration[j] < 0 ? kNever : Real(record.hits->work[j])});
  all.shrink_to_fit();
  return all;
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

Given given(const Component& component) {
  return {.name = component.name,
          .asked = component.asked.empty() ? component.spec : component.asked,
          .spec = component.spec,
          .options = shared_options(component.options)};
}

void add_seconds(ComparedCell& cell, const std::vector<Real>& seconds) {
  for (const Real value : seconds)
    if (std::isfinite(value) && value > 0)
      cell.seconds.push_back(value);
    else
      ++cell.senseless_times;
}

ComparedCell cell_of(const Record& record) {
  const Request& request = record.request;
  ComparedCell cell{.key = record.cell,
                    .title = "",
                    .problem = given(request.problem),
                    .optimizer = given(request.optimizer),
                    .seed = request.seed,
                    .terms = fmt::format("budget {}, threads {}",
                                         json_text(to_json(request).at("budget")), request.threads),
                    .status = record.status,
                    .build = record.build,
                    .parts = shared_parts(record.build_parts),
                    .aim = record.aim,
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
  add_seconds(cell, record.repeat_wall_seconds);
  add_digests(cell, record);
  cell.figures = figures_of(record);
  return cell;
}

}  // namespace

std::string figure_name(const ComparedFigure& each) {
  switch (each.quantity) {
    case Quantity::loss:
      return "loss";
    case Quantity::best_loss:
      return "best loss";
    case Quantity::x_error:
      return "error in x";
    case Quantity::path:
      return "mean loss of the path";
    case Quantity::unverified:
      return "targets missed by the last point";
    case Quantity::work:
      return "work to " + figure(rung(each.rung));
    case Quantity::work_to_x:
      return "work to an error in x of " + figure(rung(each.rung));
  }
  return "";
}

// Two that are equally bad may still differ: that is a change, and no verdict.
int badness_of(Status status) {
  if (status == Status::target || status == Status::converged) return 0;
  if (status == Status::budget || status == Status::stalled) return 1;
  return status == Status::diverged ? 2 : 3;
}

bool is_lost(const ComparedCell& cell) {
  return is_failure(cell.status) || cell.status == Status::inapplicable;
}

Status status_named(const std::string& name) {
  const std::optional<Status> status = status_of(name);
  require(status.has_value(), [&] { return fmt::format("unknown status '{}'", name); });
  return *status;
}

std::string title_of(const ComparedCell& cell) {
  return fmt::format("{} × {}, seed {}", shown_spec(cell.problem.spec),
                     shown_spec(cell.optimizer.spec), cell.seed);
}

std::shared_ptr<const OptionValues> shared_options(const OptionValues& options) {
  return shared_value(json_text(to_json(options)), options);
}

std::shared_ptr<const BuildParts> shared_parts(const BuildParts& parts) {
  return shared_value(json_text(Json(parts)), parts);
}

Real work_to(const ComparedCell& cell, Aim aim, std::size_t rung) {
  const Quantity wanted = aim == Aim::x ? Quantity::work_to_x : Quantity::work;
  for (const ComparedFigure& each : cell.figures)
    if (each.quantity == wanted && each.rung == rung) return each.value;
  return kNever;
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
