// What stands in a file, declared once: a struct names its members, and is written as JSON, read
// back and described by a JSON Schema from that alone.
//
//   void fields(Like<Summary> auto& summary, auto& field) {
//     field("loss", summary.loss);                  // must be there
//     field.optional("counts", summary.counts);     // left out where empty
//     field("seed", summary.seed, R"({"minimum": 0})");  // with a further law, as JSON Schema
//   }
//
// The types of members, and how each stands in JSON, are those of core/records/forms.h.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.h"
#include "core/records/json_view.h"

namespace isoline {

using Json = nlohmann::json;

template <class Given, class Type>
concept Like = std::is_same_v<std::remove_const_t<Given>, Type>;

// How values of a type stand in JSON: write(value), read(view, value) and law(), its schema.
template <class Type>
struct Form;

template <class Value>
bool is_absent(const Value& value) {
  if constexpr (requires { value.has_value(); })
    return !value.has_value();
  else if constexpr (requires { value.empty(); })
    return value.empty();
  else
    return value == Value{};
}

// An optional member is written as what it holds; one that must be there may also be null.
template <class Value>
decltype(auto) held(Value& value) {
  if constexpr (requires { value.has_value(); })
    return (*value);
  else
    return (value);
}

class FieldWriter {
 public:
  static constexpr bool kReads = false;
  explicit FieldWriter(Json& out) : out_(out) {}

  void constant(const char* name, const char* value) { out_[name] = value; }
  template <class Value>
  void operator()(const char* name, const Value& value, const char* = "") {
    out_[name] = Form<Value>::write(value);
  }
  template <class Value>
  void optional(const char* name, const Value& value, const char* law = "") {
    if (!is_absent(value)) (*this)(name, held(value), law);
  }
  template <class Value>
  void expected(const char* name, const Value& value, const char* law = "") {
    optional(name, value, law);
  }
  template <class Value>
  void when(bool holds, const char* name, const Value& value, const char* law = "") {
    if (holds) (*this)(name, value, law);
  }
  void other(const char*) {}
  void rest(const std::string& others, bool = true) {
    if (!others.empty()) out_.update(Json::parse(others));
  }

 private:
  Json& out_;
};

class FieldReader {
 public:
  static constexpr bool kReads = true;
  explicit FieldReader(const JsonView& in) : in_(in) {}

  void constant(const char* name, const char* value) {
    require(in_.at(name).get<std::string>() == value, "its schema is another");
  }
  template <class Value>
  void operator()(const char* name, Value&& value, const char* = "") {
    Form<std::remove_cvref_t<Value>>::read(in_.at(name), value);
    known_.push_back(name);
  }
  template <class Value>
  void optional(const char* name, Value& value, const char* law = "") {
    if (!in_.contains(name)) return;
    if constexpr (requires { value.has_value(); }) value.emplace();
    (*this)(name, held(value), law);
  }
  template <class Value>
  void expected(const char* name, Value& value, const char* law = "") {
    optional(name, value, law);
  }
  template <class Value>
  void when(bool holds, const char* name, Value& value, const char* law = "") {
    if (holds) (*this)(name, value, law);
  }
  void other(const char* name) { known_.push_back(name); }  // stands here, and is read elsewhere
  // All that no other field has asked for, as the text of an object.
  void rest(std::string& others, bool = true) {
    Json left = Json::object();
    for (const auto& [name, value] : in_.items())
      if (std::ranges::find(known_, name) == known_.end()) left[name] = value.json();
    others = left.empty() ? "" : left.dump();
  }

 private:
  const JsonView& in_;
  std::vector<std::string_view> known_;
};

class FieldSchema {
 public:
  static constexpr bool kReads = false;

  void constant(const char* name, const char* value) { add(name, {{"const", value}}, true); }
  template <class Value>
  void operator()(const char* name, const Value&, const char* law = "") {
    add(name, with(Form<Value>::law(), law), true);
  }
  template <class Value>
  void optional(const char* name, const Value& value, const char* law = "") {
    add(name, with(Form<std::remove_cvref_t<decltype(held(value))>>::law(), law), false);
  }
  // Written by every program of ours, and done without where a record lacks it.
  template <class Value>
  void expected(const char* name, const Value& value, const char* law = "") {
    add(name, with(Form<std::remove_cvref_t<decltype(held(value))>>::law(), law), true);
  }
  template <class Value>
  void when(bool, const char* name, const Value&, const char* law = "") {
    add(name, with(Form<Value>::law(), law), false);
  }
  void other(const char*) {}
  void rest(const std::string&, bool is_lawful = true) { is_open_ = is_lawful; }

  Json schema() const {
    Json json{{"type", "object"}, {"required", required_}, {"properties", properties_}};
    if (!is_open_) json["additionalProperties"] = false;
    return json;
  }

 private:
  static Json with(Json schema, const char* law) {
    if (*law == '\0') return schema;
    if (schema.contains("$ref")) return {{"allOf", {schema, Json::parse(law)}}};  // it stands alone
    schema.update(Json::parse(law));
    return schema;
  }
  void add(const char* name, Json schema, bool is_required) {
    properties_[name] = std::move(schema);
    if (is_required) required_.insert(name);
  }

  Json properties_ = Json::object();
  std::set<std::string> required_;
  bool is_open_ = false;
};

// Structs that name their members.
template <class Type>
concept Declared = requires(Type& value, FieldSchema& field) { fields(value, field); };

template <Declared Type>
struct Form<Type> {
  static Json write(const Type& value) {
    Json json = Json::object();
    FieldWriter writer(json);
    fields(value, writer);
    return json;
  }
  static void read(const JsonView& json, Type& value) {
    FieldReader reader(json);
    fields(value, reader);
  }
  static Json law() {
    Type sample;
    FieldSchema described;
    fields(sample, described);
    return described.schema();
  }
};

}  // namespace isoline
