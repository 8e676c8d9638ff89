// Member types whose JSON form takes more than a line.
#include "core/records/fields.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "core/options.h"

namespace isoline {

void complete_schema(JsonPlace schema, const char* title) {
  schema["$schema"].set("http://json-schema.org/draft-07/schema#");
  schema["title"].set(title);
  schema["definitions"]["number"].parse(
      R"({"description": "a number, or the text inf, -inf or nan",
          "anyOf": [{"type": "number"}, {"enum": ["inf", "-inf", "nan"]}]})");
}

void read_key(const std::string& text, std::int64_t& key) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), key);
  require(error == std::errc() && end == text.data() + text.size(),
          [&] { return "expected an integer, got " + text; });
}

void Form<OracleCounts>::write(const OracleCounts& counts, JsonPlace out) {
  out.make_object();
  for (std::size_t kind = 0; kind < kOracles; ++kind) out[kOracleNames[kind]].set(counts[kind]);
}

void Form<OracleCounts>::read(const JsonView& json, OracleCounts& counts) {
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (json.contains(kOracleNames[kind])) counts[kind] = json.at(kOracleNames[kind]);
}

void Form<OracleCounts>::law(JsonPlace out) {
  out.parse(R"({"type": "object", "additionalProperties": false, "required": []})");
  for (const OracleRow& oracle : kOracleTable) {
    out["properties"][oracle.name].parse(R"({"type": "integer", "minimum": 0})");
    if (oracle.is_in_every_record) out["required"].next().set(oracle.name);
  }
}

void Form<OptionValues>::write(const OptionValues& options, JsonPlace out) {
  out.set(to_json(options));
}

void Form<OptionValues>::read(const JsonView& json, OptionValues& options) {
  options = option_values_from(json.json());
}

void Form<Status>::read(const JsonView& json, Status& status) {
  const auto found = status_of(json.get<std::string>());
  require(found.has_value(), [&] { return "unknown status " + json.get<std::string>(); });
  require(found != Status::running, "it was written before its run ended");
  status = *found;
}

void Form<Status>::law(JsonPlace out) {
  for (const std::string_view name : kStatusNames)
    if (name != name_of(Status::running)) out["enum"].next().set(name);  // it is never written
}

void Form<Aim>::read(const JsonView& json, Aim& aim) {
  const auto found = aim_of(json.get<std::string>());
  require(found.has_value(), [&] { return "unknown aim " + json.get<std::string>(); });
  aim = *found;
}

void Form<Aim>::law(JsonPlace out) {
  for (const std::string_view name : kAimNames) out["enum"].next().set(name);
}

void Form<Grid>::write(const Grid& grid, JsonPlace out) {
  out.make_list();
  for (Index j = 0; j < grid.columns(); ++j) out.next().set(grid.column(j));
}

void Form<Grid>::read(const JsonView& json, Grid& grid) {
  std::vector<std::vector<Real>> columns;
  Form<std::vector<std::vector<Real>>>::read(json, columns);
  const std::size_t rows = columns.empty() ? 0 : columns[0].size();
  std::vector<Real> values;
  for (const std::vector<Real>& column : columns) {
    require(column.size() == rows, "the columns of an array differ in length");
    values.insert(values.end(), column.begin(), column.end());
  }
  grid = Grid(static_cast<Index>(rows), static_cast<Index>(columns.size()), std::move(values));
}

}  // namespace isoline
