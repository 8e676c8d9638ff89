// The members of the files of component metadata and of audits.
#include "core/records/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/fields.h"

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
  field.optional("context", grid.context);
  field.optional("time", grid.time, R"({"exclusiveMinimum": 0, "description":
        "If the rows are states: the time of the last one, which is y; that of the first one, x, is 0"})");
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
  field.constant("schema", "isoline.component/1");
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
  field.optional("linear", sheet.linear);
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
  field.optional("certified", sheet.certified,
                 R"({"description": "Build of the problem that passed its checks"})");
}

std::string Sheet::file_name() const {
  return fmt::format("{}-{}-{}.json", kind, name, digest(spec));
}

Json to_json(const Sheet& sheet) { return json_of(sheet); }
std::string file_text(const Sheet& sheet) { return file_text_of(sheet); }
Sheet sheet_from_text(const std::string& text, const std::string& origin) {
  return from_text<Sheet>(text, origin, "not a valid isoline.component/1 file");
}
Sheet sheet_from_json(const Json& json) { return sheet_from_text(json_text(json), "it"); }
Json sheet_schema() {
  return schema_of<Sheet>("isoline.component/1: metadata of a problem or an optimizer");
}

// Audits.

void fields(Like<PowerLaw> auto& law, auto& field) {
  bool holds = law.holds();
  field("values", law.values);
  field("exponent", law.exponent);
  field("residual", law.residual);
  field("holds", holds);
}

void fields(Like<ScalingLaw> auto& law, auto& field) {
  field("scales", law.scales);
  field("step", law.step);
  field("loss_change", law.loss_change);
}

void fields(Like<Approach> auto& approach, auto& field) {
  field("order", approach.order);
  field("residual", approach.residual);
  field("remaining", approach.remaining);
  field("steps", approach.steps);
  field("is_exact", approach.is_exact);
}

void fields(Like<ConductCell> auto& cell, auto& field) {
  field("column", cell.column);
  field.optional("holds", cell.holds);
  field("figures", cell.figures);
  field("records", cell.records);
}

void fields(Like<AuditedOptimizer> auto& audited, auto& field) {
  field("name", audited.name);
  field("spec", audited.spec);
  field.optional("conduct", audited.conduct);
  field("reason", audited.reason);
  if (!audited.reason.empty()) return;
  field.optional("network", audited.network);
  field.group("scalings", [&](auto& law) {
    for (std::size_t i = 0; i < kScalingNames.size(); ++i)
      law(kScalingNames[i].data(), audited.scalings[i]);
  });
  field.group("invariance", [&](auto& deviation) {
    for (std::size_t i = 0; i < kChangeNames.size(); ++i)
      deviation(kChangeNames[i].data(), audited.deviations[i]);
  });
  field.group("convergence", [&](auto& approach) {
    approach("regular", audited.regular);
    approach("singular", audited.singular);
  });
  field.group("composition", [&](auto& angle) {
    angle("linear", audited.linear_angle);
    angle("curved", audited.curved_angle);
  });
  field.group("oracles", [&](auto& oracles) {
    oracles("declared", audited.declared);
    oracles("counted", audited.counted);
    oracles("iterations", audited.iterations);
  });
  field("flags", audited.flags);
}

namespace {

struct Audit {
  std::vector<AuditedOptimizer> optimizers;
};

void fields(Like<Audit> auto& audit, auto& field) {
  field.constant("schema", "isoline.audit/1");
  field("optimizers", audit.optimizers);
}

}  // namespace

bool PowerLaw::has_values() const {
  return std::ranges::any_of(values, [](Real value) { return std::isfinite(value); });
}

Json to_json(const AuditedOptimizer& audited) { return json_of(audited); }

AuditedOptimizer audited_from_text(const std::string& text, const std::string& origin) {
  return from_text<AuditedOptimizer>(text, origin, "no audit");
}

Json audit_to_json(const std::vector<AuditedOptimizer>& all) { return json_of(Audit{all}); }

std::vector<AuditedOptimizer> audit_from_text(const std::string& text, const std::string& origin) {
  return from_text<Audit>(text, origin, "no audit").optimizers;
}

}  // namespace isoline
