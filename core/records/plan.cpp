// Plans to JSON and back.
#include "core/records/plan.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/records/fields.h"

namespace isoline {

void fields(Like<PlannedCell> auto& cell, auto& field) {
  field("cell", cell.cell, R"({"pattern": "^[0-9a-f]{16}$"})");
  field("problem", cell.problem);
  field("optimizer", cell.optimizer);
  field("seed", cell.seed);
}

void fields(Like<Plan> auto& plan, auto& field) {
  field.constant("schema", kPlanSchema);
  field("suites", plan.suites);
  field("cells", plan.cells);
}

Json to_json(const Plan& plan) {
  Json json;
  Form<Plan>::write(plan, JsonPlace(json));
  return json;
}

std::string file_text(const Plan& plan) { return json_text(to_json(plan)) + "\n"; }

Plan plan_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    Plan plan;
    Form<Plan>::read(json, plan);
    return plan;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("no {} plan: {}", kPlanSchema, error.what()));
  }
}

Json plan_schema() {
  Json schema;
  Form<Plan>::law(JsonPlace(schema));
  complete_schema(JsonPlace(schema), "isoline.plan/1: every cell ever planned in a result folder");
  return schema;
}

}  // namespace isoline
