// The contents of a file, declared once: a struct names its members, and is written as JSON, read
// and described by a JSON Schema from that alone.
//
//   void fields(Like<Summary> auto& summary, auto& field) {
//     field("loss", summary.loss);                       // must be there
//     field("seed", summary.seed, R"({"minimum": 0})");  // with a further law, as JSON Schema
//     field.optional("counts", summary.counts);          // left out where empty
//   }
//
// Each member type defines its JSON form below.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/real.h"
#include "core/records/json_view.h"
#include "core/status.h"

namespace isoline {

template <class Given, class Type>
concept Like = std::is_same_v<std::remove_const_t<Given>, Type>;

// The JSON form of a type's values: write(value, place), read(view, value), law(place), its schema.
template <class Type>
struct Form;

// An optional member is written as what it holds; one that must be there may also be null.
template <class Value>
decltype(auto) held(Value& value) {
  if constexpr (requires { value.has_value(); })
    return (*value);
  else
    return (value);
}
template <class Value>
using FormOfHeld = Form<std::remove_cvref_t<decltype(held(std::declval<Value&>()))>>;

template <class Value>
bool is_absent(const Value& value) {
  if constexpr (requires { value.has_value(); })
    return !value.has_value();
  else if constexpr (requires { value.empty(); })
    return value.empty();
  else
    return value == Value{};
}

class FieldWriter {
 public:
  static constexpr bool kReads = false;
  explicit FieldWriter(JsonPlace out) : out_(out) { out_.make_object(); }

  void constant(const char* name, const char* value) { out_[name].set(value); }
  template <class Value>
  void operator()(const char* name, const Value& value, const char* = "") {
    Form<Value>::write(value, out_[name]);
  }
  template <class Value>
  void optional(const char* name, const Value& value, const char* = "") {
    if (!is_absent(value)) (*this)(name, held(value));
  }
  template <class Value>
  void expected(const char* name, const Value& value, const char* = "") {
    optional(name, value);
  }
  template <class Value>
  void forgiven(const char* name, const Value& value, const char* = "") {
    (*this)(name, value);
  }
  template <class Value>
  void when(bool holds, const char* name, const Value& value, const char* = "") {
    if (holds) (*this)(name, value);
  }
  void other(const char*) {}
  void rest(const std::string& others, bool = true) {
    if (!others.empty()) out_.include(others);
  }

 private:
  JsonPlace out_;
};

class FieldReader {
 public:
  static constexpr bool kReads = true;
  explicit FieldReader(const JsonView& in) : in_(in) {}

  void constant(const char* name, const char* value) {
    require(in_.at(name).get<std::string>() == value, "it has another schema");
  }
  template <class Value>
  void operator()(const char* name, Value&& value, const char* = "") {
    Form<std::remove_cvref_t<Value>>::read(in_.at(name), value);
    known_.push_back(name);
  }
  template <class Value>
  void optional(const char* name, Value& value, const char* = "") {
    if (!in_.contains(name)) return;
    if constexpr (requires { value.has_value(); }) value.emplace();
    (*this)(name, held(value));
  }
  template <class Value>
  void expected(const char* name, Value& value, const char* = "") {
    optional(name, value);
  }
  template <class Value>
  void forgiven(const char* name, Value& value, const char* = "") {
    if (in_.contains(name)) (*this)(name, value);
  }
  template <class Value>
  void when(bool holds, const char* name, Value& value, const char* = "") {
    if (holds) (*this)(name, value);
  }
  void other(const char* name) { known_.push_back(name); }  // stands here, and is read elsewhere
  // All members that no other field has read, as the text of an object.
  void rest(std::string& others, bool = true) {
    others.clear();
    for (const auto& [name, value] : in_.items())
      if (std::ranges::find(known_, name) == known_.end())
        others += (others.empty() ? "{" : ",") + json_of_text(name) + ":" + value.text();
    if (!others.empty()) others += "}";
  }

 private:
  const JsonView& in_;
  std::vector<std::string_view> known_;
};

class FieldSchema {
 public:
  static constexpr bool kReads = false;
  explicit FieldSchema(JsonPlace out) : out_(out) {
    out_.parse(R"({"type": "object", "required": [], "properties": {},
                   "additionalProperties": false})");
  }

  void constant(const char* name, const char* value) { place_of(name, true)["const"].set(value); }
  template <class Value>
  void operator()(const char* name, const Value&, const char* law = "") {
    describe<Form<Value>>(place_of(name, true), law);
  }
  template <class Value>
  void optional(const char* name, const Value&, const char* law = "") {
    describe<FormOfHeld<const Value>>(place_of(name, false), law);
  }
  // Our programs always write it, but a record may lack it.
  template <class Value>
  void expected(const char* name, const Value&, const char* law = "") {
    describe<FormOfHeld<const Value>>(place_of(name, true), law);
  }
  // The same, written where it is empty too.
  template <class Value>
  void forgiven(const char* name, const Value&, const char* law = "") {
    describe<Form<Value>>(place_of(name, true), law);
  }
  template <class Value>
  void when(bool, const char* name, const Value&, const char* law = "") {
    describe<Form<Value>>(place_of(name, false), law);
  }
  void other(const char*) {}
  void rest(const std::string&, bool is_lawful = true) {
    out_["additionalProperties"].set(is_lawful);
  }

 private:
  JsonPlace place_of(const char* name, bool is_required) const {
    if (is_required) out_["required"].next().set(name);
    return out_["properties"][name];
  }
  template <class Described>
  static void describe(JsonPlace place, const char* law) {
    Described::law(place);
    if (*law != '\0') place.restrict(law);
  }

  JsonPlace out_;
};

// Structs that name their members.
template <class Type>
concept Declared = requires(Type& value, FieldSchema& field) {
  fields(value, field);
};

template <Declared Type>
struct Form<Type> {
  static void write(const Type& value, JsonPlace out) {
    FieldWriter writer(out);
    fields(value, writer);
  }
  static void read(const JsonView& json, Type& value) {
    FieldReader reader(json);
    fields(value, reader);
  }
  static void law(JsonPlace out) {
    Type sample;
    FieldSchema described(out);
    fields(sample, described);
  }
};

// How the types of members stand in JSON.

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

// The rest of a schema: its dialect, its title, and the definition that constraints of numbers
// refer to.
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
void read_key(const std::string& text, std::int64_t& key);  // UsageError if it is not a number

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

// null if it does not exist.
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
