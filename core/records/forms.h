// How the types of members stand in JSON.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "core/grid.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/records/fields.h"
#include "core/status.h"

namespace isoline {

// Types that are JSON's own.
template <class Type, class Written = Type>
struct PlainForm {
  static void write(const Type& value, JsonPlace out) { out.set(static_cast<Written>(value)); }
  static void read(const JsonView& json, Type& value) { json.get_to(value); }
};
template <>
struct Form<bool> : PlainForm<bool> {
  static void law(JsonPlace out) { out["type"].set("boolean"); }
};
template <>
struct Form<int> : PlainForm<int, std::int64_t> {
  static void law(JsonPlace out) { out["type"].set("integer"); }
};
template <>
struct Form<std::int64_t> : PlainForm<std::int64_t> {
  static void law(JsonPlace out) { out["type"].set("integer"); }
};
template <>
struct Form<std::uint64_t> : PlainForm<std::uint64_t> {
  static void law(JsonPlace out) { out.parse(R"({"type": "integer", "minimum": 0})"); }
};
template <>
struct Form<std::string> : PlainForm<std::string, std::string_view> {
  static void law(JsonPlace out) { out["type"].set("string"); }
};

// Also infinite, or not a number.
template <>
struct Form<Real> {
  static void write(Real value, JsonPlace out) { out.set(value); }
  static void read(const JsonView& json, Real& value) { value = real_of(json); }
  static void law(JsonPlace out) { out["$ref"].set("#/definitions/number"); }
};

// What a whole schema has besides: its dialect, its title, and the definition that the law of
// numbers refers to.
void complete_schema(JsonPlace schema, const char* title);

template <class Value>
struct Form<std::vector<Value>> {
  static void write(const std::vector<Value>& values, JsonPlace out) {
    if constexpr (std::is_same_v<Value, Real>) {
      out.set(std::span<const Real>(values));
    } else {
      out.make_list();
      for (const Value& value : values) Form<Value>::write(value, out.next());
    }
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
  static void law(JsonPlace out) {
    out["type"].set("array");
    Form<Value>::law(out["items"]);
  }
};

template <class Value, std::size_t count>
struct Form<std::array<Value, count>> {
  static void write(const std::array<Value, count>& values, JsonPlace out) {
    Form<std::vector<Value>>::write({values.begin(), values.end()}, out);
  }
  static void read(const JsonView& json, std::array<Value, count>& values) {
    std::vector<Value> list;
    Form<std::vector<Value>>::read(json, list);
    require(list.size() == count, "a list has the wrong length");
    std::ranges::copy(list, values.begin());
  }
  static void law(JsonPlace out) {
    Form<std::vector<Value>>::law(out);
    for (const char* bound : {"minItems", "maxItems"})
      out[bound].set(static_cast<std::int64_t>(count));
  }
};

inline std::string key_text(const std::string& key) { return key; }
inline std::string key_text(std::int64_t key) { return std::to_string(key); }
inline void read_key(const std::string& text, std::string& key) { key = text; }
void read_key(const std::string& text, std::int64_t& key);  // UsageError where it is no number

template <class Key, class Value>
struct Form<std::map<Key, Value>> {
  static void write(const std::map<Key, Value>& values, JsonPlace out) {
    out.make_object();
    for (const auto& [key, value] : values) Form<Value>::write(value, out[key_text(key)]);
  }
  static void read(const JsonView& json, std::map<Key, Value>& values) {
    values.clear();
    for (const auto& [text, value] : json.items()) {
      Key key{};
      read_key(text, key);
      Form<Value>::read(value, values[key]);
    }
  }
  static void law(JsonPlace out) {
    out["type"].set("object");
    Form<Value>::law(out["additionalProperties"]);
  }
};

// null where there is none.
template <class Value>
struct Form<std::optional<Value>> {
  static void write(const std::optional<Value>& value, JsonPlace out) {
    if (value)
      Form<Value>::write(*value, out);
    else
      out.set_null();
  }
  static void read(const JsonView& json, std::optional<Value>& value) {
    value.reset();
    if (!json.is_null()) Form<Value>::read(json, value.emplace());
  }
  static void law(JsonPlace out) {
    const JsonPlace either = out["anyOf"];
    Form<Value>::law(either.next());
    either.next()["type"].set("null");
  }
};

// By name; older records lack what was counted later.
template <>
struct Form<OracleCounts> {
  static void write(const OracleCounts& counts, JsonPlace out);
  static void read(const JsonView& json, OracleCounts& counts);
  static void law(JsonPlace out);
};

template <>
struct Form<OptionValues> {
  static void write(const OptionValues& options, JsonPlace out);
  static void read(const JsonView& json, OptionValues& options);
  static void law(JsonPlace out) { out["type"].set("object"); }
};

template <>
struct Form<Status> {
  static void write(Status status, JsonPlace out) { out.set(name_of(status)); }
  static void read(const JsonView& json, Status& status);
  static void law(JsonPlace out);
};

template <>
struct Form<Aim> {
  static void write(Aim aim, JsonPlace out) { out.set(name_of(aim)); }
  static void read(const JsonView& json, Aim& aim);
  static void law(JsonPlace out);
};

// A list of columns.
template <>
struct Form<Grid> {
  static void write(const Grid& grid, JsonPlace out);
  static void read(const JsonView& json, Grid& grid);
  static void law(JsonPlace out) { Form<std::vector<std::vector<Real>>>::law(out); }
};

// A number that stands for "no limit" where it is the largest of its type: null.
template <class Value>
struct Unlimited {
  Value& value;
};
template <class Value>
struct Form<Unlimited<Value>> {
  static constexpr auto kNone = std::numeric_limits<std::remove_const_t<Value>>::max();

  static void write(const Unlimited<Value>& limit, JsonPlace out) {
    if (limit.value < kNone)
      out.set(limit.value);
    else
      out.set_null();
  }
  static void read(const JsonView& json, const Unlimited<Value>& limit) {
    limit.value = kNone;
    if (!json.is_null()) json.get_to(limit.value);
  }
  static void law(JsonPlace out) { out.parse(R"({"type": ["integer", "null"]})"); }
};

// A list or an object kept as its text.
template <class Text>
struct JsonAsText {
  Text& text;
};
template <class Text>
struct Form<JsonAsText<Text>> {
  static void write(const JsonAsText<Text>& value, JsonPlace out) { out.parse(value.text); }
  static void read(const JsonView& json, const JsonAsText<Text>& value) {
    value.text = json.tree_text();
  }
  static void law(JsonPlace out) { out.make_object(); }
};

}  // namespace isoline
