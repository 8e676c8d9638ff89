// How the types of members stand in JSON.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "core/grid.h"
#include "core/json.h"
#include "core/option_json.h"
#include "core/oracle.h"
#include "core/records/fields.h"
#include "core/status.h"

namespace isoline {

// A type that is one of JSON's own.
template <class Type>
struct PlainForm {
  static Json write(const Type& value) { return value; }
  static void read(const JsonView& json, Type& value) { json.get_to(value); }
};
template <>
struct Form<bool> : PlainForm<bool> {
  static Json law() { return {{"type", "boolean"}}; }
};
template <>
struct Form<int> : PlainForm<int> {
  static Json law() { return {{"type", "integer"}}; }
};
template <>
struct Form<std::int64_t> : PlainForm<std::int64_t> {
  static Json law() { return {{"type", "integer"}}; }
};
template <>
struct Form<std::uint64_t> : PlainForm<std::uint64_t> {
  static Json law() { return {{"type", "integer"}, {"minimum", 0}}; }
};
template <>
struct Form<std::string> : PlainForm<std::string> {
  static Json law() { return {{"type", "string"}}; }
};

template <>
struct Form<Real> {
  static Json write(Real value) { return json_number(value); }
  static void read(const JsonView& json, Real& value) { value = real_of(json); }
  static Json law() { return {{"$ref", "#/definitions/number"}}; }
};

inline constexpr const char* kSchemaDialect = "http://json-schema.org/draft-07/schema#";

// The definition that the law of numbers refers to.
inline Json number_definition() {
  return {{"description", "a number, or one of the three that JSON cannot write"},
          {"anyOf", {{{"type", "number"}}, {{"enum", {"inf", "-inf", "nan"}}}}}};
}

template <class Value>
struct Form<std::vector<Value>> {
  static Json write(const std::vector<Value>& values) {
    Json list = Json::array();
    for (const Value& value : values) list.push_back(Form<Value>::write(value));
    return list;
  }
  static void read(const JsonView& json, std::vector<Value>& values) {
    if constexpr (std::is_same_v<Value, Real>) {
      values = reals_of(json);
    } else if constexpr (requires { json.get_to(values); }) {
      json.get_to(values);
    } else {
      values.clear();
      for (const JsonView& each : json.values()) Form<Value>::read(each, values.emplace_back());
    }
  }
  static Json law() { return {{"type", "array"}, {"items", Form<Value>::law()}}; }
};

template <class Value, std::size_t count>
struct Form<std::array<Value, count>> {
  static Json write(const std::array<Value, count>& values) {
    return Form<std::vector<Value>>::write({values.begin(), values.end()});
  }
  static void read(const JsonView& json, std::array<Value, count>& values) {
    std::vector<Value> list;
    Form<std::vector<Value>>::read(json, list);
    require(list.size() == count, "a list has the wrong length");
    std::ranges::copy(list, values.begin());
  }
  static Json law() {
    Json json = Form<std::vector<Value>>::law();
    json.update({{"minItems", count}, {"maxItems", count}});
    return json;
  }
};

inline std::string key_text(const std::string& key) { return key; }
inline std::string key_text(std::int64_t key) { return std::to_string(key); }
inline void read_key(const std::string& text, std::string& key) { key = text; }
inline void read_key(const std::string& text, std::int64_t& key) { key = std::stoll(text); }

template <class Key, class Value>
struct Form<std::map<Key, Value>> {
  static Json write(const std::map<Key, Value>& values) {
    Json json = Json::object();
    for (const auto& [key, value] : values) json[key_text(key)] = Form<Value>::write(value);
    return json;
  }
  static void read(const JsonView& json, std::map<Key, Value>& values) {
    values.clear();
    for (const auto& [text, value] : json.items()) {
      Key key{};
      read_key(text, key);
      Form<Value>::read(value, values[key]);
    }
  }
  static Json law() {
    return {{"type", "object"}, {"additionalProperties", Form<Value>::law()}};
  }
};

// null where there is none.
template <class Value>
struct Form<std::optional<Value>> {
  static Json write(const std::optional<Value>& value) {
    return value ? Form<Value>::write(*value) : Json();
  }
  static void read(const JsonView& json, std::optional<Value>& value) {
    value.reset();
    if (!json.is_null()) Form<Value>::read(json, value.emplace());
  }
  static Json law() { return {{"anyOf", {Form<Value>::law(), {{"type", "null"}}}}}; }
};

// By name; older records lack what was counted later.
template <>
struct Form<OracleCounts> {
  static Json write(const OracleCounts& counts) {
    Json json = Json::object();
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      json[std::string(kOracleNames[kind])] = counts[kind];
    return json;
  }
  static void read(const JsonView& json, OracleCounts& counts) {
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (json.contains(kOracleNames[kind])) counts[kind] = json.at(kOracleNames[kind]);
  }
  static Json law() { return {{"$ref", "#/definitions/counts"}}; }
};

template <>
struct Form<OptionValues> {
  static Json write(const OptionValues& options) { return to_json(options); }
  static void read(const JsonView& json, OptionValues& options) {
    options = option_values_from(json.json());
  }
  static Json law() { return {{"type", "object"}}; }
};

template <>
struct Form<Status> {
  static Json write(Status status) { return name_of(status); }
  static void read(const JsonView& json, Status& status) {
    const auto found = status_of(json.get<std::string>());
    require(found.has_value(), [&] { return "unknown status " + json.get<std::string>(); });
    status = *found;
  }
  static Json law() {
    Json names = Json::array();
    for (const std::string_view name : kStatusNames)
      if (name != name_of(Status::running)) names.push_back(name);  // it is never written
    return {{"enum", names}};
  }
};

// A list of columns.
template <>
struct Form<Grid> {
  static Json write(const Grid& grid) {
    Json columns = Json::array();
    for (Index j = 0; j < grid.columns(); ++j) columns.push_back(json_numbers(grid.column(j)));
    return columns;
  }
  static void read(const JsonView& json, Grid& grid) {
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
  static Json law() { return Form<std::vector<std::vector<Real>>>::law(); }
};

// A number that stands for "no limit" where it is the largest of its type: null.
template <class Value>
struct Unlimited {
  Value& value;
};
template <class Value>
struct Form<Unlimited<Value>> {
  using Number = std::remove_const_t<Value>;
  static constexpr Number kNone = std::numeric_limits<Number>::max();

  static Json write(const Unlimited<Value>& limit) {
    return limit.value < kNone ? Json(limit.value) : Json(nullptr);
  }
  static void read(const JsonView& json, const Unlimited<Value>& limit) {
    limit.value = kNone;
    if (!json.is_null()) json.get_to(limit.value);
  }
  static Json law() { return {{"type", {"integer", "null"}}}; }
};

// A list or an object kept as its text.
template <class Text>
struct JsonAsText {
  Text& text;
};
template <class Text>
struct Form<JsonAsText<Text>> {
  static Json write(const JsonAsText<Text>& value) { return Json::parse(value.text); }
  static void read(const JsonView& json, const JsonAsText<Text>& value) {
    value.text = json.json().dump();
  }
  static Json law() { return Json::object(); }
};

}  // namespace isoline
