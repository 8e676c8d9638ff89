// Turns records into cells of a comparison while they are read, and writes and reads baselines,
// whose cells refer to rows of shared tables.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <unordered_map>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/seeds.h"
#include "core/status.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr const char* kDisputed = "two records of this cell and build differ";

// Equal values share one object, which exists until the program ends.
template <class Value>
std::shared_ptr<const Value> shared_value(const std::string& key, const Value& value) {
  static std::mutex mutex;
  static std::unordered_map<std::string, std::shared_ptr<const Value>> pool;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const Value>& kept = pool[key];
  if (!kept) kept = std::make_shared<const Value>(value);
  return kept;
}

std::string title_of(const ComparedCell& cell) {
  return fmt::format("{} × {}, seed {}", shown_spec(cell.problem->spec),
                     shown_spec(cell.optimizer->spec), seed_text(cell.seed));
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

// The geometric mean of the stored losses above the smallest that counts. A difference in one point
// changes it. Rounding by 1e-16 of the problem's scale changes it by at most 1e-10.
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

// Without f_L, targets are not defined, and the path is compared instead of the work.
void add_figures(ComparedCell& cell, const Record& record) {
  const Summary& summary = record.summary;
  const Curve& curve = record.curve;
  // NaN counts as infinite.
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
  const auto states = [](const auto& verdicts) {
    return std::ranges::count_if(verdicts, [](const auto& one) { return one.second.has_value(); });
  };
  cell.verdicts = static_cast<std::size_t>(states(record.verified) + states(record.found));
  if (!record.verified.empty())
    cell.figures[kUnverified] = Real(misses(record.verified) + misses(record.found));
  for (std::size_t j = 0; record.hits && j < std::min(kTargets, record.hits->target.size()); ++j)
    cell.figures[kWork + j] = record.hits->iteration[j] < 0 ? kNever : Real(record.hits->work[j]);
}

// The path is compared apart, to state which values differ. What follows from it is not.
void add_digests(ComparedCell& cell, const Record& record) {
  static const std::set<std::string> left_out = [] {
    std::set<std::string> paths = paths_beside_results();
    paths.insert({"build", "build_parts", "cell", "schema"});
    paths.erase("failures/reasons");  // which are compared beside the rest
    return paths;
  }();
  std::map<std::string, std::string> all = member_texts(record, left_out);
  const auto taken = [&](std::initializer_list<const char*> names) {
    std::map<std::string, std::string> part;
    for (const char* name : names) part.insert(all.extract(name));
    return part;
  };
  const auto digest_of = [](const std::map<std::string, std::string>& members) {
    return digest(fmt::format("{{{}}}", fmt::join(std::views::values(members), ",")));
  };
  std::map<std::string, std::string> beside = taken({"answer", "failures"});
  cell.trace = digest_of(taken({"curve", "trajectory", "series", "exhibit", "hits"}));
  cell.rest = digest_of(all);
  all.merge(beside);
  const Json more = members_beside_results(record);
  for (const auto& [name, value] : more.items())
    all[name] = json_text(name) + ":" + json_text(value);
  for (const auto& [name, text] : all)
    cell.members.emplace_back(*shared_value(name, name),
                              fnv1a(std::string_view(text).substr(text.find(':') + 1)));
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
  if (record.answer && !record.answer->x.empty()) cell.x = record.answer->x.back();
  add_digests(cell, record);
  add_figures(cell, record);
  return cell;
}

// Why the files of numbers beside a record are not its own; empty where they are.
std::string damaged_numbers(const Record& record, const std::string& file) {
  try {
    if (record.fields) {
      FieldFrames frames = *record.fields;
      read_field_numbers(frames, field_path(file));
    }
    if (record.answer) {
      AnswerPoints answer = *record.answer;
      read_answer_numbers(answer, answer_path(file));
    }
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

std::string figure_name(std::size_t figure) {
  const auto* kind = std::ranges::find_if(
      kFigureKinds, [&](const FigureKind& one) { return figure < one.first + one.count; });
  if (kind->count == 1) return kind->name;
  const std::size_t i = figure - kind->first;
  return kind->name + reports::figure(rung(kind->first == kWork ? i : kTolerances[i].rung));
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
  FolderCells found;
  const std::vector<std::string> files = record_files({folder}, found.unreadable);
  std::vector<RunMark> marks(files.size());  // without a cell where a file could not be read
  std::vector<std::string> reasons(files.size());
  std::vector<ComparedCell> cells(files.size());
  const auto read = [&](std::size_t i) {
    try {
      const Record record = read_unchecked_record(files[i]);
      cells[i] = cell_of(record);
      cells[i].file = files[i];
      if (cells[i].doubt.empty()) cells[i].doubt = damaged_numbers(record, files[i]);
      marks[i] = mark_of(record);
    } catch (const std::exception& error) {
      marks[i].cell.clear();
      reasons[i] = reason_without(files[i], error);
    }
  };
  share(files.size(), read, listener);
  const Newest newest = newest_of(marks, [&](std::size_t i, std::size_t j) {
    return are_at_odds(read_unchecked_record(files[i]), read_unchecked_record(files[j]));
  });
  for (std::size_t i = 0; i < files.size(); ++i)
    if (marks[i].cell.empty()) found.unreadable.push_back({files[i], std::move(reasons[i])});
  found.superseded = newest.superseded;
  for (const std::size_t k : newest.kept) {
    if (newest.disputed.contains(marks[k].cell)) cells[k].doubt = kDisputed;
    found.cells.push_back(std::move(cells[k]));
  }
  return found;
}

// --- baselines
namespace {

// Distinct rows, in the order of their first use.
class Rows {
 public:
  std::size_t place(const Json& row) {
    const auto [at, is_new] = places_.emplace(json_text(row), texts_.size());
    if (is_new) texts_.push_back(at->first);
    return at->second;
  }
  std::string text() const { return fmt::format("[\n{}]", fmt::join(texts_, ",\n")); }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<std::string> texts_;
};
using Tables = std::map<std::string, Rows>;  // "given", "terms", "parts", "criteria"

// Members of a criterion that may be unknown.
constexpr std::pair<const char*, std::optional<Real> Criterion::*> kKnown[] = {
    {"minimum", &Criterion::minimum},
    {"scale", &Criterion::scale},
    {"x_scale", &Criterion::x_scale}};

Json criterion_json(const Criterion& of) {
  Json json = {
      {"x_floor", json_number(of.x_floor)}, {"aim", name_of(of.aim)}, {"prices", of.prices}};
  for (const auto& [name, value] : kKnown)
    if (of.*value) json[name] = json_number(*(of.*value));
  return json;
}

Criterion criterion_from_json(const Json& json) {
  Criterion of{.x_floor = real_of(json.at("x_floor")),
               .aim = aim_of(json.at("aim").get<std::string>()).value_or(Aim::loss)};
  for (const auto& [name, value] : kKnown)
    if (json.contains(name)) of.*value = real_of(json.at(name));
  const auto prices = json.at("prices").get<std::vector<std::int64_t>>();
  std::copy_n(prices.begin(), std::min(prices.size(), kOracles), of.prices.begin());
  return of;
}

Status status_named(const std::string& name) {
  const std::optional<Status> status = status_of(name);
  require(status.has_value(), [&] { return fmt::format("unknown status '{}'", name); });
  return *status;
}

// The work to three tolerances represents the work to all targets.
std::vector<std::size_t> kept_figures(const FigureKind& kind) {
  std::vector<std::size_t> kept;
  for (std::size_t t = 0; t < std::min(kind.count, kTolerances.size()); ++t)
    kept.push_back(kind.first == kWork ? work_at(Aim::loss, t) : kind.first + t);
  return kept;
}

void add_figures(Json& json, const ComparedCell& cell) {
  for (const FigureKind& kind : kFigureKinds)
    for (const std::size_t figure : kept_figures(kind)) {
      if (!cell.has(figure)) continue;
      const Json value = json_number(cell.figures[figure]);
      if (kind.count == 1)
        json[kind.key] = value;
      else
        json[kind.key].push_back(value);
    }
  if (cell.has(kLoss)) json["scale"] = json_number(cell.scale);
  if (cell.has(kXError)) json["x_scale"] = json_number(cell.x_scale);
}

void read_figures(ComparedCell& cell, const Json& json) {
  cell.figures.assign(kFigures, std::nan(""));
  cell.scale = real_of(json.at("scale"));
  if (json.contains("x_scale")) cell.x_scale = real_of(json.at("x_scale"));
  for (const FigureKind& kind : kFigureKinds) {
    if (!json.contains(kind.key)) continue;
    const Json& value = json.at(kind.key);
    std::size_t place = 0;
    for (const std::size_t figure : kept_figures(kind))
      cell.figures[figure] = real_of(kind.count == 1 ? value : value.at(place++));
  }
}

// Uses the targets that the file stores, which are those that a comparison uses.
Json perturbed_json(ComparedCell cell, const std::vector<ComparedCell>& others) {
  std::vector<Real> kept(kFigures, std::nan(""));
  for (const FigureKind& kind : kFigureKinds)
    for (const std::size_t figure : kept_figures(kind))
      if (cell.has(figure)) kept[figure] = cell.figures[figure];
  cell.figures = std::move(kept);
  const Perturbed perturbed = perturbed_of(cell, others);
  if (perturbed.moved == 0) return nullptr;
  const Real moved = std::isfinite(perturbed.moved)
                         ? std::stod(fmt::format("{:.2e}", perturbed.moved))  // a measured size
                         : perturbed.moved;
  Json json = {{"moved", json_number(moved)}, {"reached", perturbed.reached}};
  for (const Status status : perturbed.statuses) json["statuses"].push_back(name_of(status));
  return json;
}

Perturbed perturbed_from_json(const Json& json) {
  Perturbed perturbed{.moved = real_of(json.at("moved"))};
  json.at("reached").get_to(perturbed.reached);
  for (const Json& status : json.at("statuses"))
    perturbed.statuses.push_back(status_named(status.get<std::string>()));
  return perturbed;
}

Json cell_json(const ComparedCell& cell, const std::vector<ComparedCell>& others, Tables& tables) {
  Json json = {{"cell", cell.key},
               {"given",
                {tables["given"].place(component_json(*cell.problem)),
                 tables["given"].place(component_json(*cell.optimizer))}},
               {"seed", cell.seed},
               {"terms", tables["terms"].place(cell.terms)},
               {"status", name_of(cell.status)},
               {"build", cell.build}};
  for (const auto& [name, digest] : *cell.parts)
    json["parts"].push_back(tables["parts"].place(Json{name, digest}));
  json["criterion"] = tables["criteria"].place(criterion_json(cell.criterion));
  if (!cell.privileges.empty()) json["privileges"] = cell.privileges;
  if (cell.is_cut) json["nondeterministic"] = true;
  if (!cell.trace.empty()) json["trace"] = cell.trace;
  if (!cell.rest.empty()) json["rest"] = cell.rest;
  add_figures(json, cell);
  if (Json perturbed = perturbed_json(cell, others); !perturbed.is_null())
    json["perturbed"] = std::move(perturbed);
  return json;
}

std::shared_ptr<const Component> component_from_json(const Json& json) {
  Component component;
  json.at("name").get_to(component.name);
  json.at("spec").get_to(component.spec);
  component.asked = json.value("asked", component.spec);
  component.options = option_values_from(json.at("options"));
  return shared_component(component);
}

ComparedCell cell_from_json(const Json& json, const Json& file) {
  const auto row = [&](const char* table, const Json& place) -> const Json& {
    return file.at(table).at(place.get<std::size_t>());
  };
  ComparedCell cell{.key = json.at("cell").get<std::string>(),
                    .title = "",
                    .problem = component_from_json(row("given", json.at("given").at(0))),
                    .optimizer = component_from_json(row("given", json.at("given").at(1))),
                    .seed = json.at("seed").get<std::uint64_t>(),
                    .terms = row("terms", json.at("terms")).get<std::string>(),
                    .status = status_named(json.at("status").get<std::string>()),
                    .build = json.at("build").get<std::string>(),
                    .parts = nullptr};
  cell.title = title_of(cell);
  BuildParts parts;
  for (const Json& place : json.value("parts", Json::array())) {
    const Json& part = row("parts", place);
    parts[part.at(0).get<std::string>()] = part.at(1).get<std::string>();
  }
  cell.parts = shared_parts(parts);
  cell.criterion = criterion_from_json(row("criteria", json.at("criterion")));
  cell.privileges = json.value("privileges", std::vector<std::string>());
  cell.is_cut = json.value("nondeterministic", false);
  cell.trace = json.value("trace", std::string());
  cell.rest = json.value("rest", std::string());
  if (cell.status != Status::inapplicable) read_figures(cell, json);
  if (json.contains("perturbed")) cell.perturbed = perturbed_from_json(json.at("perturbed"));
  return cell;
}

}  // namespace

std::string baseline_json(const Study& study, const std::vector<Study>& perturbed) {
  std::map<std::string, std::vector<ComparedCell>> others;
  for (const Study& one : perturbed)
    for (ComparedCell& cell : compared_cells(one)) others[cell.key].push_back(std::move(cell));
  Tables tables;
  std::vector<std::string> lines;
  for (const ComparedCell& cell : compared_cells(study))
    lines.push_back(json_text(cell_json(cell, others[cell.key], tables)));
  std::string text = fmt::format("{{\"schema\": \"{}\",\n\"suites\": {}, \"perturbations\": {},\n",
                                 kBaselineSchema, json_text(study.plan.suites), perturbed.size());
  for (const char* table : {"given", "terms", "parts", "criteria"})
    text += fmt::format("\"{}\": {},\n", table, tables[table].text());
  return text + fmt::format("\"cells\": [\n{}\n]}}\n", fmt::join(lines, ",\n"));
}

std::vector<ComparedCell> baseline_from_json(const Json& json, const std::string& origin) {
  try {
    require(json.at("schema") == kBaselineSchema,
            [&] { return fmt::format("the schema is not {}", kBaselineSchema); });
    std::vector<ComparedCell> cells;
    for (const Json& cell : json.at("cells")) cells.push_back(cell_from_json(cell, json));
    return cells;
  } catch (const Json::exception&) {
    throw UsageError(
        fmt::format("{}: not a valid {}: a member of it, or what a cell refers to, is "
                    "missing or of another type",
                    origin, kBaselineSchema));
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", origin, error.what()));
  }
}

}  // namespace isoline::reports
