// Conversion of component metadata to and from JSON.
#include "core/records/sheet.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/json.h"
#include "core/records/fields.h"
#include "core/records/plan.h"

namespace isoline {

void fields(Like<Panel> auto& panel, auto& field) {
  field("title", panel.title);
  field("kind", panel.kind,
        R"({"enum": ["curve", "sweep", "scatter", "decades", "pictures", "series", "path"]})");
  field("where", panel.where);
  field("over", panel.over);
  field("divided_by", panel.divided_by);
  field("quantity", panel.quantity);
}

void fields(Like<Quantity> auto& quantity, auto& field) {
  field("name", quantity.name);
  field("unit", quantity.unit, R"({"description": "Empty: a pure number"})");
}

void fields(Like<Field> auto& grid, auto& field) {
  field("rows", grid.rows, R"({"minimum": 1})");
  field("columns", grid.columns, R"({"minimum": 1})");
  field("x", grid.x);
  field("y", grid.y);
  field.optional("time", grid.time, R"({"exclusiveMinimum": 0, "description":
        "Where rows are states: of the last one, which is y; the first one, x, is at 0"})");
}

void fields(Like<Landscape> auto& landscape, auto& field) {
  Index rows = landscape.loss.rows(), columns = landscape.loss.columns();
  std::vector<Real> loss = landscape.loss.values();
  field("window", landscape.window);
  field("rows", rows);
  field("columns", columns);
  field("spacing", landscape.spacing, R"({"enum": ["logarithm", "fifth root", "powers of two"]})");
  field("loss", loss);
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads) {
    const auto size = static_cast<Index>(loss.size());
    const bool is_whole = columns > 0 ? size % columns == 0 && size / columns == rows : size == 0;
    require(rows >= 0 && columns >= 0 && is_whole, "a landscape has the wrong size");
    landscape.loss = Grid(rows, columns, std::move(loss));
  }
}

void fields(Like<MeasuredPrice> auto& price, auto& field) {
  constexpr const char* kPositive = R"({"minimum": 1})";
  constexpr const char* kNotNegative = R"({"type": "number", "minimum": 0})";
  field("oracle", price.oracle);
  field("declared", price.declared, R"({"minimum": 0})");
  field("price", price.price, kNotNegative);
  field("low", price.low, kNotNegative);
  field("high", price.high, kNotNegative);
  field("rounds", price.rounds, kPositive);
  field("calls", price.calls, kPositive);
  field.forgiven("resolved", price.resolved);
}

void fields(Like<MeasuredPrices> auto& prices, auto& field) {
  field("build", prices.build);
  field("processor", prices.processor);
  field("forward_seconds", prices.forward_seconds, R"({"type": "number", "exclusiveMinimum": 0})");
  field("oracles", prices.oracles);
}

void fields(Like<Sheet> auto& sheet, auto& field) {
  field.constant("schema", kSheetSchema);
  field("kind", sheet.kind, R"({"enum": ["problem", "optimizer"]})");
  field("name", sheet.name);
  field("spec", sheet.spec);
  field("title", sheet.title);
  field("formula", sheet.formula);
  field("source", sheet.source);
  field("note", sheet.note);
  field("options", JsonAsText{sheet.options_text}, R"({"type": "array", "items":
        {"type": "object", "required": ["name", "type", "default", "doc"]}})");
  field("oracles", sheet.oracles);
  field("privileges", sheet.privileges);
  field("family", sheet.family);
  field.optional("mathematics", sheet.mathematics);
  field.optional("group", sheet.group);
  field.optional("tunable", sheet.tunable);
  field("inverse", sheet.inverse);
  field("unknowns", sheet.unknowns);
  field("residuals", sheet.residuals);
  field.optional("aim", sheet.aim);
  field.optional("start_condition", sheet.start_condition);
  field.optional("condition", sheet.condition);
  field("target", sheet.target);
  field("truth", sheet.truth);
  field.optional("field", sheet.field);
  field.optional("panels", sheet.panels);
  field.optional("landscape_x", sheet.landscape_x);
  field.optional("landscape_y", sheet.landscape_y);
  field.optional("prices", sheet.prices);
}

std::string Sheet::file_name() const {
  return fmt::format("{}-{}-{}.json", kind, name, digest(spec));
}

Json to_json(const Sheet& sheet) {
  Json json;
  Form<Sheet>::write(sheet, JsonPlace(json));
  return json;
}

std::string file_text(const Sheet& sheet) { return json_text(to_json(sheet)) + "\n"; }

Sheet sheet_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    Sheet sheet;
    Form<Sheet>::read(json, sheet);
    return sheet;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("not a valid {} file: {}", kSheetSchema, error.what()));
  }
}

Sheet sheet_from_json(const Json& json) { return sheet_from_text(json_text(json), "it"); }

Json sheet_schema() {
  Json schema;
  Form<Sheet>::law(JsonPlace(schema));
  complete_schema(JsonPlace(schema), "isoline.component/1: metadata of a problem or an optimizer");
  return schema;
}

}  // namespace isoline
