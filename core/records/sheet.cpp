// Sheets and plans to JSON and back.
#include "core/records/sheet.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"

namespace isoline {
namespace {

constexpr const char* kSheetSchema = "isoline.component/1";
constexpr const char* kPlanSchema = "isoline.plan/1";

Json numbers(const std::vector<Real>& values) { return json_numbers(values.data(), values.size()); }

std::vector<Real> reals(const Json& list) {
  std::vector<Real> values;
  for (const Json& value : list) values.push_back(real_of(value));
  return values;
}

Json to_json(const Landscape& landscape) {
  const auto size = static_cast<std::size_t>(landscape.loss.size());
  return {{"window", landscape.window},
          {"rows", landscape.loss.rows()},
          {"columns", landscape.loss.cols()},
          {"spacing", landscape.spacing},
          {"loss", json_numbers(landscape.loss.data(), size)}};  // column major
}

Landscape landscape_from(const Json& json) {
  const std::vector<Real> values = reals(json.at("loss"));
  const Index rows = json.at("rows"), columns = json.at("columns");
  require(static_cast<Index>(values.size()) == rows * columns, "a landscape has the wrong size");
  return {json.at("window"), Eigen::Map<const Matrix>(values.data(), rows, columns),
          json.at("spacing")};
}

Json to_json(const MeasuredPrices& prices) {
  Json oracles = Json::array();
  for (const MeasuredPrice& each : prices.oracles)
    oracles.push_back({{"oracle", each.oracle},
                       {"declared", each.declared},
                       {"price", each.price},
                       {"low", each.low},
                       {"high", each.high},
                       {"rounds", each.rounds},
                       {"calls", each.calls}});
  return {{"build", prices.build},
          {"processor", prices.processor},
          {"forward_seconds", prices.forward_seconds},
          {"oracles", oracles}};
}

MeasuredPrices prices_from(const Json& json) {
  MeasuredPrices prices{.build = json.at("build"),
                        .processor = json.at("processor"),
                        .forward_seconds = json.at("forward_seconds"),
                        .oracles = {}};
  for (const Json& each : json.at("oracles"))
    prices.oracles.push_back({each.at("oracle"), each.at("declared"), each.at("price"),
                              each.at("low"), each.at("high"), each.at("rounds"),
                              each.at("calls")});
  return prices;
}

}  // namespace

std::string Sheet::file_name() const {
  return fmt::format("{}-{}-{}.json", kind, name, digest(spec));
}

Json to_json(const Sheet& sheet) {
  Json json{{"schema", kSheetSchema},
            {"kind", sheet.kind},
            {"name", sheet.name},
            {"spec", sheet.spec},
            {"title", sheet.title},
            {"formula", sheet.formula},
            {"source", sheet.source},
            {"note", sheet.note},
            {"options", Json::parse(sheet.options_text)},
            {"oracles", sheet.oracles},
            {"privileges", sheet.privileges},
            {"family", sheet.family},
            {"inverse", sheet.inverse},
            {"unknowns", sheet.unknowns},
            {"residuals", sheet.residuals},
            {"target", numbers(sheet.target)},
            {"truth", numbers(sheet.truth)}};
  for (const Panel& panel : sheet.panels) json["panels"].push_back(to_json(panel));
  if (sheet.landscape_x) json["landscape_x"] = to_json(*sheet.landscape_x);
  if (sheet.landscape_y) json["landscape_y"] = to_json(*sheet.landscape_y);
  if (sheet.prices) json["prices"] = to_json(*sheet.prices);
  return json;
}

Sheet sheet_from_json(const Json& json) {
  try {
    require(json.at("schema") == kSheetSchema, "the schema is not isoline.component/1");
    Sheet sheet{.kind = json.at("kind"),
                .name = json.at("name"),
                .spec = json.at("spec"),
                .title = json.at("title"),
                .formula = json.at("formula"),
                .source = json.at("source"),
                .note = json.at("note"),
                .options_text = json.at("options").dump(),
                .oracles = json.at("oracles"),
                .privileges = json.at("privileges"),
                .family = json.at("family"),
                .inverse = json.at("inverse"),
                .unknowns = json.at("unknowns"),
                .residuals = json.at("residuals"),
                .target = reals(json.at("target")),
                .truth = reals(json.at("truth"))};
    for (const Json& panel : json.value("panels", Json::array()))
      sheet.panels.push_back(panel_from_json(panel));
    if (json.contains("landscape_x")) sheet.landscape_x = landscape_from(json["landscape_x"]);
    if (json.contains("landscape_y")) sheet.landscape_y = landscape_from(json["landscape_y"]);
    if (json.contains("prices")) sheet.prices = prices_from(json["prices"]);
    return sheet;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {} sheet: {}", kSheetSchema, error.what()));
  }
}

Json to_json(const Plan& plan) {
  Json cells = Json::array();
  for (const PlannedCell& cell : plan.cells)
    cells.push_back({{"cell", cell.cell},
                     {"problem", cell.problem},
                     {"optimizer", cell.optimizer},
                     {"seed", cell.seed}});
  return {{"schema", kPlanSchema}, {"suites", plan.suites}, {"cells", cells}};
}

Plan plan_from_json(const Json& json) {
  try {
    require(json.at("schema") == kPlanSchema, "the schema is not isoline.plan/1");
    Plan plan{.suites = json.at("suites"), .cells = {}};
    for (const Json& cell : json.at("cells"))
      plan.cells.push_back(
          {cell.at("cell"), cell.at("problem"), cell.at("optimizer"), cell.at("seed")});
    return plan;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {} plan: {}", kPlanSchema, error.what()));
  }
}

}  // namespace isoline
