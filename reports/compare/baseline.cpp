// Writes and reads what a gate remembers of a study. What many cells share stands in tables at the
// top, and a cell names its rows.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "reports/compare/gate.h"

namespace isoline::reports {
namespace {

// Rows once each, in the order of their first use.
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

// Works to the tolerances stand for those to all targets.
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

// With the targets that the file keeps, so that a cell moves by what a comparison will look at.
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

std::vector<ComparedCell> baseline_from_json(const Json& json) {
  try {
    require(json.at("schema") == kBaselineSchema,
            [&] { return fmt::format("the schema is not {}", kBaselineSchema); });
    std::vector<ComparedCell> cells;
    for (const Json& cell : json.at("cells")) cells.push_back(cell_from_json(cell, json));
    return cells;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("not a valid {}: {}", kBaselineSchema, error.what()));
  }
}

}  // namespace isoline::reports
