// Writes and reads what a gate remembers of a study. What many cells share stands in tables at the
// top, and a cell names its rows.
#include "reports/compare/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "reports/compare/differences.h"

namespace isoline::reports {
namespace {

// Figures with one value, by their key; those of three tolerances have two more keys.
constexpr std::pair<const char*, Quantity> kSingle[] = {{"loss", Quantity::loss},
                                                        {"best_loss", Quantity::best_loss},
                                                        {"path", Quantity::path},
                                                        {"x_error", Quantity::x_error},
                                                        {"unverified", Quantity::unverified}};
constexpr std::pair<const char*, Quantity> kByTolerance[] = {{"work", Quantity::work},
                                                             {"found", Quantity::work_to_x}};

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

struct Tables {
  Rows given, terms, parts, criteria;
};

Json given_json(const Given& given) {
  Json json = {{"name", given.name}, {"spec", given.spec}, {"options", to_json(*given.options)}};
  if (given.asked != given.spec) json["asked"] = given.asked;
  return json;
}

Json criterion_json(const Criterion& of) {
  Json json = {
      {"x_floor", json_number(of.x_floor)}, {"aim", name_of(of.aim)}, {"prices", of.prices}};
  for (const auto& [name, value] :
       {std::pair("minimum", &of.minimum), {"scale", &of.scale}, {"x_scale", &of.x_scale}})
    if (*value) json[name] = json_number(**value);
  return json;
}

Criterion criterion_from_json(const Json& json) {
  Criterion of{.x_floor = real_of(json.at("x_floor")),
               .aim = aim_of(json.at("aim").get<std::string>()).value_or(Aim::loss)};
  for (const auto& [name, value] :
       {std::pair("minimum", &of.minimum), {"scale", &of.scale}, {"x_scale", &of.x_scale}})
    if (json.contains(name)) *value = real_of(json.at(name));
  const auto prices = json.at("prices").get<std::vector<std::int64_t>>();
  std::copy_n(prices.begin(), std::min(prices.size(), kOracles), of.prices.begin());
  return of;
}

bool is_kept(const ComparedFigure& each) {
  return each.quantity != Quantity::work ||
         std::ranges::find(kTolerances, each.rung, &Tolerance::rung) != kTolerances.end();
}

void add_figures(Json& json, const ComparedCell& cell) {
  for (const ComparedFigure& each : cell.figures) {
    for (const auto& [key, quantity] : kSingle)
      if (each.quantity == quantity) json[key] = json_number(each.value);
    for (const auto& [key, quantity] : kByTolerance)
      if (each.quantity == quantity && is_kept(each)) json[key].push_back(json_number(each.value));
    if (each.quantity == Quantity::loss) json["scale"] = json_number(each.scale);
    if (each.quantity == Quantity::x_error) json["x_scale"] = json_number(each.scale);
  }
}

// With the targets that the file keeps, so that a cell moves by what a comparison will look at.
Json perturbed_json(ComparedCell cell, const std::vector<ComparedCell>& others) {
  std::erase_if(cell.figures, [](const ComparedFigure& each) { return !is_kept(each); });
  const Perturbed perturbed = perturbed_of(cell, others);
  if (perturbed.moved == 0) return nullptr;
  const Real moved = std::isfinite(perturbed.moved)
                         ? std::stod(fmt::format("{:.2e}", perturbed.moved))  // a measured size
                         : perturbed.moved;
  Json json = {{"moved", json_number(moved)}, {"reached", perturbed.reached}};
  for (const Status status : perturbed.statuses) json["statuses"].push_back(name_of(status));
  return json;
}

Json cell_json(const ComparedCell& cell, const std::vector<ComparedCell>& others, Tables& tables) {
  Json json = {{"cell", cell.key},
               {"given",
                {tables.given.place(given_json(cell.problem)),
                 tables.given.place(given_json(cell.optimizer))}},
               {"seed", cell.seed},
               {"terms", tables.terms.place(cell.terms)},
               {"status", name_of(cell.status)},
               {"build", cell.build}};
  for (const auto& [name, digest] : *cell.parts)
    json["parts"].push_back(tables.parts.place(Json{name, digest}));
  json["criterion"] = tables.criteria.place(criterion_json(*cell.criterion));
  if (!cell.privileges.empty()) json["privileges"] = cell.privileges;
  if (cell.is_cut) json["nondeterministic"] = true;
  if (!cell.trace.empty()) json["trace"] = cell.trace;
  if (!cell.rest.empty()) json["rest"] = cell.rest;
  add_figures(json, cell);
  if (Json perturbed = perturbed_json(cell, others); !perturbed.is_null())
    json["perturbed"] = std::move(perturbed);
  return json;
}

Given given_from_json(const Json& json) {
  const auto spec = json.at("spec").get<std::string>();
  return {.name = json.at("name").get<std::string>(),
          .asked = json.value("asked", spec),
          .spec = spec,
          .options = shared_options(option_values_from(json.at("options")))};
}

void read_figures(ComparedCell& cell, const Json& json) {
  const Real scale = real_of(json.at("scale"));
  for (const auto& [key, quantity] : kSingle) {
    if (!json.contains(key)) continue;
    const Real value = real_of(json.at(key));
    cell.figures.push_back({.quantity = quantity,
                            .value = value,
                            .scale = quantity == Quantity::path      ? value / kSmallestShare
                                     : quantity == Quantity::x_error ? real_of(json.at("x_scale"))
                                                                     : scale});
  }
  for (const auto& [key, quantity] : kByTolerance)
    for (std::size_t t = 0; json.contains(key) && t < kTolerances.size(); ++t)
      cell.figures.push_back({.quantity = quantity,
                              .rung = kTolerances[t].rung,
                              .value = real_of(json.at(key).at(t))});
}

Perturbed perturbed_from_json(const Json& json) {
  Perturbed perturbed{.moved = real_of(json.at("moved"))};
  json.at("reached").get_to(perturbed.reached);
  for (const Json& status : json.at("statuses"))
    perturbed.statuses.push_back(status_named(status.get<std::string>()));
  return perturbed;
}

ComparedCell cell_from_json(const Json& json, const Json& file) {
  const auto row = [&](const char* table, const Json& place) -> const Json& {
    return file.at(table).at(place.get<std::size_t>());
  };
  ComparedCell cell{.key = json.at("cell").get<std::string>(),
                    .title = "",
                    .problem = given_from_json(row("given", json.at("given").at(0))),
                    .optimizer = given_from_json(row("given", json.at("given").at(1))),
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
  cell.aim = aim_of(json.value("aim", std::string("loss"))).value_or(Aim::loss);  // older files
  if (json.contains("criterion")) {
    cell.criterion = criterion_from_json(row("criteria", json.at("criterion")));
    cell.aim = cell.criterion->aim;
    cell.privileges = json.value("privileges", std::vector<std::string>());
  }
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
  return fmt::format(
      "{{\"schema\": \"{}\",\n\"suites\": {}, \"perturbations\": {},\n\"given\": {},\n"
      "\"terms\": {},\n\"parts\": {},\n\"criteria\": {},\n\"cells\": [\n{}\n]}}\n",
      kBaselineSchema, json_text(Json(study.plan.suites)), perturbed.size(), tables.given.text(),
      tables.terms.text(), tables.parts.text(), tables.criteria.text(), fmt::join(lines, ",\n"));
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
