// What stands in a file, declared once: a struct names its members, and is written as JSON, read
// back and described by a JSON Schema from that alone.
//
//   void fields(Like<Summary> auto& summary, auto& field) {
//     field("loss", summary.loss);                       // must be there
//     field("seed", summary.seed, R"({"minimum": 0})");  // with a further law, as JSON Schema
//     field.optional("counts", summary.counts);          // left out where empty
//   }
//
// The types of members, and how each stands in JSON, are those of core/records/forms.h.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.h"
#include "core/records/json_place.h"
#include "core/records/json_view.h"

namespace isoline {

template <class Given, class Type>
concept Like = std::is_same_v<std::remove_const_t<Given>, Type>;

// How values of a type stand in JSON: write(value, place), read(view, value), law(place), its
// schema.
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
    require(in_.at(name).get<std::string>() == value, "its schema is another");
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
  // All that no other field has asked for, as the text of an object.
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
  // Written by every program of ours, and done without where a record lacks it.
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

}  // namespace isoline
