// Reads a description: its form by the schema, then what a schema cannot say.
#include "benchmarks/import/curve_description.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "benchmarks/plan/resources.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/oracle.h"
#include "core/records/schema.h"

namespace isoline::benchmarks {
namespace {

std::optional<Real> optional_real(const Json& json, const char* name) {
  if (!json.contains(name)) return std::nullopt;
  return real_of(json[name]);
}

// A day stands for its first second.
std::string instant_of_date(const std::string& date, const std::string& origin) {
  const std::string instant = date.find('T') == std::string::npos ? date + "T00:00:00Z" : date;
  require(instant_from(instant).has_value(), [&] {
    return fmt::format(
        "{}: date must be a day, as 2026-01-31, or an instant, as 2026-01-31T12:00:00Z, got '{}'",
        origin, date);
  });
  return instant;
}

std::map<std::string, ColumnName> columns_of(const Json& json) {
  std::map<std::string, ColumnName> columns;
  for (const auto& [quantity, column] : json.items())
    columns[quantity] = column.is_string() ? ColumnName(column.get<std::string>())
                                           : ColumnName(column.get<std::int64_t>());
  return columns;
}

// An order is by what things cost: work is told, or follows from calls whose price is the same on
// every problem.
void require_cost(const CurveDescription& told, const std::string& origin) {
  if (told.columns.contains("work")) return;
  bool is_any = false;
  for (const OracleRow& oracle : kOracleTable) {
    if (!told.columns.contains(std::string(oracle.name))) continue;
    is_any = true;
    require(has_plain_price(oracle.kind), [&] {
      return fmt::format(
          "{}: what a call of {} costs depends on the problem: name the column of work, too",
          origin, oracle.name);
    });
  }
  require(is_any, [&] {
    return fmt::format("{}: columns must name what the curve cost: work, or calls as forward",
                       origin);
  });
}

}  // namespace

bool has_plain_price(Oracle oracle) {
  return oracle == Oracle::forward || oracle == Oracle::pullback || oracle == Oracle::pushforward ||
         oracle == Oracle::hessian_product;
}

CurveDescription description_from_text(const std::string& text, const std::string& origin) {
  const Json json = parse_json(text, origin);
  const Json schema = parse_json(std::string(builtin_schemas().at("import")), "import schema");
  const std::vector<std::string> violations = schema_violations(json, schema);
  require(violations.empty(), [&] {
    return fmt::format("{} is no description of a curve: {}", origin, violations[0]);
  });
  CurveDescription told{.problem = json.at("problem"),
                        .optimizer = json.at("optimizer"),
                        .seed = json.at("seed"),
                        .source = json.at("source"),
                        .program = json.value("program", ""),
                        .date = instant_of_date(json.at("date"), origin),
                        .processor = json.value("processor", ""),
                        .claimed = json.value("claimed", ""),
                        .status = *status_of(json.value("status", "budget")),
                        .minimum = optional_real(json, "minimum"),
                        .scale = optional_real(json, "scale"),
                        .x_scale = optional_real(json, "x_scale"),
                        .unknowns = json.value("unknowns", std::int64_t{0}),
                        .residuals = json.value("residuals", std::int64_t{0}),
                        .columns = columns_of(json.at("columns"))};
  require(!told.scale || told.minimum, [&] {
    return fmt::format("{}: a scale is one of the loss over a minimum: tell both", origin);
  });
  require(!told.scale || *told.scale > 0,
          [&] { return fmt::format("{}: scale must be above 0, got {}", origin, *told.scale); });
  require_cost(told, origin);
  return told;
}

}  // namespace isoline::benchmarks
